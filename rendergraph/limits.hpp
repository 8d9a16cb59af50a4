// The limits inside which sums of a frame's numbers cannot overflow. Internal.
#pragma once

#include <cstdint>

#include <vulkan/vulkan_core.h>

namespace tyndall::rg {

/// Of all transients together, and of each size and offset in a plan's file: more than any device has.
inline constexpr VkDeviceSize most_bytes = VkDeviceSize{1} << 50U;
/// Of a frame, in a plan's file.
inline constexpr std::int64_t most_ns = std::int64_t{1} << 60U;

} // namespace tyndall::rg
