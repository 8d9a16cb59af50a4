#include "engine/device.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cctype>
#include <cstring>
#include <utility>

namespace tyndall::engine {
namespace {

/// All feature structs that we ask about, chained.
struct Features {
    VkPhysicalDeviceFeatures2 core{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
    VkPhysicalDeviceVulkan11Features v11{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES};
    VkPhysicalDeviceVulkan12Features v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceVulkan13Features v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    Features() {
        core.pNext = &v11;
        v11.pNext = &v12;
        v12.pNext = &v13;
    }
    Features(const Features&) = delete;
    Features& operator=(const Features&) = delete;
};

std::vector<VkPhysicalDevice> physical_devices(const Instance& instance) {
    std::uint32_t count = 0;
    vkEnumeratePhysicalDevices(instance.handle(), &count, nullptr);
    std::vector<VkPhysicalDevice> devices(count);
    vkEnumeratePhysicalDevices(instance.handle(), &count, devices.data());
    return devices;
}

bool has_extension(VkPhysicalDevice device, const char* name) {
    std::uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data());
    return std::any_of(extensions.begin(), extensions.end(), [&](const VkExtensionProperties& extension) {
        return std::strcmp(extension.extensionName, name) == 0;
    });
}

std::string missing(VkPhysicalDevice device, const DeviceInfo& info) {
    if (info.api_version < VK_API_VERSION_1_3) {
        return "Vulkan 1.3";
    }
    Features have;
    vkGetPhysicalDeviceFeatures2(device, &have.core);
    const std::array<std::pair<VkBool32, const char*>, 5> needed = {{
        {have.v13.synchronization2, "synchronization2"},
        {have.v13.dynamicRendering, "dynamicRendering"},
        {have.v13.maintenance4, "maintenance4"},
        {have.v12.timelineSemaphore, "timelineSemaphore"},
        {has_extension(device, VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME) ? VK_TRUE : VK_FALSE, "VK_KHR_push_descriptor"},
    }};
    for (const auto& [there, name] : needed) {
        if (there == VK_FALSE) {
            return name;
        }
    }
    const bool graphics = std::any_of(info.queues.begin(), info.queues.end(), [](const QueueFamilyInfo& family) {
        constexpr VkQueueFlags both = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
        return (family.flags & both) == both;
    });
    return graphics ? "" : "a queue for graphics and compute";
}

DeviceInfo describe(VkPhysicalDevice device, std::uint32_t index) {
    VkPhysicalDeviceVulkan12Properties v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES};
    VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &v12};
    vkGetPhysicalDeviceProperties2(device, &properties);
    DeviceInfo info;
    info.index = index;
    info.name = properties.properties.deviceName;
    info.driver = std::string(v12.driverName) + " " + v12.driverInfo;
    info.api_version = properties.properties.apiVersion;
    info.type = properties.properties.deviceType;
    std::uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
    for (std::uint32_t i = 0; i < count; ++i) {
        info.queues.push_back({i, families[i].queueCount, families[i].queueFlags, families[i].timestampValidBits});
    }
    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(device, &memory);
    for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i) {
        info.heaps.push_back({memory.memoryHeaps[i].size, (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) != 0});
    }
    VkPhysicalDeviceFeatures features;
    vkGetPhysicalDeviceFeatures(device, &features);
    info.dual_source_blending = features.dualSrcBlend == VK_TRUE;
    info.max_anisotropy = features.samplerAnisotropy == VK_TRUE ? properties.properties.limits.maxSamplerAnisotropy : 1.0F;
    info.lacks = missing(device, info);
    return info;
}

int rank(VkPhysicalDeviceType type) {
    switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return 0;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return 1;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return 2;
    case VK_PHYSICAL_DEVICE_TYPE_CPU: return 3;
    default: return 4;
    }
}

