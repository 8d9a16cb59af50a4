// What a plan is predicted to do in time. The same model decides in compile and explains in reports.
//
// Each queue runs its passes in the plan's order. A pass starts when its queue is free and, if it is the first of its
// batch, every batch waited for has ended, plus Costs::cross_queue_ns a wait. While passes run on more than one queue,
// each of them progresses at 1000 / slowdown_permille of its speed alone (processor sharing). Times are whole
// nanoseconds, ends rounded up.
#pragma once

#include "rendergraph/costs.hpp"
#include "rendergraph/plan.hpp"

namespace tyndall::rg {

struct TimelinePass {
    std::uint32_t pass = none;
    std::uint32_t queue = 0;
    std::int64_t start_ns = 0;
    std::int64_t end_ns = 0;
    friend bool operator==(const TimelinePass&, const TimelinePass&) = default;
};
/// The consumer's queue had nothing to do from `from_ns` to `to_ns`, when the wait for the producer was over.
struct TimelineWait {
    std::uint32_t consumer = none; ///< pass
    std::uint32_t producer = none; ///< pass, the last of the batch waited for
    std::int64_t from_ns = 0;
    std::int64_t to_ns = 0; ///< equal to from_ns where the producer had long ended
    friend bool operator==(const TimelineWait&, const TimelineWait&) = default;
};
struct MemorySample {
    std::int64_t time_ns = 0;
    VkDeviceSize bytes = 0; ///< of transients in use from then on
    friend bool operator==(const MemorySample&, const MemorySample&) = default;
};
struct Timeline {
    std::vector<TimelinePass> passes;         ///< in submission order
    std::vector<TimelineWait> waits;          ///< in submission order of the consumers
    std::vector<MemorySample> memory;         ///< ascending in time, one a change; transients placed in heaps
    std::vector<std::uint32_t> critical_path; ///< passes, first to last: each starts when the one before lets it
    std::int64_t makespan_ns = 0;
};

/// Simulates one frame of `plan`. O((passes + waits) x queues + accesses log accesses).
[[nodiscard]] Timeline simulate(const GraphDesc& graph, const Plan& plan, const Costs& costs);

} // namespace tyndall::rg
