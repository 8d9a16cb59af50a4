// The debug switch 'poison transients': what a pass is about to write for the first time is filled with a pattern, so
// that a pass that reads what nobody wrote shows it. NaN in floating-point colours and in buffers, which hold
// 0xFFFFFFFF; all bits set in integer texels; magenta in all other colours; depth 0.5 and stencil 0xA5.
// Full barriers stand around the fills and hide what a plan's own would let race: races are looked for without it.
#include <limits>
#include <string_view>

#include "rendergraph/executor_state.hpp"
#include "rendergraph/vulkan_names.hpp"

namespace tyndall::rg {
namespace {

constexpr VkPipelineStageFlags2 everything = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
constexpr VkAccessFlags2 any_access = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
constexpr std::uint32_t buffer_pattern = 0xFFFFFFFF;
constexpr VkClearDepthStencilValue depth_pattern = {0.5F, 0xA5};
constexpr VkDeviceSize fill_unit_bytes = 4; // vkCmdFillBuffer's

constexpr VkClearColorValue floats(float red, float green, float blue, float alpha) {
    return {.float32 = {red, green, blue, alpha}};
}
/// Numbers that a channel cannot hold would clear to anything.
VkClearColorValue largest_integers(std::string_view format) {
    if (format.starts_with("A2")) {
        return {.uint32 = {0x3FF, 0x3FF, 0x3FF, 3}};
    }
    const std::uint32_t largest = format.find("R8") != std::string_view::npos    ? 0xFF
                                  : format.find("R16") != std::string_view::npos ? 0xFFFF
                                                                                 : 0xFFFFFFFF;
    return {.uint32 = {largest, largest, largest, largest}};
}

VkClearColorValue color_pattern(VkFormat format) {
    const std::string_view name = name_in(format_names(), static_cast<std::uint64_t>(format)).value_or("");
    const auto says = [name](std::string_view part) { return name.find(part) != std::string_view::npos; };
    if (says("UINT")) {
        return largest_integers(name);
    }
    if (says("SINT")) {
        return {.int32 = {-1, -1, -1, -1}};
    }
    if (says("FLOAT") && format != VK_FORMAT_E5B9G9R9_UFLOAT_PACK32) { // a shared exponent leaves no room for it
        constexpr float nan = std::numeric_limits<float>::quiet_NaN();
        return floats(nan, nan, nan, nan);
    }
    return floats(1.0F, 0.0F, 1.0F, 1.0F);
}

/// Half open.
struct Bytes {
    VkDeviceSize begin = 0;
    VkDeviceSize end = 0;
};
Bytes bytes_of(const BufferRange& range, const BufferDesc& buffer) {
    return {range.offset, range.size == whole_buffer ? buffer.size_bytes : range.offset + range.size};
}

VkImageMemoryBarrier2 transition(VkImage image, const VkImageSubresourceRange& range, VkImageLayout from,
                                 VkImageLayout to) {
    return {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
            .srcStageMask = everything,
            .srcAccessMask = any_access,
            .dstStageMask = everything,
            .dstAccessMask = any_access,
            .oldLayout = from,
            .newLayout = to,
            .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .image = image,
            .subresourceRange = range};
}

} // namespace

bool can_poison(const ResourceDesc& desc) {
    // Formats without texels of a known size are compressed, and cannot be cleared, or are not known.
    return desc.lifetime == ResourceLifetime::transient &&
           (desc.kind == ResourceKind::buffer ||
            (format_texel_bytes(desc.image.format) > 0 &&
             (desc.image.extra_usage & VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT) == 0));
}

/// A transition that throws the content away: nothing that is still wanted lies there.
bool ExecutorState::starts_image(const Dependency& d, QueueKind queue) const {
    const ResourceDesc& desc = work.graph->resources[d.resource];
    const bool clearable =
        queue == QueueKind::graphics || (queue == QueueKind::compute && !is_depth_or_stencil(desc.image.format));
    return clearable && desc.kind == ResourceKind::image && d.old_layout == VK_IMAGE_LAYOUT_UNDEFINED &&
           d.new_layout != VK_IMAGE_LAYOUT_UNDEFINED && (d.dst_stages & VK_PIPELINE_STAGE_2_HOST_BIT) == 0 &&
           can_poison(desc) && work.objects[d.resource] != nullptr;
}

/// A write of bytes that no earlier pass of the plan touches. All that touch them later come after this write, so they
/// come after what is filled before it.
bool ExecutorState::starts_bytes(const AccessDesc& access) const {
    const ResourceDesc& desc = work.graph->resources[access.resource];
    if (desc.kind != ResourceKind::buffer || !is_write(access.direction) || access.access == Access::host ||
        !can_poison(desc) || work.objects[access.resource] == nullptr) {
        return false;
    }
    const Bytes mine = bytes_of(access.buffer_range, desc.buffer);
    for (const PlannedPass& planned : work.plan->passes) {
        if (planned.pass == access.pass) {
            break;
        }
        const PassDesc& pass = work.graph->passes[planned.pass];
        for (std::uint32_t i = pass.first_access; i < pass.first_access + pass.access_count; ++i) {
            const AccessDesc& other = work.graph->accesses[i];
            const Bytes theirs = bytes_of(other.buffer_range, desc.buffer);
            if (other.resource == access.resource && theirs.begin < mine.end && mine.begin < theirs.end) {
                return false;
            }
        }
    }
    return true;
}

void ExecutorState::poison(VkCommandBuffer cmd, const PlannedPass& planned) {
    const GraphDesc& graph = *work.graph;
    const PassDesc& pass = graph.passes[planned.pass];
    const QueueKind queue = queues[work.real_of[planned.queue]].info.kind;
    work.poisoned_images.clear();
    for (std::uint32_t i = planned.first_barrier; i < planned.first_barrier + planned.barrier_count; ++i) {
        const Dependency& d = work.plan->dependencies[i];
        if (starts_image(d, queue)) {
            const ImageRange& range = d.image_range;
            const VkImageAspectFlags aspects = format_aspects(graph.resources[d.resource].image.format);
            work.poisoned_images.push_back(
                {d.resource,
                 d.new_layout,
                 {aspects, range.base_mip, range.mip_count, range.base_layer, range.layer_count}});
        }
    }
    work.poisoned_buffers.clear();
    for (std::uint32_t i = pass.first_access; i < pass.first_access + pass.access_count; ++i) {
        if (starts_bytes(graph.accesses[i])) {
            work.poisoned_buffers.push_back(i);
        }
    }
    if (work.poisoned_images.empty() && work.poisoned_buffers.empty()) {
        return;
    }
    constexpr VkImageLayout cleared = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    whole_barrier(cmd);
    for (const PoisonedImage& image : work.poisoned_images) {
        work.image_barriers.push_back(
            transition(work.objects[image.resource]->image, image.range, image.layout, cleared));
    }
    flush_barriers(cmd);
    for (const PoisonedImage& image : work.poisoned_images) {
        const VkFormat format = graph.resources[image.resource].image.format;
        const VkImage object = work.objects[image.resource]->image;
        if (is_depth_or_stencil(format)) {
            vk.CmdClearDepthStencilImage(cmd, object, cleared, &depth_pattern, 1, &image.range);
        } else {
            const VkClearColorValue color = color_pattern(format);
            vk.CmdClearColorImage(cmd, object, cleared, &color, 1, &image.range);
        }
        work.image_barriers.push_back(transition(object, image.range, cleared, image.layout));
    }
    for (const std::uint32_t i : work.poisoned_buffers) {
        const AccessDesc& access = graph.accesses[i];
        const Bytes bytes = bytes_of(access.buffer_range, graph.resources[access.resource].buffer);
        const VkDeviceSize begin = (bytes.begin + fill_unit_bytes - 1) / fill_unit_bytes * fill_unit_bytes;
        const VkDeviceSize end = bytes.end / fill_unit_bytes * fill_unit_bytes;
        if (begin < end) {
            vk.CmdFillBuffer(cmd, work.objects[access.resource]->buffer, begin, end - begin, buffer_pattern);
        }
    }
    flush_barriers(cmd);
    whole_barrier(cmd);
}

} // namespace tyndall::rg
