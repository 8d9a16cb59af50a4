// Timestamps of passes, and what they tell after a device loss.
#include <algorithm>

#include "rendergraph/executor_state.hpp"

namespace tyndall::rg {
namespace {

/// Two words a query: value and availability.
constexpr std::uint32_t words_a_query = 2;

std::uint64_t valid_part(std::uint64_t value, std::uint32_t bits) {
    return bits >= 64 ? value : value & ((std::uint64_t{1} << bits) - 1);
}

} // namespace

ExecutorState::Result ExecutorState::prepare_queries() {
    FrameSlot& slot = slots[work.slot];
    slot.timed_count = 0;
    const auto needed = 2 * static_cast<std::uint32_t>(work.plan->passes.size());
    if (!info.profile || needed <= slot.query_capacity) {
        return {};
    }
    const VkQueryPoolCreateInfo create{
        .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO, .queryType = VK_QUERY_TYPE_TIMESTAMP, .queryCount = needed};
    VkQueryPool pool = VK_NULL_HANDLE;
    if (const VkResult result = vk.CreateQueryPool(info.device, &create, nullptr, &pool); result < 0) {
        return tl::unexpected(vulkan_error(result, "A query pool could not be created"));
    }
    vk.DestroyQueryPool(info.device, slot.queries, nullptr); // the slot's last frame has finished
    slot.queries = pool;
    slot.query_capacity = needed;
    return {};
}

bool ExecutorState::timed(std::uint32_t real_queue) const {
    // Resetting queries needs a queue that draws or computes.
    const DeviceQueue& queue = queues[real_queue].info;
    return info.profile && queue.timestamp_valid_bits > 0 && queue.kind != QueueKind::transfer;
}

void ExecutorState::reset_queries(VkCommandBuffer cmd, std::uint32_t real_queue, std::uint32_t pass_count) {
    const FrameSlot& slot = slots[work.slot];
    if (timed(real_queue) && pass_count > 0) {
        vk.CmdResetQueryPool(cmd, slot.queries, 2 * slot.timed_count, 2 * pass_count);
    }
}

void ExecutorState::write_timestamp(VkCommandBuffer cmd, std::uint32_t query) const {
    // Both ends wait for all commands before: passes that overlap are charged one after the other, and their sum is the
    // frame's time.
    vk.CmdWriteTimestamp2(cmd, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, slots[work.slot].queries, query);
    if (info.timestamps_need_full_barrier) {
        whole_barrier(cmd);
    }
}

bool ExecutorState::read_timings(const FrameSlot& slot) {
    if (slot.timed_count == 0) {
        return false;
    }
    const std::uint32_t count = 2 * slot.timed_count;
    query_results.assign(std::size_t{count} * words_a_query, 0);
    const VkResult result = vk.GetQueryPoolResults(
        info.device, slot.queries, 0, count, query_results.size() * sizeof(std::uint64_t), query_results.data(),
        words_a_query * sizeof(std::uint64_t), VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WITH_AVAILABILITY_BIT);
    bool complete = result == VK_SUCCESS;
    for (std::uint32_t query = 0; query < count; ++query) {
        complete = complete && query_results[words_a_query * query + 1] != 0;
    }
    if (!complete) {
        return false;
    }
    const auto ticks = [&](std::uint32_t query, std::uint32_t bits) {
        return valid_part(query_results[words_a_query * query], bits);
    };
    std::uint64_t first = ticks(0, slot.timed[0].valid_bits);
    for (std::uint32_t i = 0; i < slot.timed_count; ++i) {
        first = std::min(first, ticks(2 * i, slot.timed[i].valid_bits));
    }
    const double ms_a_tick = static_cast<double>(info.timestamp_period_ns) * 1e-6;
    newest_timings.clear();
    for (std::uint32_t i = 0; i < slot.timed_count; ++i) {
        const std::uint32_t bits = slot.timed[i].valid_bits;
        const std::uint64_t begin = ticks(2 * i, bits);
        const std::uint64_t duration = valid_part(ticks(2 * i + 1, bits) - begin, bits); // a counter may wrap
        newest_timings.push_back({.pass = slot.timed[i].pass,
                                  .start_ms = static_cast<double>(begin - first) * ms_a_tick,
                                  .duration_ms = static_cast<double>(duration) * ms_a_tick});
    }
    newest_timed_frame = slot.frame;
    return true;
}

std::vector<PassTiming> ExecutorState::timings() {
    for (std::uint64_t frame = frames; frame > newest_timed_frame && frame + slots.size() > frames; --frame) {
        const FrameSlot& slot = slot_of(frame);
        if (slot.frame == frame && finished(slot) && read_timings(slot)) {
            break;
        }
    }
    return newest_timings;
}

ExecuteError ExecutorState::explained(ExecuteError error) const {
    if (error.kind != ExecuteError::Kind::device_lost) {
        return error;
    }
    std::string unfinished;
    std::string newest = "none";
    std::uint64_t newest_frame = 0;
    for (const FrameSlot& slot : slots) {
        if (slot.frame > newest_frame) {
            newest_frame = slot.frame;
            newest = slot.last_pass;
        }
        for (std::uint32_t i = 0; i < slot.timed_count; ++i) {
            std::array<std::uint64_t, 2 * words_a_query> words = {};
            static_cast<void>(vk.GetQueryPoolResults(
                info.device, slot.queries, 2 * i, 2, sizeof(words), words.data(), words_a_query * sizeof(words[0]),
                VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WITH_AVAILABILITY_BIT)); // after the loss any result will do
            if (words[1] != 0 && words[3] == 0) {
                unfinished += (unfinished.empty() ? "'" : ", '") + slot.timed[i].name + "'";
            }
        }
    }
    error.message += unfinished.empty() ? "; which pass ran is not known; the last one submitted was '" + newest + "'"
                                        : "; these passes began and did not end: " + unfinished;
    return error;
}

} // namespace tyndall::rg
