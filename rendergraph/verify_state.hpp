// What the checker knows of memory while it replays: the state of each part of each resource, and whose bytes lie
// where. Internal to the checker.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "rendergraph/verify_order.hpp"

namespace tyndall::rg::checker {

/// Accesses that see what was written, after a barrier on a queue.
struct Sight {
    std::uint32_t queue = 0;
    StageSet stages = 0;
    VkAccessFlags2 access = 0;
};

/// An access, a layout transition or a change of owner, that later accesses may conflict with.
struct Event {
    std::uint32_t pass = none; ///< of its frame's graph; none: the host
    Point at;
    VkAccessFlags2 written = 0;             ///< the kinds of write; 0 for reads, and for what barriers do
    std::vector<Point> available_from = {}; ///< by barriers; what comes after any of these finds it available
    std::vector<Sight> seen_by = {};
};

/// A part of a resource that all accesses touch wholly or not at all.
struct Atom {
    Region region = {};
    std::uint32_t version = 0; ///< of its content
    VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
    std::uint32_t owner = VK_QUEUE_FAMILY_IGNORED;       ///< IGNORED: nobody yet
    std::uint32_t released_to = VK_QUEUE_FAMILY_IGNORED; ///< with `released`
    bool defined = false;                                ///< it holds content
    bool released = false;                               ///< and not yet acquired
    bool begun = false;                                  ///< written since the object took its bytes
    bool written = false;                                ///< `last_write` is set
    Event last_write = {};
    std::vector<Event> reads = {}; ///< since then
};

/// One frame's use of one resource.
struct Object {
    std::uint32_t resource = none;
    std::uint32_t frame = 0;
    std::uint32_t heap = none; ///< none: memory of its own
    VkDeviceSize first_byte = 0, end_byte = 0;
    std::vector<std::uint64_t> cuts_a, cuts_b; ///< borders between atoms
    std::vector<std::uint32_t> writers;        ///< accesses, by the version that they make
    std::vector<Atom> atoms;
    std::size_t atoms_begun = 0;
    bool exclusive = true; ///< one queue family owns it at a time
    bool holds_bytes = false;
    bool touched = false;
    bool awaits_host = false;             ///< its host's semaphore has not been waited for
    Clock host_signal = {};               ///< what its host's semaphore comes after, once signalled
    std::vector<std::uint32_t> displaced; ///< objects whose bytes it took over, until all of it is begun
};
/// Atoms that lie in the region (`inside`), or meet it.
struct AtomRange {
    std::size_t first_a, end_a, first_b, end_b;
};
[[nodiscard]] AtomRange atoms_inside(const Object& object, const Region& region);
[[nodiscard]] AtomRange atoms_meeting(const Object& object, const Region& region);
template <typename F>
void for_atoms(Object& object, const AtomRange& range, F&& f) {
    const std::size_t width = object.cuts_b.size() - 1;
    for (std::size_t a = range.first_a; a < range.end_a; ++a) {
        for (std::size_t b = range.first_b; b < range.end_b; ++b) {
            f(object.atoms[a * width + b]);
        }
    }
}

/// The objects of one frame of the plan after another.
class Memory {
public:
    /// Objects for another frame; what the frame before left is carried over: bytes of heaps, histories, imports.
    void begin_frame(const GraphDesc& graph, const Plan& plan, Order& order);

    [[nodiscard]] std::uint32_t frame() const { return frame_; }
    [[nodiscard]] Object& of_resource(std::uint32_t resource) { return objects_[current_[resource]]; }
    [[nodiscard]] Object& at(std::uint32_t index) { return objects_[index]; }

    /// Objects in whose bytes this one would lie.
    [[nodiscard]] std::vector<std::uint32_t> neighbours(const Object& object);
    /// The object takes its bytes, unless it has them; what others kept there is lost.
    void take_bytes(std::uint32_t resource);
    /// The atom has new content, or a new layout; whoever had its bytes before no longer matters, once all atoms do.
    void begin(Object& object, Atom& atom);

private:
    struct Tenants {
        VkDeviceSize end = 0;
        std::vector<std::uint32_t> objects = {};
    };
    using Heap = std::map<VkDeviceSize, Tenants>; ///< by first byte; what is not in it was never used
    void cut(Heap& heap, VkDeviceSize at);
    void add_to_heap(std::uint32_t index);

    Object make_object(const GraphDesc& graph, const Plan& plan, std::uint32_t resource,
                       std::span<const std::uint32_t> accesses);
    void carry_over(const GraphDesc& graph, const Plan& plan, const std::vector<std::uint32_t>& last);

    std::vector<Object> objects_;
    std::vector<std::uint32_t> current_; ///< this frame's objects by resource
    std::vector<Heap> heaps_;
    const GraphDesc* last_graph_ = nullptr;
    const Plan* last_plan_ = nullptr;
    std::uint32_t frame_ = 0; ///< the number of the present one, from 1
};

} // namespace tyndall::rg::checker
