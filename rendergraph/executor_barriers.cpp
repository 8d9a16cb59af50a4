// The plan's dependencies as barriers of the device's queues.
// Logical queues that fold onto one real queue need no semaphore: the dependency is one ordinary barrier before its
// consumer, with the whole dependency's masks, and the release half of an ownership transfer vanishes. Between
// different real queues the semaphore orders and carries memory; left over are transitions, ownership and the
// consumer's own queue.
#include <algorithm>

#include "rendergraph/executor_state.hpp"

namespace tyndall::rg {
namespace {

constexpr VkPipelineStageFlags2 everything = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
constexpr VkAccessFlags2 any_access = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;

constexpr VkPipelineStageFlags2 transfer_stages =
    VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT | VK_PIPELINE_STAGE_2_COPY_BIT | VK_PIPELINE_STAGE_2_HOST_BIT | everything |
    VK_PIPELINE_STAGE_2_TOP_OF_PIPE_BIT | VK_PIPELINE_STAGE_2_BOTTOM_OF_PIPE_BIT;
constexpr VkPipelineStageFlags2 compute_stages =
    transfer_stages | VK_PIPELINE_STAGE_2_CLEAR_BIT | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT |
    VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR |
    VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR;

/// Source masks: what a queue cannot name (stages that ran elsewhere) is covered by naming everything.
struct Source {
    VkPipelineStageFlags2 stages = 0;
    VkAccessFlags2 access = 0;
};
Source nameable(Source source, QueueKind kind) {
    const VkPipelineStageFlags2 foreign = kind == QueueKind::graphics  ? 0
                                          : kind == QueueKind::compute ? source.stages & ~compute_stages
                                                                       : source.stages & ~transfer_stages;
    const VkPipelineStageFlags2 host = source.stages & VK_PIPELINE_STAGE_2_HOST_BIT; // not among all commands
    return foreign == 0 ? source : Source{everything | host, VK_ACCESS_2_MEMORY_WRITE_BIT};
}

struct Families {
    std::uint32_t src = VK_QUEUE_FAMILY_IGNORED;
    std::uint32_t dst = VK_QUEUE_FAMILY_IGNORED;
    [[nodiscard]] bool differ() const { return src != dst; }
};
/// Only a transfer between two families is one.
Families transfer(std::uint32_t src, std::uint32_t dst) {
    const bool real = src != dst && src != VK_QUEUE_FAMILY_IGNORED && dst != VK_QUEUE_FAMILY_IGNORED;
    return real ? Families{src, dst} : Families{};
}

struct Destination {
    VkPipelineStageFlags2 stages = 0;
    VkAccessFlags2 access = 0;
};

void add_barrier(FrameWork& work, const Dependency& d, Source source, Destination destination, Families families) {
    if (d.orders_for != none) {
        work.memory_barriers.push_back({.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                        .srcStageMask = source.stages,
                                        .dstStageMask = destination.stages});
    }
    const ResourceDesc& desc = work.graph->resources[d.resource];
    const PhysicalObject* object = work.objects[d.resource];
    if (object == nullptr) {
        return;
    }
    if (d.hazard == Hazard::aliased_memory && source.access != 0) {
        // A barrier of one resource makes available only what was written through that resource; other bytes lived
        // here.
        work.memory_barriers.push_back({.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                        .srcStageMask = source.stages,
                                        .srcAccessMask = source.access,
                                        .dstStageMask = destination.stages,
                                        .dstAccessMask = destination.access});
    }
    if (desc.kind == ResourceKind::buffer) {
        work.buffer_barriers.push_back({.sType = VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER_2,
                                        .srcStageMask = source.stages,
                                        .srcAccessMask = source.access,
                                        .dstStageMask = destination.stages,
                                        .dstAccessMask = destination.access,
                                        .srcQueueFamilyIndex = families.src,
                                        .dstQueueFamilyIndex = families.dst,
                                        .buffer = object->buffer,
                                        .offset = d.buffer_range.offset,
                                        .size = d.buffer_range.size});
        return;
    }
    // Depth and stencil change layout together.
    const ImageRange& range = d.image_range;
    work.image_barriers.push_back({.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
                                   .srcStageMask = source.stages,
                                   .srcAccessMask = source.access,
                                   .dstStageMask = destination.stages,
                                   .dstAccessMask = destination.access,
                                   .oldLayout = d.old_layout,
                                   .newLayout = d.new_layout,
                                   .srcQueueFamilyIndex = families.src,
                                   .dstQueueFamilyIndex = families.dst,
                                   .image = object->image,
                                   .subresourceRange = {format_aspects(desc.image.format), range.base_mip,
                                                        range.mip_count, range.base_layer, range.layer_count}});
}

} // namespace

void ExecutorState::add_before_consumer(const Dependency& d) {
    const std::uint32_t src = work.real_of[d.src_queue];
    const std::uint32_t dst = work.real_of[d.dst_queue];
    const DeviceQueue& queue = queues[dst].info;
    const bool several_folded = work.logical_count[dst] > 1;
    const bool from_host = d.producer == none;
    Families families;
    if (d.transfers_ownership && work.objects[d.resource] != nullptr && !work.objects[d.resource]->concurrent) {
        families = transfer(from_host ? d.src_family : queues[src].info.family, queue.family);
    }
    Source source{d.src_stages, d.src_access};
    Destination destination{d.dst_stages, d.dst_access};
    if (from_host && families.differ()) {
        source.access = 0; // the acquire half; the host recorded the release
    }
    if (from_host && several_folded) {
        // Other logical queues may rely on a semaphore wait of this consumer's batch, which folding dropped.
        destination = {everything | d.dst_stages, any_access | d.dst_access};
    }
    if (src != dst) {
        if (!several_folded) {
            source = {d.local_stages, d.local_access};
        }
        if (families.differ()) {
            source.access = 0;
        }
        const bool transition = d.old_layout != d.new_layout;
        if (transition || families.differ()) {
            source.stages |= everything; // chained to the semaphore wait of this batch or of one before it
        } else if (source.stages == 0) {
            return; // the semaphore covers it
        }
    }
    add_barrier(work, d, nameable(source, queue.kind), destination, families);
}

void ExecutorState::add_at_batch_end(const Dependency& d) {
    const bool release_half = d.transfers_ownership && d.src_queue != d.dst_queue;
    const DeviceQueue& queue = queues[work.real_of[d.src_queue]].info;
    const Source source = nameable({d.src_stages, d.src_access}, queue.kind);
    if (!release_half) {
        add_barrier(work, d, source, {d.dst_stages, d.dst_access}, {});
        return;
    }
    const PhysicalObject* object = work.objects[d.resource];
    const Families families = transfer(queue.family, queues[work.real_of[d.dst_queue]].info.family);
    if (families.differ() && object != nullptr && !object->concurrent) {
        add_barrier(work, d, source, {}, families);
    }
}

void ExecutorState::add_exit(const Dependency& d) {
    const DeviceQueue& queue = queues[work.real_of[d.src_queue]].info;
    Families families;
    if (d.transfers_ownership) {
        families = transfer(queue.family, d.dst_family);
    }
    Destination destination{d.dst_stages, d.dst_access};
    if (families.differ()) {
        destination = {};
    } else if (d.hazard == Hazard::history_rest) {
        destination.stages = everything; // so that the barrier that opens the next frame is ordered after it
    }
    add_barrier(work, d, nameable({d.src_stages, d.src_access}, queue.kind), destination, families);
}

std::uint32_t ExecutorState::preparing_queue(const HistoryPair& pair) const {
    if (pair.resource == none || pair.key.kind != ResourceKind::image) {
        return none;
    }
    const Placement& placement = work.plan->placements[pair.resource];
    if (pair.layout[1 - pair.current] == placement.resting_layout ||
        placement.resting_layout == VK_IMAGE_LAYOUT_UNDEFINED) {
        return none;
    }
    // An exclusive image is prepared by a queue of the family that uses it.
    for (std::uint32_t q = 0; q < work.plan->topology.queues.size(); ++q) {
        const std::uint32_t family = work.plan->topology.queues[q].family;
        if (!placement.families.empty() && family == placement.families.front()) {
            return work.real_of[q];
        }
    }
    return 0;
}

void ExecutorState::add_history_preparations(std::uint32_t real_queue) {
    for (const auto& pair : histories) {
        if (preparing_queue(*pair) != real_queue) {
            continue;
        }
        const Dependency d{.resource = pair->history_resource,
                           .old_layout = pair->layout[1 - pair->current],
                           .new_layout = work.plan->placements[pair->resource].resting_layout};
        add_barrier(work, d, {everything, 0}, {everything, any_access}, {});
    }
}

void ExecutorState::flush_barriers(VkCommandBuffer cmd) {
    if (work.image_barriers.empty() && work.buffer_barriers.empty() && work.memory_barriers.empty()) {
        return;
    }
    const VkDependencyInfo dependency{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                      .memoryBarrierCount = static_cast<std::uint32_t>(work.memory_barriers.size()),
                                      .pMemoryBarriers = work.memory_barriers.data(),
                                      .bufferMemoryBarrierCount =
                                          static_cast<std::uint32_t>(work.buffer_barriers.size()),
                                      .pBufferMemoryBarriers = work.buffer_barriers.data(),
                                      .imageMemoryBarrierCount = static_cast<std::uint32_t>(work.image_barriers.size()),
                                      .pImageMemoryBarriers = work.image_barriers.data()};
    vk.CmdPipelineBarrier2(cmd, &dependency);
    work.memory_barriers.clear();
    work.buffer_barriers.clear();
    work.image_barriers.clear();
}

void ExecutorState::whole_barrier(VkCommandBuffer cmd) const {
    const VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                   .srcStageMask = everything,
                                   .srcAccessMask = any_access,
                                   .dstStageMask = everything,
                                   .dstAccessMask = any_access};
    const VkDependencyInfo dependency{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
    vk.CmdPipelineBarrier2(cmd, &dependency);
}

} // namespace tyndall::rg
