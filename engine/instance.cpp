#include "engine/instance.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

namespace tyndall::engine {
namespace {

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";

VkBool32 VKAPI_PTR on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity, VkDebugUtilsMessageTypeFlagsEXT,
                              const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    const bool is_error = (severity & VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT) != 0;
    static_cast<ValidationLog*>(user)->add(is_error, data->pMessage);
    return VK_FALSE;
}

bool has_layer(const char* name) {
    std::uint32_t count = 0;
    vkEnumerateInstanceLayerProperties(&count, nullptr);
    std::vector<VkLayerProperties> layers(count);
    vkEnumerateInstanceLayerProperties(&count, layers.data());
    return std::any_of(layers.begin(), layers.end(),
                       [&](const VkLayerProperties& layer) { return std::strcmp(layer.layerName, name) == 0; });
}

bool has_extension(const char* layer, const char* name) {
    std::uint32_t count = 0;
    vkEnumerateInstanceExtensionProperties(layer, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateInstanceExtensionProperties(layer, &count, extensions.data());
    return std::any_of(extensions.begin(), extensions.end(), [&](const VkExtensionProperties& extension) {
        return std::strcmp(extension.extensionName, name) == 0;
    });
}

} // namespace

void ValidationLog::add(bool is_error, std::string message) {
    const std::lock_guard lock(mutex_);
    (is_error ? errors_ : warnings_).push_back(std::move(message));
}
std::vector<std::string> ValidationLog::errors() const {
    const std::lock_guard lock(mutex_);
    return errors_;
}
std::vector<std::string> ValidationLog::warnings() const {
    const std::lock_guard lock(mutex_);
    return warnings_;
}
void ValidationLog::clear() {
    const std::lock_guard lock(mutex_);
    errors_.clear();
    warnings_.clear();
}

tl::expected<VulkanInstance, Error> VulkanInstance::create(Validation validation,
                                                           const std::vector<const char*>& extensions) {
    std::uint32_t version = 0;
    if (vkEnumerateInstanceVersion(&version) != VK_SUCCESS || version < VK_API_VERSION_1_3) {
        return tl::unexpected(Error{"The Vulkan loader is older than 1.3; install a newer libvulkan1"});
    }
    const bool validate = validation != Validation::off;
    if (validate && !has_layer(validation_layer)) {
        return tl::unexpected(Error{"Validation is asked for, but VK_LAYER_KHRONOS_validation is not installed "
                                    "(package vulkan-validationlayers)"});
    }
    VulkanInstance instance;
    std::vector<const char*> enabled = extensions;
    instance.debug_utils_ = has_extension(nullptr, VK_EXT_DEBUG_UTILS_EXTENSION_NAME) ||
                            (validate && has_extension(validation_layer, VK_EXT_DEBUG_UTILS_EXTENSION_NAME));
    if (instance.debug_utils_) {
        enabled.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    }
    std::vector<const char*> layers;
    if (validate) {
        layers.push_back(validation_layer);
        enabled.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
    }
    // Chained into creation too, so that what happens while the instance itself is made is heard.
    const VkDebugUtilsMessengerCreateInfoEXT messenger{
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        // Not GENERAL: the loader's complaints about other drivers of the machine are none of ours.
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = instance.log_.get()};
    const std::array synchronization = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    const VkValidationFeaturesEXT features{.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                           .pNext = &messenger,
                                           .enabledValidationFeatureCount =
                                               validation == Validation::core_and_synchronization ? 1U : 0U,
                                           .pEnabledValidationFeatures = synchronization.data()};
    const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                        .pApplicationName = "tyndall",
                                        .pEngineName = "tyndall",
                                        .apiVersion = VK_API_VERSION_1_3};
    const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                    .pNext = validate ? &features : nullptr,
                                    .pApplicationInfo = &application,
                                    .enabledLayerCount = static_cast<std::uint32_t>(layers.size()),
                                    .ppEnabledLayerNames = layers.data(),
                                    .enabledExtensionCount = static_cast<std::uint32_t>(enabled.size()),
                                    .ppEnabledExtensionNames = enabled.data()};
    for (const char* extension : extensions) {
        if (!has_extension(nullptr, extension)) {
            return tl::unexpected(Error{std::string("The Vulkan loader does not have the extension ") + extension});
        }
    }
    if (const VkResult result = vkCreateInstance(&info, nullptr, &instance.instance_); result != VK_SUCCESS) {
        return tl::unexpected(Error{"No Vulkan instance could be made (VkResult " + std::to_string(result) + ")"});
    }
    if (validate) {
        const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(instance.instance_, "vkCreateDebugUtilsMessengerEXT"));
        create(instance.instance_, &messenger, nullptr, &instance.messenger_);
    }
    return instance;
}

VulkanInstance::VulkanInstance(VulkanInstance&& other) noexcept
    : instance_(std::exchange(other.instance_, VK_NULL_HANDLE)),
      messenger_(std::exchange(other.messenger_, VK_NULL_HANDLE)), debug_utils_(other.debug_utils_),
      log_(std::move(other.log_)) {}

VulkanInstance& VulkanInstance::operator=(VulkanInstance&& other) noexcept {
    if (this != &other) {
        destroy();
        instance_ = std::exchange(other.instance_, VK_NULL_HANDLE);
        messenger_ = std::exchange(other.messenger_, VK_NULL_HANDLE);
        debug_utils_ = other.debug_utils_;
        log_ = std::move(other.log_);
    }
    return *this;
}

VulkanInstance::~VulkanInstance() {
    destroy();
}

void VulkanInstance::destroy() {
    if (messenger_ != VK_NULL_HANDLE) {
        const auto destroy_messenger = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
        destroy_messenger(instance_, messenger_, nullptr);
    }
    if (instance_ != VK_NULL_HANDLE) {
        vkDestroyInstance(instance_, nullptr);
    }
}

} // namespace tyndall::engine
