// The smallest Vulkan 1.3 device that the tests need, with core and synchronisation validation. It uses nothing of the
// engine, so that what these tests show is the graph's own work.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

#include "rendergraph/device_table.hpp"

namespace tyndall::test {

struct TestDevice {
    VkInstance instance = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
    VkPhysicalDevice physical = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    bool dual_source_blending = false; ///< dualSrcBlend is enabled
    std::uint32_t family = 0;
    std::uint32_t timestamp_valid_bits = 0;
    VkPhysicalDeviceProperties properties = {};
    VkPhysicalDeviceMemoryProperties memory_properties = {};
    rg::DeviceTable table = {};
    std::vector<std::string> errors; ///< of the validation layer

    TestDevice() = default;
    TestDevice(const TestDevice&) = delete;
    TestDevice& operator=(const TestDevice&) = delete;
    ~TestDevice();

    /// The first device with Vulkan 1.3 and push descriptors. Null if there is none, or no validation layer; `why` then
    /// says so.
    [[nodiscard]] static std::unique_ptr<TestDevice> create(std::string& why);
};

} // namespace tyndall::test
