#include "engine/device.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/queue_choice.hpp"

namespace tyndall::engine {
namespace {

constexpr std::array<float, 3> priorities = {1.0F, 1.0F, 1.0F}; // one for each queue that choose_queues may take

std::vector<VkDeviceQueueCreateInfo> by_family(const std::vector<QueueChoice>& queues) {
    std::vector<VkDeviceQueueCreateInfo> infos;
    for (const QueueChoice& queue : queues) {
        const auto same = std::find_if(infos.begin(), infos.end(), [&](const VkDeviceQueueCreateInfo& info) {
            return info.queueFamilyIndex == queue.family;
        });
        if (same != infos.end()) {
            ++same->queueCount;
        } else {
            infos.push_back({.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                             .queueFamilyIndex = queue.family,
                             .queueCount = 1,
                             .pQueuePriorities = priorities.data()});
        }
    }
    return infos;
}

Error not_opened(const DeviceInfo& info, VkResult result) {
    const char* why = result == VK_ERROR_EXTENSION_NOT_PRESENT ? "an extension that was asked for is not there"
                      : result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY
                          ? "it is out of memory"
                      : result == VK_ERROR_DEVICE_LOST ? "it is lost"
                                                       : "its driver failed";
    return {"Device '" + info.name + "' could not be opened: " + why + " (VkResult " + std::to_string(result) + ")"};
}

} // namespace

tl::expected<Device, Error> Device::create(const VulkanInstance& instance, std::string_view choice,
                                           const std::vector<const char*>& extensions) {
    const std::vector<DeviceInfo> devices = list_devices(instance);
    const tl::expected<std::uint32_t, Error> chosen = choose_device(devices, choice);
    if (!chosen) {
        return tl::unexpected(chosen.error());
    }
    Device device;
    device.info_ = devices[*chosen];
    device.physical_ = physical_devices(instance)[*chosen];
    vkGetPhysicalDeviceProperties(device.physical_, &device.properties_);
    vkGetPhysicalDeviceMemoryProperties(device.physical_, &device.memory_);
    device.debug_labels_ = instance.has_debug_utils();

    FeatureChain offered;
    FeatureChain enabled_features;
    vkGetPhysicalDeviceFeatures2(device.physical_, &offered.core);
    enable_features(offered, enabled_features);
    const std::vector<QueueChoice> queues = choose_queues(device.info_.queues);
    const std::vector<VkDeviceQueueCreateInfo> queue_infos = by_family(queues);
    std::vector<const char*> enabled = extensions;
    enabled.push_back(VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME);
    const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                  .pNext = &enabled_features.core,
                                  .queueCreateInfoCount = static_cast<std::uint32_t>(queue_infos.size()),
                                  .pQueueCreateInfos = queue_infos.data(),
                                  .enabledExtensionCount = static_cast<std::uint32_t>(enabled.size()),
                                  .ppEnabledExtensionNames = enabled.data()};
    if (const VkResult result = vkCreateDevice(device.physical_, &info, nullptr, &device.device_);
        result != VK_SUCCESS) {
        return tl::unexpected(not_opened(device.info_, result));
    }
    device.get_proc_ =
        reinterpret_cast<PFN_vkGetDeviceProcAddr>(vkGetInstanceProcAddr(instance.handle(), "vkGetDeviceProcAddr"));
    const char* lacking = nullptr;
    if (!rg::load_device_table(device.get_proc_, device.device_, device.vk_, lacking)) {
        return tl::unexpected(Error{"Device '" + device.info_.name + "' lacks the function " + lacking});
    }
    for (const QueueChoice& queue : queues) {
        VkQueue handle = VK_NULL_HANDLE;
        device.vk_.GetDeviceQueue(device.device_, queue.family, queue.index, &handle);
        device.queues_.push_back(
            {queue.kind, handle, queue.family, device.info_.queues[queue.family].timestamp_valid_bits});
    }
    return device;
}

std::vector<std::uint32_t> Device::queue_families() const {
    std::vector<std::uint32_t> families;
    for (const rg::DeviceQueue& queue : queues_) {
        if (std::find(families.begin(), families.end(), queue.family) == families.end()) {
            families.push_back(queue.family);
        }
    }
    return families;
}

rg::ExecutorInfo Device::executor_info(bool profile) const {
    return {.get_device_proc_addr = get_proc_,
            .device = device_,
            .memory_properties = memory_,
            .buffer_image_granularity = properties_.limits.bufferImageGranularity,
            .timestamp_period_ns = properties_.limits.timestampPeriod,
            .queues = queues_,
            .profile = profile,
            .timestamps_need_full_barrier = is_lavapipe(),
            .debug_labels = debug_labels_};
}

Device::Device(Device&& other) noexcept
    : device_(std::exchange(other.device_, VK_NULL_HANDLE)), physical_(other.physical_), vk_(other.vk_),
      info_(std::move(other.info_)), properties_(other.properties_), memory_(other.memory_),
      queues_(std::move(other.queues_)), get_proc_(other.get_proc_), debug_labels_(other.debug_labels_) {}

void Device::set_name(VkObjectType type, std::uint64_t handle, const char* name) const {
    if (vk_.SetDebugUtilsObjectNameEXT == nullptr) {
        return;
    }
    const VkDebugUtilsObjectNameInfoEXT info{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
                                             .objectType = type,
                                             .objectHandle = handle,
                                             .pObjectName = name};
    vk_.SetDebugUtilsObjectNameEXT(device_, &info);
}

Device::~Device() {
    if (device_ != VK_NULL_HANDLE && vk_.DestroyDevice != nullptr) {
        vk_.DeviceWaitIdle(device_);
        vk_.DestroyDevice(device_, nullptr);
    }
}

} // namespace tyndall::engine
