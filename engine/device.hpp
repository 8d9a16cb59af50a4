// A logical device with the queues that a frame graph can use.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>
#include <vulkan/vulkan.h>

#include "engine/error.hpp"
#include "engine/instance.hpp"
#include "rendergraph/device_table.hpp"
#include "rendergraph/executor.hpp"

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

/// What a machine's device is and can do, whether or not we can use it.
struct DeviceInfo {
    std::uint32_t index = 0;
    std::string name;
    std::string driver; ///< name and version in the driver's own words
    std::uint32_t api_version = 0;
    VkPhysicalDeviceType type = VK_PHYSICAL_DEVICE_TYPE_OTHER;
    std::vector<QueueFamilyInfo> queues;
    std::vector<MemoryHeapInfo> heaps;
    float max_anisotropy = 1.0F;
    bool dual_source_blending = false;
    std::string lacks; ///< what we need and it does not have; empty when it can be used
};

[[nodiscard]] std::vector<DeviceInfo> list_devices(const Instance& instance);
[[nodiscard]] std::string_view device_type_name(VkPhysicalDeviceType type);

class Device {
public:
    /// `choice`: part of a name (case does not matter), or an index; empty: the best one, discrete before integrated
    /// before virtual before a processor. The error names the devices that there are.
    [[nodiscard]] static tl::expected<Device, Error> create(const Instance& instance, std::string_view choice = {},
                                                            const std::vector<const char*>& extensions = {});
    Device(Device&& other) noexcept;
    Device& operator=(Device&&) = delete;
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
    ~Device();

    [[nodiscard]] VkDevice handle() const { return device_; }
    [[nodiscard]] VkPhysicalDevice physical() const { return physical_; }
    [[nodiscard]] const rg::DeviceTable& vk() const { return vk_; }
    [[nodiscard]] const DeviceInfo& info() const { return info_; }
    [[nodiscard]] const VkPhysicalDeviceProperties& properties() const { return properties_; }
    [[nodiscard]] const VkPhysicalDeviceMemoryProperties& memory_properties() const { return memory_; }
    /// Graphics first; then async compute and transfer queues where the device has them.
    [[nodiscard]] const std::vector<rg::DeviceQueue>& queues() const { return queues_; }
    [[nodiscard]] const rg::DeviceQueue& graphics_queue() const { return queues_.front(); }
    [[nodiscard]] bool is_lavapipe() const { return lavapipe_; }
    /// For rg::Executor::create, with this device's handles, queues and quirks filled in.
    [[nodiscard]] rg::ExecutorInfo executor_info(bool profile) const;

    void wait_idle() const { vk_.DeviceWaitIdle(device_); }

private:
    Device() = default;
    VkDevice device_ = VK_NULL_HANDLE;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    rg::DeviceTable vk_ = {};
    DeviceInfo info_;
    VkPhysicalDeviceProperties properties_ = {};
    VkPhysicalDeviceMemoryProperties memory_ = {};
    std::vector<rg::DeviceQueue> queues_;
    PFN_vkGetDeviceProcAddr get_proc_ = nullptr;
    bool lavapipe_ = false;
    bool debug_labels_ = false;
};

} // namespace tyndall::engine
