// A device that does nothing and remembers everything: what the executor would do on hardware with several queue
// families, and what it does when a call fails.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "rendergraph/executor.hpp"

namespace tyndall::rg::test {

struct RecordedCommands {
    std::vector<std::vector<VkMemoryBarrier2>> memory_barriers; ///< by vkCmdPipelineBarrier2
    std::vector<std::vector<VkImageMemoryBarrier2>> image_barriers;
    std::vector<std::vector<VkBufferMemoryBarrier2>> buffer_barriers;
    std::vector<std::vector<VkRenderingAttachmentInfo>> color_attachments; ///< by vkCmdBeginRendering

    [[nodiscard]] std::vector<VkImageMemoryBarrier2> all_image_barriers() const;
    [[nodiscard]] std::vector<VkBufferMemoryBarrier2> all_buffer_barriers() const;
};

struct RecordedSubmit {
    VkQueue queue = VK_NULL_HANDLE;
    std::vector<VkSemaphoreSubmitInfo> waits;
    std::vector<VkSemaphoreSubmitInfo> signals;
    RecordedCommands commands;
};

/// One at a time: the functions find it through a static pointer, since a Vulkan device is the only thing they are
/// given.
class RecordingDevice {
public:
    RecordingDevice();
    ~RecordingDevice();
    RecordingDevice(const RecordingDevice&) = delete;
    RecordingDevice& operator=(const RecordingDevice&) = delete;

    /// Queues of these kinds, each in a family of its own, in this order.
    [[nodiscard]] ExecutorInfo info(std::vector<QueueKind> kinds) const;
    [[nodiscard]] static VkQueue queue(std::uint32_t index);

    std::vector<RecordedSubmit> submits;
    std::map<VkCommandBuffer, RecordedCommands> command_buffers;
    std::int64_t alive = 0;     ///< objects created and not destroyed
    std::int64_t creations = 0; ///< calls that make something
    std::int64_t fail_at = -1;  ///< the creation that runs out of memory
    VkResult submit_result = VK_SUCCESS;
    bool remembers = true; ///< false: it allocates nothing, and a frame's own allocations can be counted

    // For the functions.
    [[nodiscard]] static RecordingDevice& current();
    [[nodiscard]] std::uint64_t next_handle() { return ++handles_; }

private:
    std::uint64_t handles_ = 0;
};

/// Bindings with made-up handles, and semaphores, for every import.
[[nodiscard]] std::vector<ImportBinding> made_up_bindings(const GraphDesc& graph);

} // namespace tyndall::rg::test
