// A logical device with the queues that a frame graph can use.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>
#include <vulkan/vulkan.h>

#include "engine/device_info.hpp"
#include "engine/error.hpp"
#include "engine/instance.hpp"
#include "rendergraph/device_table.hpp"
#include "rendergraph/executor.hpp"

namespace tyndall::engine {

/// Everything made from a device keeps its address: it is not moved once something has been made, and outlives it all.
class Device {
public:
    /// `choice` as choose_device takes it; `extensions` beside those that we need ourselves, as a window wants.
    [[nodiscard]] static tl::expected<Device, Error> create(const VulkanInstance& instance,
                                                            std::string_view choice = {},
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
    /// Each family of those queues once: who shares a buffer that passes on any queue may use.
    [[nodiscard]] std::vector<std::uint32_t> queue_families() const;
    /// Mesa's driver for processors, whose timestamps need a full barrier each.
    [[nodiscard]] bool is_lavapipe() const { return info_.driver_id == VK_DRIVER_ID_MESA_LLVMPIPE; }
    /// For rg::Executor::create, with this device's handles, queues and quirks filled in.
    [[nodiscard]] rg::ExecutorInfo executor_info(bool profile) const;

    /// For captures and validation messages; without debug utils it does nothing.
    void set_name(VkObjectType type, std::uint64_t handle, const char* name) const;
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
    bool debug_labels_ = false;
};

} // namespace tyndall::engine
