// A compiled frame: plain data that says what runs where, when, in which memory, after which barriers and waits, and
// why. Everything after compile reads it and nothing else: executing, explaining, drawing, checking.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rendergraph/graph_desc.hpp"

namespace tyndall::rg {

// ---- inputs of compile beside the graph --------------------------------------------------------------------------

/// A logical queue of the plan.
struct QueueInfo {
    QueueKind kind = QueueKind::graphics;
    std::uint32_t family = 0; ///< queue family; two logical queues of one family need no ownership transfers
    std::uint8_t capabilities = can_graphics | can_compute | can_transfer;
};
/// The logical queues; the first one is the graphics queue. The executor folds them onto the device's real ones.
struct QueueTopology {
    std::vector<QueueInfo> queues = {QueueInfo{}};
};

/// What memory a resource needs; `alignment` a power of two.
struct MemoryRequirement {
    VkDeviceSize size_bytes = 0;
    VkDeviceSize alignment = 1;
    std::uint32_t memory_type_bits = ~0U;
};
struct MemoryRequirements {
    std::vector<MemoryRequirement> of_resource; ///< by resource; imported ones are ignored
    VkDeviceSize buffer_image_granularity = 1;  ///< VkPhysicalDeviceLimits::bufferImageGranularity
};
/// Requirements from formats and extents alone, for planning without a driver: tight texels, 256-byte alignment for
/// buffers, 4 KiB for images.
[[nodiscard]] MemoryRequirements estimate_memory(const GraphDesc& graph);

enum class Effort : std::uint8_t {
    quick,    ///< what a frame has time for
    thorough, ///< for a thread beside the frame: see refine.hpp
};

/// Debug switches, each of which turns off one thing the compiler does; and how hard it tries.
struct CompileOptions {
    bool culling = true;
    bool aliasing = true;
    bool async = true;             ///< false: everything on the graphics queue
    bool reordering = true;        ///< false: each queue keeps the order of declaration where the data allow it
    bool full_barriers = false;    ///< true: every dependency waits for all commands and all memory
    Effort effort = Effort::quick; ///< of placing transients: the rounds in which greedy packings are improved
};

// ---- why ---------------------------------------------------------------------------------------------------------

enum class KeepReason : std::uint8_t { side_effect, writes_import, writes_history, feeds_kept_pass };
enum class CullReason : std::uint8_t {
    no_consumer,       ///< nothing reads what it writes; `resource` names its first output
    consumer_culled,   ///< all that read it were culled themselves; `pass` names the first
    all_passes_culled, ///< a resource that only culled passes touch
    never_used,        ///< a resource that no pass touches
    other_form,        ///< another form of its variant is kept; `because_of` names the variant
};
enum class QueueReason : std::uint8_t {
    only_queue_that_can,
    asked_for,
    default_graphics,
    asked_for_but_no_such_queue,
    async_switched_off,
    import_ordered_by_queue, ///< it touches an import; only the first queue is ordered with the host's use of it
    import_not_shared,       ///< it touches an import that other families use too, and that the host does not share
    forbidden,               ///< the pass may not run on any other queue that could
    overlap_pays,            ///< there it runs beside other work, and the frame is predicted to be shorter
    earliest_here,           ///< the frame overlaps, but no other queue is predicted to finish this pass earlier
};
/// Why the frame overlaps, or does not, where nobody asked for a queue.
enum class DecisionReason : std::uint8_t {
    one_queue,               ///< the topology has no other queue
    switched_off,            ///< CompileOptions::async
    nothing_async_capable,   ///< no pass that is free to choose can run anywhere else
    nothing_measured,        ///< no pass has a known duration: nothing to decide by
    ceiling_below_threshold, ///< not even a perfect schedule would gain enough
    gain_below_threshold,    ///< the best schedule found does not gain enough
    overlap_pays,
    forced, ///< passes were asked onto other queues, and moving more does not gain enough
};
/// Why a resource has its bytes with others, or alone.
enum class MemoryReason : std::uint8_t {
    not_created,    ///< culled
    host_owns,      ///< imported
    outlives_frame, ///< a history and its resource: two copies that swap each frame
    takes_over,     ///< bytes of resources whose uses all come before; they may be taken over in their turn
    is_taken_over,  ///< by resources whose uses all come after
    never_idle,     ///< refused: no other transient of its memory is sure to be idle while it is in use
    better_apart,   ///< refused: others could have its bytes, but in the lowest placement found they have others
    sharing_off,    ///< CompileOptions::aliasing
};
enum class VariantReason : std::uint8_t {
    shortest_frame,
    kept_by_hysteresis, ///< the previous plan's form; no other gains more than the threshold
    nothing_measured,   ///< no pass has a known duration: the first form
};
enum class Hazard : std::uint8_t {
    read_after_write,
    write_after_read,
    write_after_write,
    layout_change,  ///< no data hazard; the next use wants another layout
    aliased_memory, ///< other bytes lived in this memory before; old layout UNDEFINED
    import_entry,   ///< the host's state on the way in
    import_exit,    ///< the host's wish on the way out
    frame_entry,    ///< the frame before may still use this memory; the executor orders whole frames, so src is dst
    history_rest,   ///< history is left in one layout between frames
};

[[nodiscard]] std::string_view name_of(Hazard hazard);

// ---- the plan ----------------------------------------------------------------------------------------------------

/// A memory dependency from a producer to a consumer over one range of one resource.
/// Same queue: a barrier before the consumer. Different queues: the consumer's batch waits for the producer's batch,
/// which covers memory; what remains before the consumer is a layout transition (chained to the wait) and the part that
/// comes from its own queue (`local_*`). An ownership transfer also has its release half at the producer's batch end.
/// `src_*` is always the whole dependency, so that folding queues onto one can use it as an ordinary barrier.
struct Dependency {
    std::uint32_t producer = none; ///< pass; `none`: the host, or the frame before
    std::uint32_t consumer = none; ///< pass; `none`: the host, after the frame
    std::uint32_t resource = none;
    Hazard hazard = Hazard::read_after_write;
    bool transfers_ownership = false;
    bool discards = false; ///< the old contents are not needed; old_layout is UNDEFINED
    ImageRange image_range = {};
    BufferRange buffer_range = {};
    VkPipelineStageFlags2 src_stages = 0;
    VkAccessFlags2 src_access = 0;
    VkPipelineStageFlags2 local_stages = 0; ///< the part of src_stages that no wait covers: of the consumer's own queue
    VkAccessFlags2 local_access = 0;
    VkPipelineStageFlags2 dst_stages = 0;
    VkAccessFlags2 dst_access = 0;
    VkImageLayout old_layout = VK_IMAGE_LAYOUT_UNDEFINED; ///< equal to new_layout where none is needed
    VkImageLayout new_layout = VK_IMAGE_LAYOUT_UNDEFINED;
    std::uint32_t src_queue =
        0; ///< logical queue; differs from dst_queue where a wait for that queue covers a producer
    std::uint32_t dst_queue = 0;
    std::uint32_t src_family = VK_QUEUE_FAMILY_IGNORED; ///< set when transfers_ownership
    std::uint32_t dst_family = VK_QUEUE_FAMILY_IGNORED;
    std::uint32_t alias_of = none; ///< for aliased_memory: the resource that lived there
    /// A resource whose uses rely on this order, so that they need no barrier of their own. The executor then says it
    /// of all memory, for validation that takes a resource's barrier for that resource's alone.
    std::uint32_t orders_for = none;
};

/// Load and store operations of one attachment access, in order of GraphDesc::accesses.
struct AttachmentOps {
    std::uint32_t access = none; ///< index into GraphDesc::accesses
    VkAttachmentLoadOp load = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    VkAttachmentStoreOp store = VK_ATTACHMENT_STORE_OP_DONT_CARE;
};

struct PlannedPass {
    std::uint32_t pass = none; ///< index into GraphDesc::passes
    std::uint32_t queue = 0;   ///< logical queue
    std::uint32_t batch = 0;
    std::uint32_t slot = 0; ///< position on its queue
    KeepReason keep_reason = KeepReason::feeds_kept_pass;
    std::uint32_t keep_for = none; ///< the pass (feeds_kept_pass) or resource that keeps it alive
    QueueReason queue_reason = QueueReason::default_graphics;
    std::uint32_t first_barrier =
        0; ///< into Plan::dependencies: recorded before the pass, in one vkCmdPipelineBarrier2
    std::uint32_t barrier_count = 0;
    std::uint32_t first_attachment = 0; ///< into Plan::attachments
    std::uint32_t attachment_count = 0;
};

struct CulledPass {
    std::uint32_t pass = none;
    CullReason reason = CullReason::no_consumer;
    std::uint32_t because_of = none; ///< resource (no_consumer), pass (consumer_culled) or variant (other_form)
};
struct CulledResource {
    std::uint32_t resource = none;
    CullReason reason = CullReason::never_used;
};

/// The consumer batch waits until `batch` has finished.
struct BatchWait {
    std::uint32_t batch = 0;
    VkPipelineStageFlags2 stages = 0;      ///< of the waiting batch
    std::uint32_t first_dependency = none; ///< one dependency that needs it, for reports; `none` for alias order
};
/// One submission. Batches are numbered in an order in which all waits look backward.
struct Batch {
    std::uint32_t queue = 0;
    std::uint32_t first_pass = 0; ///< into Plan::passes
    std::uint32_t pass_count = 0;
    std::vector<BatchWait> waits; ///< of batches on other queues
    /// Into Plan::dependencies: recorded at the end, in one vkCmdPipelineBarrier2. Release halves of ownership
    /// transfers (they have a consumer whose barriers hold the acquire half; dropped where both queues fold onto one),
    /// and whole dependencies that serve readers on several queues at once (consumer is the first of them; never
    /// dropped).
    std::vector<std::uint32_t> releases;
    std::vector<std::uint32_t> waits_imports;   ///< resources whose host semaphore it waits for
    std::vector<std::uint32_t> signals_imports; ///< resources whose host semaphore it signals
    bool signals = false;                       ///< some other batch waits for it
};

enum class PlacementKind : std::uint8_t {
    unplaced, ///< culled or imported
    heap,     ///< at `offset_bytes` of heap `heap`
    history,  ///< two copies that swap roles each frame, outside the heaps
};
struct Placement {
    PlacementKind kind = PlacementKind::unplaced;
    std::uint32_t heap = none;
    VkDeviceSize offset_bytes = 0;
    VkDeviceSize size_bytes = 0;
    VkImageUsageFlags image_usage = 0;
    VkBufferUsageFlags buffer_usage = 0;
    bool concurrent = false;             ///< shared by several queue families at once
    std::vector<std::uint32_t> families; ///< history: queue families that use either copy, ascending
    MemoryReason reason = MemoryReason::not_created;
    std::uint32_t shares_with = none; ///< a resource whose bytes it takes over, `none` if it has them alone
    std::uint32_t could_share = 0;    ///< transients of its heap that are never in use while it is
    VkImageLayout resting_layout = VK_IMAGE_LAYOUT_UNDEFINED; ///< history: of both copies between frames
};
struct Heap {
    std::uint32_t memory_type_bits = ~0U;
    VkDeviceSize size_bytes = 0;
};

/// Overlap or not, and what it was decided by. All times predicted by the model of simulate.hpp, in nanoseconds.
struct AsyncDecision {
    bool overlaps = false; ///< the plan uses more than one queue
    DecisionReason reason = DecisionReason::one_queue;
    std::int64_t serial_ns = 0;      ///< the frame on the graphics queue alone
    std::int64_t overlap_ns = 0;     ///< the best frame found with several queues; serial_ns where none was looked for
    std::int64_t lower_bound_ns = 0; ///< no schedule on these queues can be shorter
    std::int64_t ceiling_ns = 0;     ///< serial_ns - lower_bound_ns: what overlap could gain at most
    std::int64_t threshold_ns = 0;   ///< what it must gain
    bool kept_by_hysteresis = false; ///< the previous plan's schedule; a better one does not gain enough over it
    friend bool operator==(const AsyncDecision&, const AsyncDecision&) = default;
};
/// Which form of a variant was kept.
struct VariantDecision {
    std::uint32_t form = 0;
    VariantReason reason = VariantReason::nothing_measured;
    std::vector<std::int64_t> predicted_ns; ///< of the frame with each form
};

struct PlanStatistics {
    VkDeviceSize transient_bytes = 0;           ///< sum of heaps
    VkDeviceSize transient_bytes_unaliased = 0; ///< what it would be without sharing
    VkDeviceSize transient_bound_bytes = 0;     ///< no packing is smaller: resources that exclude each other
    std::uint32_t barrier_count = 0;            ///< Dependency records before passes
    std::uint32_t wait_count = 0;
};

struct Plan {
    QueueTopology topology;
    std::vector<PlannedPass> passes; ///< in submission order; a topological order over all queues
    std::vector<Batch> batches;
    std::vector<Dependency> dependencies; ///< grouped by consumer; those of the host (exit) last
    std::vector<AttachmentOps> attachments;
    std::vector<Placement> placements; ///< by resource
    std::vector<Heap> heaps;
    std::vector<CulledPass> culled_passes;
    std::vector<CulledResource> culled_resources;
    std::uint32_t first_exit_barrier = 0; ///< into dependencies: after the last pass (import exits)
    std::uint32_t exit_barrier_count = 0;
    PlanStatistics statistics;
    AsyncDecision decision;
    std::vector<VariantDecision> variants; ///< by GraphDesc::variants
    std::uint64_t passes_hash = 0; ///< of the names of the graph's passes: whether it fits a later frame's graph
};

} // namespace tyndall::rg
