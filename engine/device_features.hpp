// The one table of what we ask of a device: what we cannot do without, and what we use when it is there.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <vulkan/vulkan_core.h>

namespace tyndall::engine {

/// The features of core Vulkan 1.0 to 1.3, chained from `core`.
struct FeatureChain {
    VkPhysicalDeviceFeatures2 core{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
    VkPhysicalDeviceVulkan11Features v11{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES};
    VkPhysicalDeviceVulkan12Features v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceVulkan13Features v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};

    FeatureChain() {
        core.pNext = &v11;
        v11.pNext = &v12;
        v12.pNext = &v13;
    }
    FeatureChain(const FeatureChain&) = delete;
    FeatureChain& operator=(const FeatureChain&) = delete;
};

/// A row of the table, and whether a device has it.
struct FeatureSupport {
    std::string_view name; ///< as in the specification
    bool required = false;
    bool supported = false;
};

/// The table against what a device offers (vkGetPhysicalDeviceFeatures2), in the table's order.
[[nodiscard]] std::vector<FeatureSupport> feature_support(FeatureChain& offered);

/// Sets in `enabled` each feature of the table that is in `offered`.
void enable_features(FeatureChain& offered, FeatureChain& enabled);

/// The names of the required ones that are not supported, with commas; empty if all are there.
[[nodiscard]] std::string lacking_features(const std::vector<FeatureSupport>& support);

} // namespace tyndall::engine
