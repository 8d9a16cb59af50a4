// Recording: barriers, dynamic rendering, labels and timestamps around the callbacks of the passes.
#include <algorithm>
#include <string_view>

#include "rendergraph/executor_state.hpp"
#include "rendergraph/vulkan_names.hpp"

namespace tyndall::rg {
namespace {

constexpr VkExtent2D at_mip(const VkExtent3D& extent, std::uint32_t mip) {
    return {std::max(extent.width >> mip, 1U), std::max(extent.height >> mip, 1U)};
}

bool has_integer_texels(VkFormat format) {
    const std::string_view name = name_in(format_names(), static_cast<std::uint64_t>(format)).value_or("");
    return name.find("UINT") != std::string_view::npos || name.find("SINT") != std::string_view::npos;
}

} // namespace

ExecutorState::Result ExecutorState::begin_segment(Segment& segment) {
    FrameSlot& slot = slots[work.slot];
    CommandPool& pool = slot.pools[segment.queue];
    if (pool.used == pool.buffers.size()) {
        const VkCommandBufferAllocateInfo request{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                  .commandPool = pool.pool,
                                                  .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                  .commandBufferCount = 1};
        VkCommandBuffer made = VK_NULL_HANDLE;
        if (const VkResult result = vk.AllocateCommandBuffers(info.device, &request, &made); result < 0) {
            return tl::unexpected(vulkan_error(result, "A command buffer could not be allocated"));
        }
        pool.buffers.push_back(made);
    }
    segment.cmd = pool.buffers[pool.used++];
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    if (const VkResult result = vk.BeginCommandBuffer(segment.cmd, &begin); result < 0) {
        return tl::unexpected(vulkan_error(result, "A command buffer could not be begun"));
    }
    if (!work.queue_begun[segment.queue]) {
        work.queue_begun[segment.queue] = true;
        whole_barrier(segment.cmd); // the frame before may still use the same memory
    }
    return {};
}

ExecutorState::Result ExecutorState::record_segments() {
    for (Segment& segment : work.segments) {
        if (Result begun = begin_segment(segment); !begun) {
            return begun;
        }
        if (segment.batch_count == 0) {
            add_history_preparations(segment.queue);
            flush_barriers(segment.cmd);
        }
        std::uint32_t passes = 0;
        for (std::uint32_t batch = 0; batch < segment.batch_count; ++batch) {
            passes += work.plan->batches[segment.first_batch + batch].pass_count;
        }
        reset_queries(segment.cmd, segment.queue, passes);
        for (std::uint32_t batch = 0; batch < segment.batch_count; ++batch) {
            record_batch(segment.cmd, segment.first_batch + batch);
        }
        if (const VkResult result = vk.EndCommandBuffer(segment.cmd); result < 0) {
            return tl::unexpected(vulkan_error(result, "A command buffer could not be ended"));
        }
    }
    return {};
}

void ExecutorState::record_into(VkCommandBuffer cmd) {
    whole_barrier(cmd);
    add_history_preparations(0);
    flush_barriers(cmd);
    reset_queries(cmd, 0, static_cast<std::uint32_t>(work.plan->passes.size()));
    for (std::uint32_t batch = 0; batch < work.plan->batches.size(); ++batch) {
        record_batch(cmd, batch);
    }
}

void ExecutorState::record_batch(VkCommandBuffer cmd, std::uint32_t index) {
    const Plan& plan = *work.plan;
    const Batch& batch = plan.batches[index];
    for (std::uint32_t i = 0; i < batch.pass_count; ++i) {
        record_pass(cmd, plan.passes[batch.first_pass + i]);
    }
    for (const std::uint32_t release : batch.releases) {
        add_at_batch_end(plan.dependencies[release]);
    }
    // The host's final state is set in the batch of the last use, whose semaphore the host may wait for.
    for (std::uint32_t i = 0; i < plan.exit_barrier_count; ++i) {
        const Dependency& exit = plan.dependencies[plan.first_exit_barrier + i];
        if (exit.producer != none && work.batch_of_pass[exit.producer] == index) {
            add_exit(exit);
        }
    }
    flush_barriers(cmd);
}

void ExecutorState::record_pass(VkCommandBuffer cmd, const PlannedPass& planned) {
    const PassDesc& pass = work.graph->passes[planned.pass];
    const std::uint32_t real_queue = work.real_of[planned.queue];
    const bool labelled = info.debug_labels && vk.CmdBeginDebugUtilsLabelEXT != nullptr;
    if (labelled) {
        const VkDebugUtilsLabelEXT label{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT,
                                         .pLabelName = pass.name.c_str()};
        vk.CmdBeginDebugUtilsLabelEXT(cmd, &label);
    }
    FrameSlot& slot = slots[work.slot];
    const bool timestamps = timed(real_queue);
    const std::uint32_t query = 2 * slot.timed_count;
    if (timestamps) {
        if (slot.timed.size() == slot.timed_count) {
            slot.timed.emplace_back();
        }
        TimedPass& entry = slot.timed[slot.timed_count++];
        entry.pass = planned.pass;
        entry.valid_bits = queues[real_queue].info.timestamp_valid_bits;
        entry.name.assign(pass.name);
        write_timestamp(cmd, query);
    }
    for (std::uint32_t i = 0; i < planned.barrier_count; ++i) {
        add_before_consumer(work.plan->dependencies[planned.first_barrier + i]);
    }
    flush_barriers(cmd);
    if (info.poison_transients) {
        poison(cmd, planned);
    }

    PassContext ctx;
    ctx.state_ = this;
    ctx.cmd_ = cmd;
    ctx.frame_slot_ = work.slot;
    ctx.pass_ = planned.pass;
    const bool renders = planned.attachment_count > 0;
    if (renders) {
        ctx.render_extent_ = begin_rendering(cmd, planned);
    }
    if (work.callbacks->has(planned.pass)) {
        work.callbacks->invoke(planned.pass, ctx);
    }
    if (renders) {
        vk.CmdEndRendering(cmd);
    }
    if (timestamps) {
        write_timestamp(cmd, query + 1);
    }
    if (labelled) {
        vk.CmdEndDebugUtilsLabelEXT(cmd);
    }
}

VkExtent2D ExecutorState::begin_rendering(VkCommandBuffer cmd, const PlannedPass& planned) {
    const GraphDesc& graph = *work.graph;
    work.color_attachments.clear();
    VkRenderingAttachmentInfo depth{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    bool has_depth = false;
    bool has_stencil = false;
    VkExtent2D extent = {};
    std::uint32_t layers = 1;
    std::size_t next_resolved = 0;
    work.multisampled.clear();
    for (std::uint32_t i = 0; i < planned.attachment_count; ++i) {
        const AttachmentOps& ops = work.plan->attachments[planned.first_attachment + i];
        const AccessDesc& access = graph.accesses[ops.access];
        const ImageDesc& image = graph.resources[access.resource].image;
        ImageRange range = resolved(access.image_range, image);
        range.mip_count = 1;
        extent = at_mip(image.extent, range.base_mip);
        layers = range.layer_count;
        const VkImageView view =
            view_of(access.resource, range, layers > 1 ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D);
        const VkImageLayout layout = access_scope(access.access, access.direction, image.format).layout;
        const VkRenderingAttachmentInfo attachment{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                                   .imageView = view,
                                                   .imageLayout = layout,
                                                   .loadOp = ops.load,
                                                   .storeOp = ops.store,
                                                   .clearValue = access.clear};
        if (access.access == Access::color_attachment) {
            if (image.samples != VK_SAMPLE_COUNT_1_BIT) {
                work.multisampled.push_back(work.color_attachments.size());
            }
            work.color_attachments.push_back(attachment);
        } else if (access.access == Access::depth_attachment) {
            depth = attachment;
            has_depth = (format_aspects(image.format) & VK_IMAGE_ASPECT_DEPTH_BIT) != 0;
            has_stencil = (format_aspects(image.format) & VK_IMAGE_ASPECT_STENCIL_BIT) != 0;
        }
    }
    // The n-th resolve attachment takes the n-th multisampled colour attachment.
    for (std::uint32_t i = 0; i < planned.attachment_count; ++i) {
        const AccessDesc& access = graph.accesses[work.plan->attachments[planned.first_attachment + i].access];
        if (access.access != Access::resolve_attachment || next_resolved == work.multisampled.size()) {
            continue;
        }
        const ImageDesc& image = graph.resources[access.resource].image;
        ImageRange range = resolved(access.image_range, image);
        range.mip_count = 1;
        VkRenderingAttachmentInfo& source = work.color_attachments[work.multisampled[next_resolved++]];
        source.resolveMode =
            has_integer_texels(image.format) ? VK_RESOLVE_MODE_SAMPLE_ZERO_BIT : VK_RESOLVE_MODE_AVERAGE_BIT;
        source.resolveImageView =
            view_of(access.resource, range, layers > 1 ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D);
        source.resolveImageLayout = access_scope(access.access, access.direction, image.format).layout;
    }
    const VkRenderingInfo rendering{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                    .renderArea = {{0, 0}, extent},
                                    .layerCount = layers,
                                    .colorAttachmentCount = static_cast<std::uint32_t>(work.color_attachments.size()),
                                    .pColorAttachments = work.color_attachments.data(),
                                    .pDepthAttachment = has_depth ? &depth : nullptr,
                                    .pStencilAttachment = has_stencil ? &depth : nullptr};
    vk.CmdBeginRendering(cmd, &rendering);
    const VkViewport viewport{0.0F, 0.0F, static_cast<float>(extent.width), static_cast<float>(extent.height),
                              0.0F, 1.0F};
    const VkRect2D scissor{{0, 0}, extent};
    vk.CmdSetViewport(cmd, 0, 1, &viewport);
    vk.CmdSetScissor(cmd, 0, 1, &scissor);
    return extent;
}

} // namespace tyndall::rg
