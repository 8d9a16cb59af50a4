#include "engine/device_info.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstring>

namespace tyndall::engine {
namespace {

bool has_extension(VkPhysicalDevice device, const char* name) {
    std::uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data());
    return std::any_of(extensions.begin(), extensions.end(), [&](const VkExtensionProperties& extension) {
        return std::strcmp(extension.extensionName, name) == 0;
    });
}

/// "Mesa 22.3.6 (LLVM 15.0.6)" -> 22; 0 for other texts.
int mesa_major_version(std::string_view driver_info) {
    constexpr std::string_view start = "Mesa ";
    int major = 0;
    if (driver_info.starts_with(start)) {
        std::from_chars(driver_info.data() + start.size(), driver_info.data() + driver_info.size(), major);
    }
    return major;
}

bool has_main_queue(const DeviceInfo& info) {
    constexpr VkQueueFlags both = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    return std::any_of(info.queues.begin(), info.queues.end(),
                       [](const QueueFamilyInfo& family) { return (family.flags & both) == both; });
}

/// Features, limits and what is lacking of a device that has Vulkan 1.3, whose structs an older one does not know.
void describe_abilities(VkPhysicalDevice device, DeviceInfo& info) {
    FeatureChain offered;
    vkGetPhysicalDeviceFeatures2(device, &offered.core);
    info.features = feature_support(offered);
    info.lacks = lacking_features(info.features);

    VkPhysicalDevicePushDescriptorPropertiesKHR push{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PUSH_DESCRIPTOR_PROPERTIES_KHR};
    VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
    const bool pushes = has_extension(device, VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME);
    properties.pNext = pushes ? &push : nullptr;
    vkGetPhysicalDeviceProperties2(device, &properties);
    info.max_push_descriptors = push.maxPushDescriptors;
    info.dual_source_blending = offered.core.features.dualSrcBlend == VK_TRUE;
    if (offered.core.features.samplerAnisotropy == VK_TRUE) {
        info.max_anisotropy = properties.properties.limits.maxSamplerAnisotropy;
    }
    if (!pushes) {
        info.lacks += (info.lacks.empty() ? "" : ", ") + std::string(VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME);
    }
    if (!has_main_queue(info)) {
        info.lacks += std::string(info.lacks.empty() ? "" : ", ") + "a queue for graphics and compute";
    }
}

DeviceInfo describe(VkPhysicalDevice device, std::uint32_t index) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(device, &properties);
    DeviceInfo info;
    info.index = index;
    info.name = properties.deviceName;
    info.api_version = properties.apiVersion;
    info.type = properties.deviceType;
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
        const VkMemoryHeap& heap = memory.memoryHeaps[i];
        info.heaps.push_back({heap.size, (heap.flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) != 0});
    }
    if (info.api_version < VK_API_VERSION_1_3) {
        info.lacks = "Vulkan 1.3 (it has " + version_text(info.api_version) + ")";
        return info;
    }
    VkPhysicalDeviceVulkan12Properties v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES};
    VkPhysicalDeviceProperties2 more{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &v12};
    vkGetPhysicalDeviceProperties2(device, &more);
    info.driver = std::string(v12.driverName) + " " + v12.driverInfo;
    info.driver_id = v12.driverID;
    info.mesa_major = mesa_major_version(v12.driverInfo);
    describe_abilities(device, info);
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
    std::transform(out.begin(), out.end(), out.begin(),
                   [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
    return out;
}

bool is_meant(const DeviceInfo& device, std::string_view choice) {
    std::uint32_t index = 0;
    const auto [end, error] = std::from_chars(choice.data(), choice.data() + choice.size(), index);
    if (error == std::errc{} && end == choice.data() + choice.size()) {
        return device.index == index;
    }
    return lower(device.name + " " + device.driver).find(lower(choice)) != std::string::npos;
}

} // namespace

std::vector<VkPhysicalDevice> physical_devices(const VulkanInstance& instance) {
    std::uint32_t count = 0;
    vkEnumeratePhysicalDevices(instance.handle(), &count, nullptr);
    std::vector<VkPhysicalDevice> devices(count);
    vkEnumeratePhysicalDevices(instance.handle(), &count, devices.data());
    return devices;
}

std::vector<DeviceInfo> list_devices(const VulkanInstance& instance) {
    std::vector<DeviceInfo> devices;
    for (VkPhysicalDevice device : physical_devices(instance)) {
        devices.push_back(describe(device, static_cast<std::uint32_t>(devices.size())));
    }
    return devices;
}

tl::expected<std::uint32_t, Error> choose_device(std::span<const DeviceInfo> devices, std::string_view choice) {
    if (devices.empty()) {
        return tl::unexpected(
            Error{"There is no Vulkan device; on a machine without a GPU install mesa-vulkan-drivers"});
    }
    const DeviceInfo* best = nullptr;
    std::string names;
    for (const DeviceInfo& device : devices) {
        names += (names.empty() ? "'" : ", '") + device.name + "'";
        const bool fits = choice.empty() ? device.lacks.empty() : is_meant(device, choice);
        // One that can be used goes before one that cannot: a name may fit both.
        const auto worth = [](const DeviceInfo& d) { return rank(d.type) + (d.lacks.empty() ? 0 : 8); };
        if (fits && (best == nullptr || worth(device) < worth(*best))) {
            best = &device;
        }
    }
    if (best == nullptr && choice.empty()) {
        return tl::unexpected(
            Error{"No device can be used: '" + devices.front().name + "' lacks " + devices.front().lacks});
    }
    if (best == nullptr) {
        return tl::unexpected(Error{"There is no device '" + std::string(choice) + "'; there is " + names});
    }
    if (!best->lacks.empty()) {
        return tl::unexpected(Error{"Device '" + best->name + "' cannot be used: it lacks " + best->lacks});
    }
    return best->index;
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

std::string version_text(std::uint32_t api_version) {
    return std::to_string(VK_API_VERSION_MAJOR(api_version)) + "." + std::to_string(VK_API_VERSION_MINOR(api_version)) +
           "." + std::to_string(VK_API_VERSION_PATCH(api_version));
}

} // namespace tyndall::engine
