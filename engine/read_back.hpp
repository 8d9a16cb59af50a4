// Reading device memory outside a frame: submits, waits and copies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/memory.hpp"

namespace tyndall::engine {

/// One level of one layer of a colour or depth image.
struct ImagePart {
    VkFormat format = VK_FORMAT_UNDEFINED;
    VkExtent3D extent = {1, 1, 1};                                   ///< of the level itself
    VkImageLayout layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL; ///< which it has, and keeps
    std::uint32_t mip = 0;
    std::uint32_t layer = 0;
};

/// Tightly packed texels, rows from the top. The image has TRANSFER_SRC usage; work submitted to the graphics queue
/// before is waited for.
[[nodiscard]] tl::expected<std::vector<std::byte>, Error> read_image(const Device& device, VkImage image,
                                                                     const ImagePart& part);

/// The whole buffer, which has TRANSFER_SRC usage.
[[nodiscard]] tl::expected<std::vector<std::byte>, Error> read_buffer(const Device& device, const Buffer& buffer);

} // namespace tyndall::engine
