#include "tests/gpu/test_device.hpp"

#include <algorithm>
#include <cstring>

namespace tyndall::test {
namespace {

VKAPI_ATTR VkBool32 VKAPI_CALL collect(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                       const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    static_cast<TestDevice*>(user)->errors.emplace_back(data->pMessage);
    return VK_FALSE;
}

bool make_instance(TestDevice& out) {
    const VkDebugUtilsMessengerCreateInfoEXT messenger{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
                                                       .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
                                                       .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                                                                      VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT,
                                                       .pfnUserCallback = collect,
                                                       .pUserData = &out};
    const VkValidationFeatureEnableEXT enabled[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    const VkValidationFeaturesEXT features{.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                           .pNext = &messenger,
                                           .enabledValidationFeatureCount = 1,
                                           .pEnabledValidationFeatures = enabled};
    const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                        .pApplicationName = "tyndall tests",
                                        .apiVersion = VK_API_VERSION_1_3};
    const char* layer = "VK_LAYER_KHRONOS_validation";
    const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    const VkInstanceCreateInfo create{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                      .pNext = &features,
                                      .pApplicationInfo = &application,
                                      .enabledLayerCount = 1,
                                      .ppEnabledLayerNames = &layer,
                                      .enabledExtensionCount = 1,
                                      .ppEnabledExtensionNames = &extension};
    if (vkCreateInstance(&create, nullptr, &out.instance) != VK_SUCCESS) {
        return false;
    }
    const auto make_messenger = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(out.instance, "vkCreateDebugUtilsMessengerEXT"));
    return make_messenger != nullptr && make_messenger(out.instance, &messenger, nullptr, &out.messenger) == VK_SUCCESS;
}

bool has_push_descriptors(VkPhysicalDevice physical) {
    std::uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, extensions.data());
    return std::any_of(extensions.begin(), extensions.end(), [](const VkExtensionProperties& extension) {
        return std::strcmp(extension.extensionName, VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME) == 0;
    });
}

bool choose_device(TestDevice& out) {
    std::uint32_t count = 0;
    vkEnumeratePhysicalDevices(out.instance, &count, nullptr);
    std::vector<VkPhysicalDevice> devices(count);
    vkEnumeratePhysicalDevices(out.instance, &count, devices.data());
    for (const VkPhysicalDevice physical : devices) {
        vkGetPhysicalDeviceProperties(physical, &out.properties);
        if (out.properties.apiVersion < VK_API_VERSION_1_3 || !has_push_descriptors(physical)) {
            continue;
        }
        std::uint32_t families = 0;
        vkGetPhysicalDeviceQueueFamilyProperties(physical, &families, nullptr);
        std::vector<VkQueueFamilyProperties> properties(families);
        vkGetPhysicalDeviceQueueFamilyProperties(physical, &families, properties.data());
        for (std::uint32_t family = 0; family < families; ++family) {
            if ((properties[family].queueFlags & VK_QUEUE_GRAPHICS_BIT) != 0) {
                out.physical = physical;
                out.family = family;
                out.timestamp_valid_bits = properties[family].timestampValidBits;
                vkGetPhysicalDeviceMemoryProperties(physical, &out.memory_properties);
                return true;
            }
        }
    }
    return false;
}

bool make_device(TestDevice& out) {
    const float priority = 1.0F;
    const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                        .queueFamilyIndex = out.family,
                                        .queueCount = 1,
                                        .pQueuePriorities = &priority};
    VkPhysicalDeviceVulkan12Features features12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                                                .timelineSemaphore = VK_TRUE};
    VkPhysicalDeviceVulkan13Features features13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                                                .pNext = &features12,
                                                .synchronization2 = VK_TRUE,
                                                .dynamicRendering = VK_TRUE,
                                                .maintenance4 = VK_TRUE};
    VkPhysicalDeviceFeatures offered{};
    vkGetPhysicalDeviceFeatures(out.physical, &offered);
    out.dual_source_blending = offered.dualSrcBlend == VK_TRUE;
    const VkPhysicalDeviceFeatures core{.dualSrcBlend = offered.dualSrcBlend};
    const char* extension = VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME;
    const VkDeviceCreateInfo create{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                    .pNext = &features13,
                                    .queueCreateInfoCount = 1,
                                    .pQueueCreateInfos = &queue,
                                    .enabledExtensionCount = 1,
                                    .ppEnabledExtensionNames = &extension,
                                    .pEnabledFeatures = &core};
    if (vkCreateDevice(out.physical, &create, nullptr, &out.device) != VK_SUCCESS) {
        return false;
    }
    vkGetDeviceQueue(out.device, out.family, 0, &out.queue);
    const char* missing = nullptr;
    return rg::load_device_table(vkGetDeviceProcAddr, out.device, out.table, missing);
}

} // namespace

std::unique_ptr<TestDevice> TestDevice::create(std::string& why) {
    auto out = std::make_unique<TestDevice>();
    if (!make_instance(*out)) {
        why = "no Vulkan instance with the Khronos validation layer";
    } else if (!choose_device(*out)) {
        why = "no device with Vulkan 1.3 and VK_KHR_push_descriptor";
    } else if (!make_device(*out)) {
        why = "the device could not be created";
    } else {
        return out;
    }
    return nullptr;
}

TestDevice::~TestDevice() {
    if (device != VK_NULL_HANDLE) {
        vkDestroyDevice(device, nullptr);
    }
    if (messenger != VK_NULL_HANDLE) {
        const auto destroy_messenger = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(instance, "vkDestroyDebugUtilsMessengerEXT"));
        destroy_messenger(instance, messenger, nullptr);
    }
    if (instance != VK_NULL_HANDLE) {
        vkDestroyInstance(instance, nullptr);
    }
}

} // namespace tyndall::test
