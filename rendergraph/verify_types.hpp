// What the checker reasons about: masks, regions of resources, events and how far they are known to reach. Internal; it
// shares nothing with the stages of compile.
#pragma once

#include <optional>

#include "rendergraph/verify.hpp"

namespace tyndall::rg::checker {

/// Indices inside their tables, every pass planned or left out once, batches in order, placements inside their heaps.
[[nodiscard]] std::vector<Violation> check_form(const GraphDesc& graph, const Plan& plan);

inline constexpr VkPipelineStageFlags2 all_commands = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
inline constexpr VkAccessFlags2 writing =
    VK_ACCESS_2_SHADER_WRITE_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT |
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT | VK_ACCESS_2_HOST_WRITE_BIT |
    VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR;

inline constexpr VkPipelineStageFlags2 only_graphics_stages =
    VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT |
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT |
    VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT | VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT |
    VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT;

/// `mask` names every stage of `stages`; ALL_COMMANDS names all but the host.
[[nodiscard]] inline bool covers_stages(VkPipelineStageFlags2 mask, VkPipelineStageFlags2 stages) {
    if ((mask & all_commands) != 0) {
        stages &= VK_PIPELINE_STAGE_2_HOST_BIT;
    }
    return (stages & ~mask) == 0;
}
[[nodiscard]] inline bool meets_stages(VkPipelineStageFlags2 a, VkPipelineStageFlags2 b) {
    const VkPipelineStageFlags2 device = ~VK_PIPELINE_STAGE_2_HOST_BIT;
    return (a & b) != 0 || ((a & all_commands) != 0 && (b & device) != 0) ||
           ((b & all_commands) != 0 && (a & device) != 0);
}
[[nodiscard]] inline bool covers_access(VkAccessFlags2 mask, VkAccessFlags2 access) {
    const bool all_reads = (mask & VK_ACCESS_2_MEMORY_READ_BIT) != 0;
    const bool all_writes = (mask & VK_ACCESS_2_MEMORY_WRITE_BIT) != 0;
    access &= ~mask;
    access &= all_reads ? writing : ~VkAccessFlags2{0};
    access &= all_writes ? ~writing : ~VkAccessFlags2{0};
    return access == 0;
}

/// A part of a resource: mips x layers of an image, or bytes of a buffer.
struct Region {
    std::uint64_t first_a = 0, end_a = 1; ///< mips, or bytes
    std::uint64_t first_b = 0, end_b = 1; ///< layers
    [[nodiscard]] bool meets(const Region& o) const {
        return first_a < o.end_a && o.first_a < end_a && first_b < o.end_b && o.first_b < end_b;
    }
    [[nodiscard]] bool contains(const Region& o) const {
        return first_a <= o.first_a && o.end_a <= end_a && first_b <= o.first_b && o.end_b <= end_b;
    }
};

[[nodiscard]] inline Region region_of(const ResourceDesc& resource, const ImageRange& image,
                                      const BufferRange& buffer) {
    if (resource.kind == ResourceKind::buffer) {
        const std::uint64_t end =
            buffer.size == whole_buffer ? resource.buffer.size_bytes : buffer.offset + buffer.size;
        return {buffer.offset, end, 0, 1};
    }
    const std::uint32_t mips =
        image.mip_count == all_remaining ? resource.image.mips - image.base_mip : image.mip_count;
    const std::uint32_t layers =
        image.layer_count == all_remaining ? resource.image.layers - image.base_layer : image.layer_count;
    return {image.base_mip, image.base_mip + mips, image.base_layer, image.base_layer + layers};
}

/// Where on one queue an event is known to have happened, and where its memory is visible.
struct Reach {
    VkPipelineStageFlags2 ordered = 0; ///< later commands in these stages come after it
    VkPipelineStageFlags2 visible_stages = 0;
    VkAccessFlags2 visible_access = 0;
};

/// An access, or a layout transition, that later ones may conflict with.
struct Event {
    std::uint32_t pass = none; ///< none: the host
    std::uint32_t resource = none;
    Region region;
    std::uint32_t queue = 0;
    VkPipelineStageFlags2 stages = 0; ///< 0 for transitions: reached only through `reach`
    VkAccessFlags2 access = 0;
    bool writes = false;
    bool available = false;
    std::vector<Reach> reach; ///< by queue
};

/// Layout, definedness and owner of one atom of a resource.
struct Atom {
    Region region;
    VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
    bool defined = false;
    std::uint32_t owner = VK_QUEUE_FAMILY_IGNORED; ///< IGNORED: nobody yet
    bool released = false;                         ///< to `released_to`, not yet acquired
    std::uint32_t released_to = VK_QUEUE_FAMILY_IGNORED;
};

/// What `event` wrote is visible, on some queue, to such an access.
[[nodiscard]] bool visible_anywhere(const Event& event, VkPipelineStageFlags2 stages, VkAccessFlags2 access);

/// What recording one dependency does.
struct Effect {
    VkPipelineStageFlags2 src, dst;
    VkAccessFlags2 src_access, dst_access;
    const Dependency* d;
    bool transition;
};
/// Recorded at a batch's end (`is_release`) or before its consumer; nothing where a semaphore is all that it needs.
[[nodiscard]] std::optional<Effect> effect_of(const Dependency& d, bool is_release);

/// The parts of a resource that its accesses tell apart, each in its state when the frame begins.
[[nodiscard]] std::vector<Atom> make_atoms(const GraphDesc& graph, const Plan& plan, std::uint32_t resource);

/// Two resources lie in the same bytes of a heap.
[[nodiscard]] bool share_bytes(const Plan& plan, std::uint32_t a, std::uint32_t b);

} // namespace tyndall::rg::checker
