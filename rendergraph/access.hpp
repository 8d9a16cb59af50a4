// How a pass can touch a resource. The one table that maps an access to stages, access masks, layout, usage and the
// kinds of queue that can do it; compile, verify and execute all read it from here.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include <vulkan/vulkan_core.h>

namespace tyndall::rg {

/// How the resource is bound. Whether it is read, written or both is said by the verb: `reads`, `writes`, `modifies`.
enum class Access : std::uint8_t {
    indirect_argument,            ///< draw, dispatch or trace arguments in a buffer
    index_buffer,                 ///
    vertex_buffer,                ///
    uniform_graphics,             ///< uniform buffer in vertex and fragment shaders
    uniform_compute,              ///
    sampled_graphics,             ///< sampled image (or texel buffer) in vertex and fragment shaders
    sampled_fragment,             ///
    sampled_compute,              ///
    storage_graphics,             ///< storage image or buffer in vertex and fragment shaders
    storage_fragment,             ///
    storage_compute,              ///
    color_attachment,             ///< dynamic rendering; the order of declaration is the attachment's index
    depth_attachment,             ///< depth and stencil tested, and written unless the verb is `reads`
    resolve_attachment,           ///< at the end of rendering the n-th takes the n-th multisampled color_attachment
    transfer_source,              ///< copy, blit and resolve commands
    transfer_destination,         ///< copy, blit, resolve and clear commands
    host,                         ///< mapped memory, read or written on the CPU
    acceleration_structure_build, ///< the structure is built, updated or copied; scratch and inputs too
    acceleration_structure_trace, ///< ray queries and ray tracing read it
    present,                      ///< handed to the presentation engine
};
inline constexpr std::size_t access_count = 20;

/// What a verb does to the content of the range it names.
enum class Direction : std::uint8_t {
    read,    ///< the named version's content is used
    replace, ///< a new version is made; the previous content of the range is dead
    modify,  ///< a new version is made from the previous one
};

[[nodiscard]] constexpr bool is_write(Direction d) {
    return d != Direction::read;
}
[[nodiscard]] constexpr bool is_read(Direction d) {
    return d != Direction::replace;
}

/// What kind of work a queue can do, as a bit mask.
enum QueueCapability : std::uint8_t { can_graphics = 1, can_compute = 2, can_transfer = 4, can_host = 8 };

/// One row of the access table. Masks of zero mean that the verb is not possible with this access.
struct AccessInfo {
    std::string_view name;
    VkPipelineStageFlags2 stages;
    VkAccessFlags2 read_mask;
    VkAccessFlags2 write_mask;
    VkImageLayout color_layout;           ///< VK_IMAGE_LAYOUT_UNDEFINED: images cannot be accessed so
    VkImageLayout depth_layout;           ///< for depth or stencil formats
    VkImageLayout depth_read_only_layout; ///< the same with the verb `reads`
    VkImageUsageFlags image_usage;
    VkBufferUsageFlags buffer_usage; ///< 0: buffers cannot be accessed so
    std::uint8_t needs;              ///< one of QueueCapability's bits
};

/// The row for `access`. Source of every row: Vulkan 1.3 specification, "Synchronization and Cache Control".
[[nodiscard]] const AccessInfo& access_info(Access access);

/// The access whose name in the table is `name`.
[[nodiscard]] std::optional<Access> access_from_name(std::string_view name);

[[nodiscard]] bool is_depth_or_stencil(VkFormat format);
[[nodiscard]] VkImageAspectFlags format_aspects(VkFormat format);
/// Bytes of one texel of an uncompressed format, 0 for formats that the graph does not know.
[[nodiscard]] std::uint32_t format_texel_bytes(VkFormat format);

/// Stages, masks and layout of one access to one resource, ready for a barrier.
struct AccessScope {
    VkPipelineStageFlags2 stages = 0;
    VkAccessFlags2 access = 0;
    VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED; ///< UNDEFINED for buffers
};
/// In the header, since compile asks it for every access.
[[nodiscard]] inline AccessScope access_scope(Access access, Direction direction, VkFormat format_or_undefined) {
    const AccessInfo& info = access_info(access);
    AccessScope scope;
    scope.stages = info.stages;
    scope.access = (is_read(direction) ? info.read_mask : VkAccessFlags2{0}) |
                   (is_write(direction) ? info.write_mask : VkAccessFlags2{0});
    if (access == Access::depth_attachment) {
        scope.access |= info.read_mask; // testing reads, also where a clear replaced the content
    }
    if (format_or_undefined != VK_FORMAT_UNDEFINED) {
        const bool depth = is_depth_or_stencil(format_or_undefined);
        scope.layout = !depth                         ? info.color_layout
                       : direction == Direction::read ? info.depth_read_only_layout
                                                      : info.depth_layout;
    }
    return scope;
}

} // namespace tyndall::rg
