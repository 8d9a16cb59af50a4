// The stages of compile, in order of use: each a pure function from input structs to an output struct. Internal.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rendergraph/plan.hpp"
#include "rendergraph/scratch.hpp"

namespace tyndall::rg::stages {

// ---- ranges: every access in concrete cells ----------------------------------------------------------------------

/// A resource is cut into cells, the smallest parts that its accesses tell apart: one cell if all accesses cover all of
/// it, else one a subresource (image) or one an interval between range boundaries (buffer).
struct CellRange {
    std::uint32_t first_mip = 0, mip_count = 1;     ///< buffers: mip 0, count 1
    std::uint32_t first_layer = 0, layer_count = 1; ///< buffers: intervals
};
struct ResourceCells {
    std::uint32_t mips = 1;
    std::uint32_t layers = 1;              ///< buffers: number of intervals
    bool whole = true;                     ///< one cell stands for everything
    Scratch<VkDeviceSize> boundaries = {}; ///< buffers cut into intervals: layers + 1 offsets
    [[nodiscard]] std::uint32_t count() const { return whole ? 1 : mips * layers; }
};
struct Cells {
    Scratch<ResourceCells> of_resource;
    Scratch<CellRange> of_access;
};
/// Calls `f(cell index)` for every cell of the range.
template <typename F>
void for_each_cell(const ResourceCells& resource, const CellRange& range, F&& f) {
    if (resource.whole) {
        f(0U);
        return;
    }
    for (std::uint32_t mip = range.first_mip; mip < range.first_mip + range.mip_count; ++mip) {
        for (std::uint32_t layer = range.first_layer; layer < range.first_layer + range.layer_count; ++layer) {
            f(mip * resource.layers + layer);
        }
    }
}
/// The cells as few ranges: runs of layers, then equal runs of neighbouring mips. `cells` ascending.
[[nodiscard]] Scratch<CellRange> as_rectangles(const ResourceCells& resource, std::span<const std::uint32_t> cells);
/// Requires ranges inside their resources (validate). O(accesses log accesses).
[[nodiscard]] Cells cut_into_cells(const GraphDesc& graph);

// ---- flow: who needs what of whom --------------------------------------------------------------------------------

struct Edge {
    std::uint32_t from = none; ///< pass
    std::uint32_t to = none;   ///< pass
    std::uint32_t resource = none;
    Hazard hazard = Hazard::read_after_write;
};
struct Flow {
    Scratch<Edge> edges;                 ///< sorted by (to, from), unique per (to, from, hazard is read_after_write)
    Scratch<std::uint32_t> last_writers; ///< passes whose writes stand at the frame's end, of imports and histories
    Scratch<std::uint32_t> last_writer_resource; ///< the resource, parallel to last_writers
    Diagnostics errors;                          ///< reads of something never written, two writers of one version
};
/// Follows versions, not the order of declaration. With `kept`, passes that it does not mark do not exist, so that what
/// was ordered through a culled pass is ordered directly. O(accesses x cells of each).
[[nodiscard]] Flow follow_versions(const GraphDesc& graph, const Cells& cells, const Scratch<bool>* kept = nullptr);

// ---- validate ----------------------------------------------------------------------------------------------------

/// Everything that can be said about single passes, accesses and resources.
[[nodiscard]] Diagnostics validate(const GraphDesc& graph, const QueueTopology& topology);

/// Of the attachments of one pass; a part of validate. O(accesses of the pass).
void validate_attachments(const GraphDesc& graph, const PassDesc& pass, Diagnostics& errors);

/// Whether the transients can be placed: each has a size, and sums of all do not overflow.
/// O(resources + accesses).
[[nodiscard]] Diagnostics validate_memory(const GraphDesc& graph, const MemoryRequirements& memory);

// ---- order -------------------------------------------------------------------------------------------------------

struct Order {
    Scratch<std::uint32_t> passes; ///< all of them, topological; ties by declaration
    Diagnostics errors;            ///< cycles
};
/// Kahn's algorithm with the smallest declaration index first. O((passes + edges) log passes).
[[nodiscard]] Order order_passes(const GraphDesc& graph, const Flow& flow);

// ---- cull --------------------------------------------------------------------------------------------------------

struct Kept {
    Scratch<bool> pass; ///< by pass
    Scratch<KeepReason> reason;
    Scratch<std::uint32_t> keeps_for;
    std::vector<CulledPass> culled_passes;
    std::vector<CulledResource> culled_resources;
};
/// Reachability backward along read-after-write edges from side effects, imports with a final state, and histories.
[[nodiscard]] Kept cull(const GraphDesc& graph, const Flow& flow, const Order& order, bool enabled);

// ---- schedule ----------------------------------------------------------------------------------------------------

/// All uses of one resource by one pass of the plan, merged per cell range that they share.
struct Use {
    std::uint32_t slot = 0; ///< into Schedule::order
    std::uint32_t pass = none;
    std::uint32_t resource = none;
    std::uint32_t queue = 0;
    CellRange cells;
    AccessScope scope;
    bool reads = false;
    bool writes = false;
};
/// Which queue each kept pass runs on, in which order, and why: what assign.hpp decides.
struct Assignment {
    Scratch<std::uint32_t> order; ///< kept passes in submission order, which respects the data flow
    Scratch<std::uint32_t> queue; ///< parallel to order
    Scratch<QueueReason> reason;  ///< parallel to order
};
using Uses = std::span<const Use* const>;
/// The uses of one resource, cell by cell, in slot order. Its memory serves one resource after the other.
class CellUses {
public:
    /// O(uses x cells of each). `uses` must outlive what of() gives.
    void sort(const ResourceCells& cells, std::span<const Use> uses);
    [[nodiscard]] Uses of(std::uint32_t cell) const {
        return {uses_.data() + first_[cell], first_[cell + 1] - first_[cell]};
    }

private:
    Scratch<const Use*> uses_;
    Scratch<std::uint32_t> first_; ///< cells + 1 entries into uses_
    Scratch<std::uint32_t> next_;
};

struct QueueWait {
    std::uint32_t slot = 0;     ///< the waiting pass
    std::uint32_t producer = 0; ///< slot waited for
};
/// How far a queue's own work has come back to it: another queue waited for it, and it for that queue. The semaphores
/// on the way cover execution and memory, so that no barrier is needed between that work and what follows.
struct Return {
    std::uint32_t passes = 0;  ///< the first so many passes of the queue
    std::uint32_t from = none; ///< the queue waited for; `none` if `passes` is 0
};
struct Schedule {
    Scratch<std::uint32_t> order;    ///< kept passes in submission order
    Scratch<std::uint32_t> slot_of;  ///< by pass, `none` if culled
    Scratch<std::uint32_t> queue;    ///< by slot
    Scratch<std::uint32_t> position; ///< by slot: place on its queue
    Scratch<QueueReason> queue_reason;
    Scratch<Use> uses;                ///< grouped by resource, in slot order
    Scratch<std::uint32_t> first_use; ///< by resource, resources + 1 entries into `uses`
    Scratch<bool> concurrent;         ///< by resource: shared by families at once
    Scratch<QueueWait> waits;         ///< transitively reduced, in slot order
    Scratch<std::uint32_t> clocks;    ///< slots x queues: passes of each queue that happen before or at the slot
    Scratch<Return> returns;          ///< by slot
    std::uint32_t queue_count = 1;

