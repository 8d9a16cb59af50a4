// Names of Vulkan's values, the same words in reports and in files.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <vulkan/vulkan_core.h>

namespace tyndall::rg {

/// A value, or a bit of a mask, and its name.
struct VulkanName {
    std::uint64_t value;
    std::string_view name;
};
using VulkanNames = std::span<const VulkanName>;

[[nodiscard]] VulkanNames format_names(); ///< those of formats.cpp, without VK_FORMAT_
[[nodiscard]] VulkanNames layout_names();
[[nodiscard]] VulkanNames stage_names();  ///< bits of VkPipelineStageFlags2
[[nodiscard]] VulkanNames access_names(); ///< bits of VkAccessFlags2
[[nodiscard]] VulkanNames aspect_names(); ///< bits of VkImageAspectFlags
[[nodiscard]] VulkanNames image_usage_names();
[[nodiscard]] VulkanNames buffer_usage_names();
[[nodiscard]] VulkanNames image_flag_names(); ///< bits of VkImageCreateFlags

/// The value's name, nothing where the table has none. O(names).
[[nodiscard]] std::optional<std::string_view> name_in(VulkanNames names, std::uint64_t value);
/// The value of that name, nothing where the table has none. O(names).
[[nodiscard]] std::optional<std::uint64_t> value_in(VulkanNames names, std::string_view name);

/// The names of a mask's bits, joined by '|', "none" for 0; bits without a name as one number.
[[nodiscard]] std::string mask_text(VulkanNames names, std::uint64_t mask);

} // namespace tyndall::rg
