// The device-level Vulkan functions that an executor, an engine and features call, loaded into a private table: nothing
// here links a loader or calls a global Vulkan symbol.
#pragma once

#include <vulkan/vulkan_core.h>

// Every function of core Vulkan 1.3 that is needed, and push descriptors: loading fails if one is missing.
// X(Name) stands for vkName.
#define TYNDALL_RG_REQUIRED_DEVICE_FUNCTIONS(X)                                                                        \
    X(AllocateCommandBuffers)                                                                                          \
    X(AllocateDescriptorSets)                                                                                          \
    X(AllocateMemory)                                                                                                  \
    X(BeginCommandBuffer)                                                                                              \
    X(BindBufferMemory)                                                                                                \
    X(BindBufferMemory2)                                                                                               \
    X(BindImageMemory)                                                                                                 \
    X(BindImageMemory2)                                                                                                \
    X(CmdBeginQuery)                                                                                                   \
    X(CmdBeginRendering)                                                                                               \
    X(CmdBindDescriptorSets)                                                                                           \
    X(CmdBindIndexBuffer)                                                                                              \
    X(CmdBindPipeline)                                                                                                 \
    X(CmdBindVertexBuffers)                                                                                            \
    X(CmdBindVertexBuffers2)                                                                                           \
    X(CmdBlitImage2)                                                                                                   \
    X(CmdClearAttachments)                                                                                             \
    X(CmdClearColorImage)                                                                                              \
    X(CmdClearDepthStencilImage)                                                                                       \
    X(CmdCopyBuffer)                                                                                                   \
    X(CmdCopyBuffer2)                                                                                                  \
    X(CmdCopyBufferToImage2)                                                                                           \
    X(CmdCopyImage2)                                                                                                   \
    X(CmdCopyImageToBuffer2)                                                                                           \
    X(CmdCopyQueryPoolResults)                                                                                         \
    X(CmdDispatch)                                                                                                     \
    X(CmdDispatchIndirect)                                                                                             \
    X(CmdDraw)                                                                                                         \
    X(CmdDrawIndexed)                                                                                                  \
    X(CmdDrawIndexedIndirect)                                                                                          \
    X(CmdDrawIndexedIndirectCount)                                                                                     \
    X(CmdDrawIndirect)                                                                                                 \
    X(CmdDrawIndirectCount)                                                                                            \
    X(CmdEndQuery)                                                                                                     \
    X(CmdEndRendering)                                                                                                 \
    X(CmdExecuteCommands)                                                                                              \
    X(CmdFillBuffer)                                                                                                   \
    X(CmdPipelineBarrier2)                                                                                             \
    X(CmdPushConstants)                                                                                                \
    X(CmdPushDescriptorSetKHR)                                                                                         \
    X(CmdResetQueryPool)                                                                                               \
    X(CmdResolveImage2)                                                                                                \
    X(CmdSetBlendConstants)                                                                                            \
    X(CmdSetCullMode)                                                                                                  \
    X(CmdSetDepthBias)                                                                                                 \
    X(CmdSetDepthBiasEnable)                                                                                           \
    X(CmdSetDepthCompareOp)                                                                                            \
    X(CmdSetDepthTestEnable)                                                                                           \
    X(CmdSetDepthWriteEnable)                                                                                          \
    X(CmdSetFrontFace)                                                                                                 \
    X(CmdSetLineWidth)                                                                                                 \
    X(CmdSetPrimitiveTopology)                                                                                         \
    X(CmdSetScissor)                                                                                                   \
    X(CmdSetScissorWithCount)                                                                                          \
    X(CmdSetStencilCompareMask)                                                                                        \
    X(CmdSetStencilReference)                                                                                          \
    X(CmdSetStencilWriteMask)                                                                                          \
    X(CmdSetViewport)                                                                                                  \
    X(CmdSetViewportWithCount)                                                                                         \
    X(CmdUpdateBuffer)                                                                                                 \
    X(CmdWriteTimestamp2)                                                                                              \
    X(CreateBuffer)                                                                                                    \
    X(CreateBufferView)                                                                                                \
    X(CreateCommandPool)                                                                                               \
    X(CreateComputePipelines)                                                                                          \
    X(CreateDescriptorPool)                                                                                            \
    X(CreateDescriptorSetLayout)                                                                                       \
    X(CreateFence)                                                                                                     \
    X(CreateGraphicsPipelines)                                                                                         \
    X(CreateImage)                                                                                                     \
    X(CreateImageView)                                                                                                 \
    X(CreatePipelineCache)                                                                                             \
    X(CreatePipelineLayout)                                                                                            \
    X(CreateQueryPool)                                                                                                 \
    X(CreateSampler)                                                                                                   \
    X(CreateSemaphore)                                                                                                 \
    X(CreateShaderModule)                                                                                              \
    X(DestroyBuffer)                                                                                                   \
    X(DestroyBufferView)                                                                                               \
    X(DestroyCommandPool)                                                                                              \
    X(DestroyDescriptorPool)                                                                                           \
    X(DestroyDescriptorSetLayout)                                                                                      \
    X(DestroyDevice)                                                                                                   \
    X(DestroyFence)                                                                                                    \
    X(DestroyImage)                                                                                                    \
    X(DestroyImageView)                                                                                                \
    X(DestroyPipeline)                                                                                                 \
    X(DestroyPipelineCache)                                                                                            \
    X(DestroyPipelineLayout)                                                                                           \
    X(DestroyQueryPool)                                                                                                \
    X(DestroySampler)                                                                                                  \
    X(DestroySemaphore)                                                                                                \
    X(DestroyShaderModule)                                                                                             \
    X(DeviceWaitIdle)                                                                                                  \
    X(EndCommandBuffer)                                                                                                \
    X(FlushMappedMemoryRanges)                                                                                         \
    X(FreeCommandBuffers)                                                                                              \
    X(FreeDescriptorSets)                                                                                              \
    X(FreeMemory)                                                                                                      \
    X(GetBufferDeviceAddress)                                                                                          \
    X(GetBufferMemoryRequirements)                                                                                     \
    X(GetBufferMemoryRequirements2)                                                                                    \
    X(GetDeviceBufferMemoryRequirements)                                                                               \
    X(GetDeviceImageMemoryRequirements)                                                                                \
    X(GetDeviceQueue)                                                                                                  \
    X(GetFenceStatus)                                                                                                  \
    X(GetImageMemoryRequirements)                                                                                      \
    X(GetImageMemoryRequirements2)                                                                                     \
    X(GetPipelineCacheData)                                                                                            \
    X(GetQueryPoolResults)                                                                                             \
    X(GetSemaphoreCounterValue)                                                                                        \
    X(InvalidateMappedMemoryRanges)                                                                                    \
    X(MapMemory)                                                                                                       \
    X(MergePipelineCaches)                                                                                             \
    X(QueueSubmit2)                                                                                                    \
    X(QueueWaitIdle)                                                                                                   \
    X(ResetCommandBuffer)                                                                                              \
    X(ResetCommandPool)                                                                                                \
    X(ResetDescriptorPool)                                                                                             \
    X(ResetFences)                                                                                                     \
    X(ResetQueryPool)                                                                                                  \
    X(SignalSemaphore)                                                                                                 \
    X(UnmapMemory)                                                                                                     \
    X(UpdateDescriptorSets)                                                                                            \
    X(WaitForFences)                                                                                                   \
    X(WaitSemaphores)

