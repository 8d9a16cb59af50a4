// What the machine's devices are and can do, and which one a name means.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "engine/device_features.hpp"
#include "engine/error.hpp"
#include "engine/instance.hpp"

namespace tyndall::engine {

struct QueueFamilyInfo {
    std::uint32_t family = 0;
    std::uint32_t count = 0;
    VkQueueFlags flags = 0;
    std::uint32_t timestamp_valid_bits = 0;
};
struct MemoryHeapInfo {
    VkDeviceSize size_bytes = 0;
    bool device_local = false;
};

/// A device, whether or not we can use it.
struct DeviceInfo {
    std::uint32_t index = 0;
    std::string name;
    std::string driver; ///< name and version in the driver's own words
    VkDriverId driver_id = {};
    int mesa_major = 0; ///< of Mesa's drivers: the first number of their version, which driverVersion does not tell
    std::uint32_t api_version = 0;
    VkPhysicalDeviceType type = VK_PHYSICAL_DEVICE_TYPE_OTHER;
    std::vector<QueueFamilyInfo> queues;
    std::vector<MemoryHeapInfo> heaps;
    std::vector<FeatureSupport> features; ///< empty when the device has no Vulkan 1.3
    float max_anisotropy = 1.0F;
    bool dual_source_blending = false;
    std::uint32_t max_push_descriptors = 0;
    std::string lacks; ///< what we need and it does not have; empty when it can be used
};

/// In the loader's order, which `index` counts.
[[nodiscard]] std::vector<DeviceInfo> list_devices(const VulkanInstance& instance);
[[nodiscard]] std::vector<VkPhysicalDevice> physical_devices(const VulkanInstance& instance);

/// The index of the device that `choice` means: part of its name or driver (case does not matter), or its index; empty:
/// the best that can be used. Of several, discrete goes before integrated before virtual before a processor, then the
/// first. The error names the devices that there are, or what the chosen one lacks.
[[nodiscard]] tl::expected<std::uint32_t, Error> choose_device(std::span<const DeviceInfo> devices,
                                                               std::string_view choice);

[[nodiscard]] std::string_view device_type_name(VkPhysicalDeviceType type);
/// "1.3.230"
[[nodiscard]] std::string version_text(std::uint32_t api_version);

} // namespace tyndall::engine
