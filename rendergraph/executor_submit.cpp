// Folding a plan's logical queues onto the device's, cutting its batches into command buffers, and submitting them.
#include <algorithm>

#include "rendergraph/executor_state.hpp"

namespace tyndall::rg {

void ExecutorState::map_queues() {
    const QueueTopology& topology = work.plan->topology;
    work.real_of.assign(topology.queues.size(), 0);
    work.logical_count.assign(queues.size(), 0);
    for (std::uint32_t logical = 0; logical < topology.queues.size(); ++logical) {
        const QueueKind kind = topology.queues[logical].kind;
        // The n-th logical queue of a kind runs on the n-th real one, else on the last of that kind, else on graphics.
        auto rank = std::count_if(topology.queues.begin(), topology.queues.begin() + logical,
                                  [&](const QueueInfo& other) { return other.kind == kind; });
        std::uint32_t chosen = none;
        for (std::uint32_t real = 0; real < queues.size() && !work.by_host; ++real) {
            if (queues[real].info.kind == kind && (chosen == none || rank-- >= 1)) {
                chosen = real;
            }
        }
        work.real_of[logical] = chosen == none ? 0 : chosen;
        ++work.logical_count[work.real_of[logical]];
    }
}

void ExecutorState::plan_segments() {
    const Plan& plan = *work.plan;
    work.segments.clear();
    work.batch_signals.assign(plan.batches.size(), false);
    work.segment_of_batch.assign(plan.batches.size(), 0);
    const auto real = [&](std::uint32_t batch) { return work.real_of[plan.batches[batch].queue]; };
    for (std::uint32_t batch = 0; batch < plan.batches.size(); ++batch) {
        for (const BatchWait& wait : plan.batches[batch].waits) {
            if (real(wait.batch) != real(batch)) {
                work.batch_signals[wait.batch] = true;
            }
        }
    }
    for (std::uint32_t queue = 0; queue < queues.size(); ++queue) {
        const bool prepares = std::any_of(histories.begin(), histories.end(),
                                          [&](const auto& pair) { return preparing_queue(*pair) == queue; });
        if (prepares) {
            work.segments.push_back({.queue = queue});
        }
    }
    for (std::uint32_t batch = 0; batch < plan.batches.size(); ++batch) {
        const Batch& current = plan.batches[batch];
        const bool waits = !current.waits_imports.empty() ||
                           std::any_of(current.waits.begin(), current.waits.end(),
                                       [&](const BatchWait& wait) { return real(wait.batch) != real(batch); });
        const bool joins = batch > 0 && real(batch - 1) == real(batch) && !waits && !work.batch_signals[batch - 1] &&
                           plan.batches[batch - 1].signals_imports.empty();
        if (!joins) {
            work.segments.push_back({.queue = real(batch), .first_batch = batch});
        }
        ++work.segments.back().batch_count;
        work.segment_of_batch[batch] = static_cast<std::uint32_t>(work.segments.size() - 1);
    }
}

void ExecutorState::plan_semaphores() {
    const Plan& plan = *work.plan;
    work.waits.clear();
    work.signals.clear();
    work.queue_begun.assign(queues.size(), false);
    work.values.resize(queues.size());
    std::transform(queues.begin(), queues.end(), work.values.begin(), [](const RealQueue& q) { return q.submitted; });
    work.entry_values = work.values;
    const auto count = [](const auto& list) { return static_cast<std::uint32_t>(list.size()); };
    const auto add = [](std::vector<VkSemaphoreSubmitInfo>& list, VkSemaphore semaphore, std::uint64_t value,
                        VkPipelineStageFlags2 stages) {
        list.push_back({.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                        .semaphore = semaphore,
                        .value = value,
                        .stageMask = stages});
    };
    constexpr VkPipelineStageFlags2 everything = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    for (Segment& segment : work.segments) {
        segment.first_wait = count(work.waits);
        segment.first_signal = count(work.signals);
        if (segment.first_batch == 0 && segment.batch_count > 0) {
            work.entry_values = work.values; // preparations come first in the list
        }
        if (segment.batch_count == 0 || !work.queue_begun[segment.queue]) {
            // The queue's first work of the frame comes after all that the other queues did before: earlier frames,
            // and preparations of histories in this one.
            for (std::uint32_t other = 0; other < queues.size(); ++other) {
                if (other != segment.queue && work.entry_values[other] > 0) {
                    add(work.waits, queues[other].timeline, work.entry_values[other], everything);
                }
            }
        }
        work.queue_begun[segment.queue] = segment.batch_count > 0;
        for (std::uint32_t batch = segment.first_batch; batch < segment.first_batch + segment.batch_count; ++batch) {
            for (const BatchWait& wait : plan.batches[batch].waits) {
                const std::uint32_t other = work.real_of[plan.batches[wait.batch].queue];
                if (other != segment.queue) {
                    const Segment& producer = work.segments[work.segment_of_batch[wait.batch]];
                    add(work.waits, queues[other].timeline, producer.value, wait.stages);
                }
            }
            for (const std::uint32_t resource : plan.batches[batch].waits_imports) {
                const ImportBinding& binding = *work.bindings[resource];
                add(work.waits, binding.wait_semaphore, binding.wait_value, everything);
            }
            for (const std::uint32_t resource : plan.batches[batch].signals_imports) {
                const ImportBinding& binding = *work.bindings[resource];
                add(work.signals, binding.signal_semaphore, binding.signal_value, everything);
            }
        }
        segment.value = ++work.values[segment.queue];
        add(work.signals, queues[segment.queue].timeline, segment.value, everything);
        segment.wait_count = count(work.waits) - segment.first_wait;
        segment.signal_count = count(work.signals) - segment.first_signal;
    }
    work.queue_begun.assign(queues.size(), false);
}

ExecutorState::Result ExecutorState::submit_segments() {
    work.submits.clear();
    work.command_buffers.clear();
    for (const Segment& segment : work.segments) {
        work.command_buffers.push_back(
            {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, .commandBuffer = segment.cmd});
    }
    for (std::size_t i = 0; i < work.segments.size(); ++i) {
        const Segment& segment = work.segments[i];
        work.submits.push_back({.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                                .waitSemaphoreInfoCount = segment.wait_count,
                                .pWaitSemaphoreInfos = work.waits.data() + segment.first_wait,
                                .commandBufferInfoCount = 1,
                                .pCommandBufferInfos = work.command_buffers.data() + i,
                                .signalSemaphoreInfoCount = segment.signal_count,
                                .pSignalSemaphoreInfos = work.signals.data() + segment.first_signal});
    }
    // In plan order, which is topological: nothing waits for what is submitted later. Neighbours on a queue go
    // together.
    for (std::size_t begin = 0; begin < work.segments.size();) {
        std::size_t end = begin + 1;
        const std::uint32_t queue = work.segments[begin].queue;
        while (end < work.segments.size() && work.segments[end].queue == queue) {
            ++end;
        }
        const VkResult result = vk.QueueSubmit2(queues[queue].info.queue, static_cast<std::uint32_t>(end - begin),
                                                work.submits.data() + begin, VK_NULL_HANDLE);
        if (result < 0) {
            return tl::unexpected(vulkan_error(result, "The frame could not be submitted"));
        }
        queues[queue].submitted = work.segments[end - 1].value;
        begin = end;
    }
    return {};
}

} // namespace tyndall::rg
