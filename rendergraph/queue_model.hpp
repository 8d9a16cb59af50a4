// How queues work through their passes: the model behind simulate and behind every decision of the scheduler. Internal.
#pragma once

#include <cstdint>

#include "rendergraph/costs.hpp"
#include "rendergraph/scratch.hpp"

namespace tyndall::rg::stages {

/// The limits inside which sums and products of costs stay exact: a host's nonsense is cut off, never overflows.
inline constexpr std::int64_t longest_ns = 10'000'000'000; ///< of one pass or wait
inline constexpr std::int64_t permille = 1'000;
inline constexpr std::int64_t largest_slowdown_permille = 10'000;

[[nodiscard]] constexpr std::int64_t divided_up(std::int64_t a, std::int64_t b) {
    return (a + b - 1) / b;
}
/// Largest integer whose square is at most `n`.
[[nodiscard]] std::int64_t square_root(std::int64_t n);
[[nodiscard]] std::int64_t duration_within_limits(const Costs& costs, std::uint32_t pass);
[[nodiscard]] std::int64_t cross_queue_within_limits(const Costs& costs);
[[nodiscard]] std::int64_t slowdown_within_limits(const Costs& costs);

/// Passes ("items") in submission order, each on a queue, with the items on other queues that it waits for.
struct QueueProgram {
    std::uint32_t queue_count = 1;
    Scratch<std::uint32_t> queue;      ///< by item
    Scratch<std::int64_t> duration_ns; ///< by item, alone on the device
    Scratch<std::uint32_t> first_wait; ///< items + 1 entries into `producers`
    Scratch<std::uint32_t> producers;  ///< items
};
struct QueueRun {
    Scratch<std::int64_t> start_ns; ///< by item
    Scratch<std::int64_t> end_ns;
    std::int64_t makespan_ns = 0;
};
/// Event by event, in whole nanoseconds. Items behind a wait that nothing answers start and end at the makespan.
/// O((items + waits) x queues).
[[nodiscard]] QueueRun run_queues(const QueueProgram& program, const Costs& costs);

} // namespace tyndall::rg::stages