// VK_EXT_debug_utils: null when the instance was made without it.
#define TYNDALL_RG_OPTIONAL_DEVICE_FUNCTIONS(X)                                                                        \
    X(CmdBeginDebugUtilsLabelEXT)                                                                                      \
    X(CmdEndDebugUtilsLabelEXT)                                                                                        \
    X(CmdInsertDebugUtilsLabelEXT)                                                                                     \
    X(SetDebugUtilsObjectNameEXT)

namespace tyndall::rg {

/// Function pointers of one device, named without their `vk`: `vk.CmdDispatch(cmd, x, y, z)`.
struct DeviceTable {
#define TYNDALL_RG_MEMBER(name) PFN_vk##name name = nullptr;
    TYNDALL_RG_REQUIRED_DEVICE_FUNCTIONS(TYNDALL_RG_MEMBER)
    TYNDALL_RG_OPTIONAL_DEVICE_FUNCTIONS(TYNDALL_RG_MEMBER)
#undef TYNDALL_RG_MEMBER
};

/// Fills `table` for `device`. False if a required function is missing: `missing` then names the first one, as in the
/// specification, and is nullptr otherwise. The debug-utils functions may stay null.
[[nodiscard]] bool load_device_table(PFN_vkGetDeviceProcAddr get_device_proc_addr, VkDevice device, DeviceTable& table,
                                     const char*& missing);

/// `table` with commands that record nothing, its other functions as they are.
[[nodiscard]] DeviceTable without_commands(DeviceTable table);

} // namespace tyndall::rg
