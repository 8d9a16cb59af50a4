#include "tests/engine/device_fixture.hpp"

#include <utility>

namespace tyndall::engine {

void DeviceTest::SetUp() {
    auto instance = VulkanInstance::create(Validation::core_and_synchronization);
    ASSERT_TRUE(instance.has_value()) << instance.error().message;
    instance_.emplace(std::move(*instance));
    auto device = Device::create(*instance_);
    ASSERT_TRUE(device.has_value()) << device.error().message;
    device_.emplace(std::move(*device));
}

void DeviceTest::TearDown() {
    device_.reset(); // what is still alive then is an error too
    if (instance_) {
        for (const std::string& error : take_errors()) {
            ADD_FAILURE() << "validation: " << error;
        }
    }
}

std::vector<std::string> DeviceTest::take_errors() {
    std::vector<std::string> errors = instance_->log().errors();
    instance_->log().clear();
    return errors;
}

Buffer DeviceTest::mapped_buffer(VkDeviceSize size_bytes, VkBufferUsageFlags usage) const {
    return Buffer::create(*device_, size_bytes, usage, MemoryUse::readback).value();
}

OneTimeCommands DeviceTest::commands() const {
    return OneTimeCommands::begin(*device_).value();
}

void DeviceTest::transition(VkCommandBuffer cmd, VkImage image, VkImageAspectFlags aspects, VkImageLayout to) const {
    constexpr VkAccessFlags2 all = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    const VkImageMemoryBarrier2 barrier{
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
        .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .dstAccessMask = all,
        .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
        .newLayout = to,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image,
        .subresourceRange = {aspects, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS}};
    const VkDependencyInfo dependency{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &barrier};
    vk().CmdPipelineBarrier2(cmd, &dependency);
}

} // namespace tyndall::engine
