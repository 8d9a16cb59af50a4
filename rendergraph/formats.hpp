// How many bytes images of a format have.
#pragma once

#include <cstdint>

#include "rendergraph/vulkan_names.hpp"

namespace tyndall::rg {

/// What a format stores together: one texel, or the block of a compressed format.
struct FormatBlock {
    std::uint32_t bytes = 0; ///< 0: not known
    std::uint32_t width = 1; ///< in texels
    std::uint32_t height = 1;
};
/// Of the formats that format_names lists.
[[nodiscard]] FormatBlock format_block(VkFormat format);

} // namespace tyndall::rg
