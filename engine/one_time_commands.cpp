#include "engine/one_time_commands.hpp"

#include <utility>

namespace tyndall::engine {

tl::expected<OneTimeCommands, Error> OneTimeCommands::begin(const Device& device) {
    OneTimeCommands made(device);
    const rg::DeviceTable& vk = device.vk();
    const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                       .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
                                       .queueFamilyIndex = device.graphics_queue().family};
    if (vk.CreateCommandPool(device.handle(), &pool, nullptr, &made.pool_) != VK_SUCCESS) {
        return tl::unexpected(Error{"Device '" + device.info().name + "' could not make a command pool"});
    }
    const VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                               .commandPool = made.pool_,
                                               .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                               .commandBufferCount = 1};
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    if (vk.AllocateCommandBuffers(device.handle(), &allocate, &made.cmd_) != VK_SUCCESS ||
        vk.BeginCommandBuffer(made.cmd_, &begin) != VK_SUCCESS) {
        return tl::unexpected(Error{"Device '" + device.info().name + "' could not make a command buffer"});
    }
    made.full_barrier();
    return made;
}

OneTimeCommands::OneTimeCommands(OneTimeCommands&& other) noexcept
    : device_(other.device_), pool_(std::exchange(other.pool_, VK_NULL_HANDLE)),
      cmd_(std::exchange(other.cmd_, VK_NULL_HANDLE)) {}

OneTimeCommands::~OneTimeCommands() {
    device_->vk().DestroyCommandPool(device_->handle(), pool_, nullptr);
}

void OneTimeCommands::full_barrier() const {
    constexpr VkAccessFlags2 all = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    const VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                   .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                   .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
                                   .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_2_HOST_BIT,
                                   .dstAccessMask = all | VK_ACCESS_2_HOST_READ_BIT};
    const VkDependencyInfo dependency{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
    device_->vk().CmdPipelineBarrier2(cmd_, &dependency);
}

tl::expected<void, Error> OneTimeCommands::finish() {
    const rg::DeviceTable& vk = device_->vk();
    full_barrier();
    const VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                             .commandBuffer = cmd_};
    const VkSubmitInfo2 submit{
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &commands};
    const VkQueue queue = device_->graphics_queue().queue;
    if (vk.EndCommandBuffer(cmd_) != VK_SUCCESS || vk.QueueSubmit2(queue, 1, &submit, VK_NULL_HANDLE) != VK_SUCCESS ||
        vk.QueueWaitIdle(queue) != VK_SUCCESS) {
        return tl::unexpected(Error{"Device '" + device_->info().name + "' was lost during a transfer"});
    }
    return {};
}

} // namespace tyndall::engine
