#include "tests/rendergraph/recording_device.hpp"

#include <bit>
#include <string_view>

namespace tyndall::rg::test {
namespace {

RecordingDevice* the_device = nullptr;

template <typename Handle>
VkResult create(Handle* out) {
    RecordingDevice& device = RecordingDevice::current();
    if (device.creations++ == device.fail_at) {
        return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    }
    *out = std::bit_cast<Handle>(device.next_handle());
    ++device.alive;
    return VK_SUCCESS;
}

template <typename Info, typename Handle>
VKAPI_ATTR VkResult VKAPI_CALL create_object(VkDevice, const Info*, const VkAllocationCallbacks*, Handle* out) {
    return create(out);
}
template <typename Handle>
VKAPI_ATTR void VKAPI_CALL destroy_object(VkDevice, Handle handle, const VkAllocationCallbacks*) {
    RecordingDevice::current().alive -= handle != VK_NULL_HANDLE ? 1 : 0;
}

VKAPI_ATTR VkResult VKAPI_CALL allocate_command_buffers(VkDevice, const VkCommandBufferAllocateInfo*,
                                                        VkCommandBuffer* out) {
    const VkResult result = create(out);
    RecordingDevice::current().alive -= result == VK_SUCCESS ? 1 : 0; // goes with its pool
    return result;
}
VKAPI_ATTR VkResult VKAPI_CALL begin_command_buffer(VkCommandBuffer cmd, const VkCommandBufferBeginInfo*) {
    if (RecordingDevice::current().remembers) {
        RecordingDevice::current().command_buffers[cmd] = {};
    }
    return VK_SUCCESS;
}
VKAPI_ATTR VkResult VKAPI_CALL end_command_buffer(VkCommandBuffer) {
    return VK_SUCCESS;
}
VKAPI_ATTR VkResult VKAPI_CALL reset_command_pool(VkDevice, VkCommandPool, VkCommandPoolResetFlags) {
    return VK_SUCCESS;
}
VKAPI_ATTR void VKAPI_CALL pipeline_barrier(VkCommandBuffer cmd, const VkDependencyInfo* info) {
    if (!RecordingDevice::current().remembers) {
        return;
    }
    RecordedCommands& commands = RecordingDevice::current().command_buffers[cmd];
    commands.memory_barriers.emplace_back(info->pMemoryBarriers, info->pMemoryBarriers + info->memoryBarrierCount);
    commands.image_barriers.emplace_back(info->pImageMemoryBarriers,
                                         info->pImageMemoryBarriers + info->imageMemoryBarrierCount);
    commands.buffer_barriers.emplace_back(info->pBufferMemoryBarriers,
                                          info->pBufferMemoryBarriers + info->bufferMemoryBarrierCount);
}
VKAPI_ATTR void VKAPI_CALL begin_rendering(VkCommandBuffer cmd, const VkRenderingInfo* info) {
    if (RecordingDevice::current().remembers) {
        RecordingDevice::current().command_buffers[cmd].color_attachments.emplace_back(
            info->pColorAttachments, info->pColorAttachments + info->colorAttachmentCount);
    }
}
VKAPI_ATTR void VKAPI_CALL end_rendering(VkCommandBuffer) {}
VKAPI_ATTR void VKAPI_CALL set_viewport(VkCommandBuffer, std::uint32_t, std::uint32_t, const VkViewport*) {}
VKAPI_ATTR void VKAPI_CALL set_scissor(VkCommandBuffer, std::uint32_t, std::uint32_t, const VkRect2D*) {}

VKAPI_ATTR VkResult VKAPI_CALL queue_submit(VkQueue queue, std::uint32_t count, const VkSubmitInfo2* submits, VkFence) {
    RecordingDevice& device = RecordingDevice::current();
    if (device.submit_result != VK_SUCCESS) {
        return device.submit_result;
    }
    if (!device.remembers) {
        return VK_SUCCESS;
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        const VkSubmitInfo2& submit = submits[i];
        device.submits.push_back(
            {queue,
             {submit.pWaitSemaphoreInfos, submit.pWaitSemaphoreInfos + submit.waitSemaphoreInfoCount},
             {submit.pSignalSemaphoreInfos, submit.pSignalSemaphoreInfos + submit.signalSemaphoreInfoCount},
             device.command_buffers[submit.pCommandBufferInfos->commandBuffer]});
    }
    return VK_SUCCESS;
}
VKAPI_ATTR VkResult VKAPI_CALL queue_wait_idle(VkQueue) {
    return VK_SUCCESS;
}
VKAPI_ATTR VkResult VKAPI_CALL wait_semaphores(VkDevice, const VkSemaphoreWaitInfo*, std::uint64_t) {
    return VK_SUCCESS;
}

constexpr VkMemoryRequirements any_requirements = {256, 256, 1};
VKAPI_ATTR void VKAPI_CALL image_requirements(VkDevice, VkImage, VkMemoryRequirements* out) {
    *out = any_requirements;
}
VKAPI_ATTR void VKAPI_CALL buffer_requirements(VkDevice, VkBuffer, VkMemoryRequirements* out) {
    *out = any_requirements;
}
VKAPI_ATTR void VKAPI_CALL device_image_requirements(VkDevice, const VkDeviceImageMemoryRequirements*,
                                                     VkMemoryRequirements2* out) {
    out->memoryRequirements = any_requirements;
}
VKAPI_ATTR void VKAPI_CALL device_buffer_requirements(VkDevice, const VkDeviceBufferMemoryRequirements*,
                                                      VkMemoryRequirements2* out) {
    out->memoryRequirements = any_requirements;
}
VKAPI_ATTR VkResult VKAPI_CALL bind_image(VkDevice, VkImage, VkDeviceMemory, VkDeviceSize) {
    return VK_SUCCESS;
}
VKAPI_ATTR VkResult VKAPI_CALL bind_buffer(VkDevice, VkBuffer, VkDeviceMemory, VkDeviceSize) {
    return VK_SUCCESS;
}
/// Stands for all that the executor never calls.
VKAPI_ATTR void VKAPI_CALL never_called() {}

template <typename Function>
PFN_vkVoidFunction as_void(Function function) {
    return reinterpret_cast<PFN_vkVoidFunction>(function);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL proc_addr(VkDevice, const char* full_name) {
    static const std::map<std::string_view, PFN_vkVoidFunction> functions = {
        {"vkCreateSemaphore", as_void(&create_object<VkSemaphoreCreateInfo, VkSemaphore>)},
        {"vkCreateCommandPool", as_void(&create_object<VkCommandPoolCreateInfo, VkCommandPool>)},
        {"vkCreateImage", as_void(&create_object<VkImageCreateInfo, VkImage>)},
        {"vkCreateBuffer", as_void(&create_object<VkBufferCreateInfo, VkBuffer>)},
        {"vkCreateImageView", as_void(&create_object<VkImageViewCreateInfo, VkImageView>)},
        {"vkCreateQueryPool", as_void(&create_object<VkQueryPoolCreateInfo, VkQueryPool>)},
        {"vkAllocateMemory", as_void(&create_object<VkMemoryAllocateInfo, VkDeviceMemory>)},
        {"vkDestroySemaphore", as_void(&destroy_object<VkSemaphore>)},
        {"vkDestroyCommandPool", as_void(&destroy_object<VkCommandPool>)},
        {"vkDestroyImage", as_void(&destroy_object<VkImage>)},
        {"vkDestroyBuffer", as_void(&destroy_object<VkBuffer>)},
        {"vkDestroyImageView", as_void(&destroy_object<VkImageView>)},
        {"vkDestroyQueryPool", as_void(&destroy_object<VkQueryPool>)},
        {"vkFreeMemory", as_void(&destroy_object<VkDeviceMemory>)},
        {"vkAllocateCommandBuffers", as_void(&allocate_command_buffers)},
        {"vkBeginCommandBuffer", as_void(&begin_command_buffer)},
        {"vkEndCommandBuffer", as_void(&end_command_buffer)},
        {"vkResetCommandPool", as_void(&reset_command_pool)},
        {"vkCmdPipelineBarrier2", as_void(&pipeline_barrier)},
        {"vkCmdBeginRendering", as_void(&begin_rendering)},
        {"vkCmdEndRendering", as_void(&end_rendering)},
        {"vkCmdSetViewport", as_void(&set_viewport)},
        {"vkCmdSetScissor", as_void(&set_scissor)},
        {"vkQueueSubmit2", as_void(&queue_submit)},
        {"vkQueueWaitIdle", as_void(&queue_wait_idle)},
        {"vkWaitSemaphores", as_void(&wait_semaphores)},
        {"vkGetImageMemoryRequirements", as_void(&image_requirements)},
        {"vkGetBufferMemoryRequirements", as_void(&buffer_requirements)},
        {"vkGetDeviceImageMemoryRequirements", as_void(&device_image_requirements)},
        {"vkGetDeviceBufferMemoryRequirements", as_void(&device_buffer_requirements)},
        {"vkBindImageMemory", as_void(&bind_image)},
        {"vkBindBufferMemory", as_void(&bind_buffer)},
    };
    const auto found = functions.find(full_name);
    return found != functions.end() ? found->second : &never_called;
}

} // namespace

std::vector<VkImageMemoryBarrier2> RecordedCommands::all_image_barriers() const {
    std::vector<VkImageMemoryBarrier2> all;
    for (const auto& barriers : image_barriers) {
        all.insert(all.end(), barriers.begin(), barriers.end());
    }
    return all;
}

std::vector<VkBufferMemoryBarrier2> RecordedCommands::all_buffer_barriers() const {
    std::vector<VkBufferMemoryBarrier2> all;
    for (const auto& barriers : buffer_barriers) {
        all.insert(all.end(), barriers.begin(), barriers.end());
    }
    return all;
}

RecordingDevice::RecordingDevice() {
    the_device = this;
}
RecordingDevice::~RecordingDevice() {
    the_device = nullptr;
}
RecordingDevice& RecordingDevice::current() {
    return *the_device;
}

VkQueue RecordingDevice::queue(std::uint32_t index) {
    return std::bit_cast<VkQueue>(std::uint64_t{0x1000} + index);
}

ExecutorInfo RecordingDevice::info(std::vector<QueueKind> kinds) const {
    ExecutorInfo out{.get_device_proc_addr = &proc_addr, .device = std::bit_cast<VkDevice>(std::uint64_t{0x2000})};
    out.memory_properties.memoryTypeCount = 1;
    out.memory_properties.memoryTypes[0].propertyFlags = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    out.memory_properties.memoryHeapCount = 1;
    for (std::uint32_t i = 0; i < kinds.size(); ++i) {
        out.queues.push_back({kinds[i], queue(i), i, 0});
    }
    return out;
}

std::vector<ImportBinding> made_up_bindings(const GraphDesc& graph) {
    std::vector<ImportBinding> out;
    for (std::uint32_t resource = 0; resource < graph.resources.size(); ++resource) {
        if (graph.resources[resource].lifetime == ResourceLifetime::imported) {
            const std::uint64_t handle = 0x3000 + resource;
            out.push_back({.resource = resource,
                           .image = std::bit_cast<VkImage>(handle),
                           .buffer = std::bit_cast<VkBuffer>(handle),
                           .wait_semaphore = std::bit_cast<VkSemaphore>(handle),
                           .signal_semaphore = std::bit_cast<VkSemaphore>(handle)});
        }
    }
    return out;
}

} // namespace tyndall::rg::test
