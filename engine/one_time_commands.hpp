// A command buffer that is recorded, run and waited for: work outside a frame.
#pragma once

#include <tl/expected.hpp>

#include "engine/device.hpp"

namespace tyndall::engine {

/// A pool and a command buffer of the graphics queue. Everything before and after in the queue is ordered with it by
/// full barriers, so that what is recorded needs none toward the outside.
class OneTimeCommands {
public:
    [[nodiscard]] static tl::expected<OneTimeCommands, Error> begin(const Device& device);
    OneTimeCommands(OneTimeCommands&& other) noexcept;
    OneTimeCommands& operator=(OneTimeCommands&&) = delete;
    OneTimeCommands(const OneTimeCommands&) = delete;
    OneTimeCommands& operator=(const OneTimeCommands&) = delete;
    ~OneTimeCommands();

    [[nodiscard]] VkCommandBuffer cmd() const { return cmd_; }
    /// Everything recorded so far happens before what follows, host reads included.
    void full_barrier() const;
    /// Ends, submits and waits. Not to be recorded into afterwards.
    [[nodiscard]] tl::expected<void, Error> finish();

private:
    explicit OneTimeCommands(const Device& device) : device_(&device) {}
    const Device* device_;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkCommandBuffer cmd_ = VK_NULL_HANDLE;
};

} // namespace tyndall::engine