    [[nodiscard]] bool happens_before(std::uint32_t slot_a, std::uint32_t slot_b) const {
        return slot_a != slot_b && clocks[slot_b * queue_count + queue[slot_a]] > position[slot_a];
    }
};
/// Derives what the assignment implies: uses, sharing, and the waits between queues, with vector clocks.
/// O((passes + edges) x queues).
[[nodiscard]] Schedule schedule(const GraphDesc& graph, const QueueTopology& topology, const Cells& cells,
                                const Flow& flow, const Assignment& assignment);

// ---- memory ------------------------------------------------------------------------------------------------------

struct Memory {
    std::vector<Placement> placements;
    std::vector<Heap> heaps;
    VkDeviceSize unaliased_bytes = 0;
    VkDeviceSize bound_bytes = 0;              ///< no packing is smaller
    Scratch<std::uint32_t> owners_before;      ///< of one resource after the other
    Scratch<std::uint32_t> first_owner_before; ///< by resource, into owners_before
    Scratch<std::uint32_t> owner_before_count; ///< by resource

    /// Those that lay in a resource's bytes last. All their accesses happen before its own, and theirs after those of
    /// whoever lay there before them.
    [[nodiscard]] std::span<const std::uint32_t> taken_over_by(std::uint32_t resource) const {
        return {owners_before.data() + first_owner_before[resource], owner_before_count[resource]};
    }
};
/// Two resources may share bytes only if every access of one happens before every access of the other in the schedule's
/// partial order. The lowest of several greedy packings, and of the previous plan's where that is still one, so that
/// memory does not move without need. `previous` may be null.
[[nodiscard]] Memory place(const GraphDesc& graph, const QueueTopology& topology, const Schedule& schedule,
                           const MemoryRequirements& requirements, const CompileOptions& options, const Plan* previous);

// ---- batch -------------------------------------------------------------------------------------------------------

struct Batches {
    std::vector<Batch> batches;      ///< passes index `order`
    Scratch<std::uint32_t> order;    ///< slots in submission order: batch by batch
    Scratch<std::uint32_t> batch_of; ///< by slot
};
/// A batch ends after a pass that another queue waits for and begins before a pass that waits.
[[nodiscard]] Batches make_batches(const GraphDesc& graph, const Schedule& schedule);

// ---- synchronise -------------------------------------------------------------------------------------------------

struct Synchronised {
    std::vector<Dependency> dependencies; ///< grouped by the consumer's slot, exits last
    Scratch<std::uint32_t> first_of_slot; ///< slots + 1 entries
    std::uint32_t first_exit = 0;
    Scratch<std::vector<std::uint32_t>> releases; ///< by batch, into dependencies
    std::vector<VkImageLayout> resting_layout;    ///< by resource, for histories
};
/// Walks each resource's uses in schedule order, cell by cell; reads that want the same layout share one dependency.
[[nodiscard]] Synchronised synchronise(const GraphDesc& graph, const QueueTopology& topology, const Cells& cells,
                                       const Schedule& schedule, const Memory& memory, const Batches& batches,
                                       bool full_barriers);

// ---- attachments -------------------------------------------------------------------------------------------------

struct Attachments {
    std::vector<AttachmentOps> operations; ///< grouped by slot
    Scratch<std::uint32_t> first_of_slot;  ///< slots + 1 entries
};
/// Load follows from the verb, store from later uses: what nobody reads is not stored. O(uses x cells of each).
[[nodiscard]] Attachments choose_attachment_operations(const GraphDesc& graph, const Cells& cells,
                                                       const Schedule& schedule);

} // namespace tyndall::rg::stages
