// A device of the engine's own, with core and synchronisation validation. Any validation error fails the test.
#pragma once

#include <memory>
#include <optional>

#include <gtest/gtest.h>

#include "engine/device.hpp"
#include "engine/instance.hpp"
#include "engine/memory.hpp"
#include "engine/one_time_commands.hpp"

namespace tyndall::engine {

class DeviceTest : public testing::Test {
protected:
    void SetUp() override;
    void TearDown() override; ///< fails on validation errors that take_errors has not taken

    [[nodiscard]] const VulkanInstance& instance() const { return *instance_; }
    [[nodiscard]] const Device& device() const { return *device_; }
    [[nodiscard]] const rg::DeviceTable& vk() const { return device_->vk(); }
    /// The validation errors so far, which then no longer fail the test.
    [[nodiscard]] std::vector<std::string> take_errors();

    /// A mapped buffer; a failure to make it ends the test with an exception.
    [[nodiscard]] Buffer mapped_buffer(VkDeviceSize size_bytes, VkBufferUsageFlags usage) const;
    [[nodiscard]] OneTimeCommands commands() const;
    void transition(VkCommandBuffer cmd, VkImage image, VkImageAspectFlags aspects, VkImageLayout to) const;

private:
    std::optional<VulkanInstance> instance_;
    std::optional<Device> device_;
};

} // namespace tyndall::engine
