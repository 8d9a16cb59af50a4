// The Vulkan instance, with or without the Khronos validation layer.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <tl/expected.hpp>
#include <vulkan/vulkan.h>

#include "engine/error.hpp"

namespace tyndall::engine {

enum class Validation : std::uint8_t { off, core, core_and_synchronization };

/// Messages of the validation layer, from any thread.
class ValidationLog {
public:
    void add(bool is_error, std::string message);
    [[nodiscard]] std::vector<std::string> errors() const;
    [[nodiscard]] std::vector<std::string> warnings() const;
    void clear();

private:
    mutable std::mutex mutex_;
    std::vector<std::string> errors_;
    std::vector<std::string> warnings_;
};

class VulkanInstance {
public:
    /// `extensions`: beside those that we need ourselves, as a window wants. Fails when there is no Vulkan 1.3 loader,
    /// or validation is asked for and its layer is not installed.
    [[nodiscard]] static tl::expected<VulkanInstance, Error> create(Validation validation,
                                                                    const std::vector<const char*>& extensions = {});
    VulkanInstance(VulkanInstance&& other) noexcept;
    VulkanInstance& operator=(VulkanInstance&& other) noexcept;
    VulkanInstance(const VulkanInstance&) = delete;
    VulkanInstance& operator=(const VulkanInstance&) = delete;
    ~VulkanInstance();

    [[nodiscard]] VkInstance handle() const { return instance_; }
    [[nodiscard]] bool has_debug_utils() const { return debug_utils_; }
    [[nodiscard]] ValidationLog& log() const { return *log_; }

private:
    VulkanInstance() = default;
    void destroy();

    VkInstance instance_ = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    bool debug_utils_ = false;
    std::unique_ptr<ValidationLog> log_ = std::make_unique<ValidationLog>(); ///< the messenger points at it
};

} // namespace tyndall::engine