std::string lower(std::string_view text) {
    std::string out(text);
    std::transform(out.begin(), out.end(), out.begin(), [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
    return out;
}

tl::expected<std::uint32_t, Error> choose(const std::vector<DeviceInfo>& devices, std::string_view choice) {
    if (devices.empty()) {
        return tl::unexpected(Error{"There is no Vulkan device; on a machine without a GPU install mesa-vulkan-drivers"});
    }
    std::string names;
    for (const DeviceInfo& device : devices) {
        names += (names.empty() ? "'" : ", '") + device.name + "'";
    }
    const DeviceInfo* best = nullptr;
    std::uint32_t index = 0;
    const auto [end, error] = std::from_chars(choice.data(), choice.data() + choice.size(), index);
    const bool is_index = !choice.empty() && error == std::errc{} && end == choice.data() + choice.size();
    for (const DeviceInfo& device : devices) {
        const bool fits = choice.empty() ? device.lacks.empty()
                          : is_index     ? device.index == index
                                         : lower(device.name + " " + device.driver).find(lower(choice)) != std::string::npos;
        if (fits && (best == nullptr || rank(device.type) < rank(best->type))) {
            best = &device;
        }
    }
    if (best == nullptr && choice.empty()) {
        return tl::unexpected(Error{"No device can be used: " + devices.front().name + " lacks " + devices.front().lacks});
    }
    if (best == nullptr) {
        return tl::unexpected(Error{"There is no device '" + std::string(choice) + "'; there is " + names});
    }
    if (!best->lacks.empty()) {
        return tl::unexpected(Error{"Device '" + best->name + "' cannot be used: it lacks " + best->lacks});
    }
    return best->index;
}

struct QueuePlan {
    rg::QueueKind kind;
    std::uint32_t family;
    std::uint32_t index;
};

/// Graphics; a compute queue beside it, from a family without graphics if there is one; a transfer queue likewise.
std::vector<QueuePlan> plan_queues(const std::vector<QueueFamilyInfo>& families) {
    std::vector<std::uint32_t> used(families.size(), 0);
    std::vector<QueuePlan> queues;
    const auto take = [&](rg::QueueKind kind, VkQueueFlags with, VkQueueFlags without) {
        for (const QueueFamilyInfo& family : families) {
            if ((family.flags & with) == with && (family.flags & without) == 0 && used[family.family] < family.count) {
                queues.push_back({kind, family.family, used[family.family]++});
                return true;
            }
        }
        return false;
    };
    take(rg::QueueKind::graphics, VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT, 0);
    if (!take(rg::QueueKind::compute, VK_QUEUE_COMPUTE_BIT, VK_QUEUE_GRAPHICS_BIT)) {
        take(rg::QueueKind::compute, VK_QUEUE_COMPUTE_BIT, 0);
    }
    take(rg::QueueKind::transfer, VK_QUEUE_TRANSFER_BIT, VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT);
    return queues;
}

} // namespace

std::vector<DeviceInfo> list_devices(const Instance& instance) {
    std::vector<DeviceInfo> devices;
    for (VkPhysicalDevice device : physical_devices(instance)) {
        devices.push_back(describe(device, static_cast<std::uint32_t>(devices.size())));
    }
    return devices;
}

std::string_view device_type_name(VkPhysicalDeviceType type) {
    switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return "discrete GPU";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return "integrated GPU";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return "virtual GPU";
    case VK_PHYSICAL_DEVICE_TYPE_CPU: return "processor";
    default: return "other";
    }
}

