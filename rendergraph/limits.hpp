// The limits inside which sums of a frame's numbers cannot overflow. Internal.
#pragma once

#include <cstdint>

#include <vulkan/vulkan_core.h>

namespace tyndall::rg {

/// Of all transients together: more than any device has.
inline constexpr VkDeviceSize most_bytes = VkDeviceSize{1} << 50U;
/// Of each size and offset in a plan's file: what lies between transients counts too.
inline constexpr VkDeviceSize most_plan_bytes = 2 * most_bytes;
/// Of a frame, in a plan's file.
inline constexpr std::int64_t most_ns = std::int64_t{1} << 60U;

} // namespace tyndall::rg