tl::expected<Device, Error> Device::create(const Instance& instance, std::string_view choice,
                                           const std::vector<const char*>& extensions) {
    const std::vector<DeviceInfo> devices = list_devices(instance);
    const tl::expected<std::uint32_t, Error> chosen = choose(devices, choice);
    if (!chosen) {
        return tl::unexpected(chosen.error());
    }
    Device device;
    device.info_ = devices[*chosen];
    device.physical_ = physical_devices(instance)[*chosen];
    VkPhysicalDeviceVulkan12Properties v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES};
    VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &v12};
    vkGetPhysicalDeviceProperties2(device.physical_, &properties);
    device.properties_ = properties.properties;
    device.lavapipe_ = v12.driverID == VK_DRIVER_ID_MESA_LLVMPIPE;
    device.debug_labels_ = instance.has_debug_utils();
    vkGetPhysicalDeviceMemoryProperties(device.physical_, &device.memory_);

    Features have;
    vkGetPhysicalDeviceFeatures2(device.physical_, &have.core);
    Features enable;
    enable.v13.synchronization2 = enable.v13.dynamicRendering = enable.v13.maintenance4 = VK_TRUE;
    enable.v12.timelineSemaphore = VK_TRUE;
    const VkPhysicalDeviceFeatures& can = have.core.features;
    VkPhysicalDeviceFeatures& want = enable.core.features;
    want.samplerAnisotropy = can.samplerAnisotropy;
    want.dualSrcBlend = can.dualSrcBlend;
    want.independentBlend = can.independentBlend;
    want.depthClamp = can.depthClamp;
    want.depthBiasClamp = can.depthBiasClamp;
    want.multiDrawIndirect = can.multiDrawIndirect;
    want.drawIndirectFirstInstance = can.drawIndirectFirstInstance;
    want.fragmentStoresAndAtomics = can.fragmentStoresAndAtomics;
    want.vertexPipelineStoresAndAtomics = can.vertexPipelineStoresAndAtomics;
    want.shaderStorageImageExtendedFormats = can.shaderStorageImageExtendedFormats;
    want.imageCubeArray = can.imageCubeArray;
    enable.v12.scalarBlockLayout = have.v12.scalarBlockLayout;
    enable.v11.shaderDrawParameters = have.v11.shaderDrawParameters;

    const std::vector<QueuePlan> plan = plan_queues(device.info_.queues);
    std::vector<VkDeviceQueueCreateInfo> queue_infos;
    const std::array<float, 3> priorities = {1.0F, 1.0F, 1.0F};
    for (const QueuePlan& queue : plan) {
        const auto same = std::find_if(queue_infos.begin(), queue_infos.end(), [&](const VkDeviceQueueCreateInfo& info) {
            return info.queueFamilyIndex == queue.family;
        });
        if (same != queue_infos.end()) {
            ++same->queueCount;
        } else {
            queue_infos.push_back({.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                   .queueFamilyIndex = queue.family,
                                   .queueCount = 1,
                                   .pQueuePriorities = priorities.data()});
        }
    }
    std::vector<const char*> enabled = extensions;
    enabled.push_back(VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME);
    const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                  .pNext = &enable.core,
                                  .queueCreateInfoCount = static_cast<std::uint32_t>(queue_infos.size()),
                                  .pQueueCreateInfos = queue_infos.data(),
                                  .enabledExtensionCount = static_cast<std::uint32_t>(enabled.size()),
                                  .ppEnabledExtensionNames = enabled.data()};
    if (const VkResult result = vkCreateDevice(device.physical_, &info, nullptr, &device.device_); result != VK_SUCCESS) {
        return tl::unexpected(Error{"Device '" + device.info_.name + "' could not be opened (VkResult " + std::to_string(result) + ")"});
    }
    device.get_proc_ = reinterpret_cast<PFN_vkGetDeviceProcAddr>(vkGetInstanceProcAddr(instance.handle(), "vkGetDeviceProcAddr"));
    const char* lacking = nullptr;
    if (!rg::load_device_table(device.get_proc_, device.device_, device.vk_, lacking)) {
        return tl::unexpected(Error{"Device '" + device.info_.name + "' lacks the function vk" + lacking});
    }
    for (const QueuePlan& queue : plan) {
        VkQueue handle = VK_NULL_HANDLE;
        device.vk_.GetDeviceQueue(device.device_, queue.family, queue.index, &handle);
        device.queues_.push_back({queue.kind, handle, queue.family, device.info_.queues[queue.family].timestamp_valid_bits});
    }
    return device;
}

rg::ExecutorInfo Device::executor_info(bool profile) const {
    return {.get_device_proc_addr = get_proc_,
            .device = device_,
            .memory_properties = memory_,
            .buffer_image_granularity = properties_.limits.bufferImageGranularity,
            .timestamp_period_ns = properties_.limits.timestampPeriod,
            .queues = queues_,
            .profile = profile,
            .timestamps_need_full_barrier = lavapipe_,
            .debug_labels = debug_labels_};
}

Device::Device(Device&& other) noexcept
    : device_(std::exchange(other.device_, VK_NULL_HANDLE)), physical_(other.physical_), vk_(other.vk_),
      info_(std::move(other.info_)), properties_(other.properties_), memory_(other.memory_),
      queues_(std::move(other.queues_)), get_proc_(other.get_proc_), lavapipe_(other.lavapipe_),
      debug_labels_(other.debug_labels_) {}

Device::~Device() {
    if (device_ != VK_NULL_HANDLE && vk_.DestroyDevice != nullptr) {
        vk_.DeviceWaitIdle(device_);
        vk_.DestroyDevice(device_, nullptr);
    }
}

} // namespace tyndall::engine
