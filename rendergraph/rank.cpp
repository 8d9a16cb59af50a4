// How urgent each item is, and how short the frame can be at best.
// In: items with durations and edges. Out: upward ranks; a lower bound of the makespan. O(items x queues + edges).
#include <algorithm>
#include <bit>

#include "rendergraph/assign.hpp"

namespace tyndall::rg::stages {
namespace {

constexpr std::int64_t divided_up(std::int64_t a, std::int64_t b) {
    return (a + b - 1) / b;
}

/// The longest chain, with a wait wherever no queue could run both ends of an edge.
std::int64_t critical_path_ns(const Work& work, std::int64_t cross_ns) {
    std::vector<std::int64_t> end(work.pass.size(), 0);
    std::int64_t longest = 0;
    for (std::uint32_t item = 0; item < work.pass.size(); ++item) {
        std::int64_t start = 0;
        for (std::uint32_t edge = work.first_in[item]; edge < work.first_in[item + 1]; ++edge) {
            const std::uint32_t from = work.in[edge];
            const bool must_cross = (work.allowed[from] & work.allowed[item]) == 0;
            start = std::max(start, end[from] + (must_cross ? cross_ns : 0));
        }
        end[item] = start + work.duration_ns[item];
        longest = std::max(longest, end[item]);
    }
    return longest;
}

} // namespace

std::vector<std::int64_t> upward_ranks(const Work& work, const Costs& costs) {
    const std::int64_t cross_ns = cross_queue_within_limits(costs);
    std::vector<std::int64_t> rank(work.pass.size(), 0);
    for (auto item = static_cast<std::uint32_t>(work.pass.size()); item-- > 0;) {
        rank[item] += work.duration_ns[item];
        const QueueMask here = work.allowed[item];
        for (std::uint32_t edge = work.first_in[item]; edge < work.first_in[item + 1]; ++edge) {
            // The mean over all pairs of queues, of which those with one queue for both cost nothing.
            const QueueMask there = work.allowed[work.in[edge]];
            const int pairs = std::popcount(here) * std::popcount(there);
            const std::int64_t mean = cross_ns * (pairs - std::popcount(here & there)) / pairs;
            std::int64_t& before = rank[work.in[edge]];
            before = std::max(before, rank[item] + mean);
        }
    }
    return rank;
}

// Beside the critical path, two weights of work that no moment of the model exceeds (s: slowdown, Q: usable queues).
// Everything counts s/Q: with k of Q queues busy, k/s of work is done, which counts k/Q <= 1; alone, 1 counts
// s/Q, or 1 where s > Q. Work bound to one queue counts 1 and the rest (s-1)/(Q-1): beside k others it is
// (1 + k(s-1)/(Q-1))/s <= 1, and those others without it count k(s-1)/((Q-1)s) < 1.
std::int64_t lower_bound_ns(const Work& work, const Costs& costs) {
    const std::int64_t slowdown = slowdown_within_limits(costs);
    std::int64_t total = 0;
    QueueMask usable = 0;
    std::vector<std::int64_t> bound_to(work.queue_count, 0);
    for (std::uint32_t item = 0; item < work.pass.size(); ++item) {
        total += work.duration_ns[item];
        usable |= work.allowed[item];
        if (std::has_single_bit(work.allowed[item])) {
            bound_to[static_cast<std::uint32_t>(std::countr_zero(work.allowed[item]))] += work.duration_ns[item];
        }
    }
    const std::int64_t queues = std::popcount(usable);
    if (queues < 2 || slowdown >= queues * permille) {
        return total;
    }
    std::int64_t bound = std::max(critical_path_ns(work, cross_queue_within_limits(costs)),
                                  divided_up(total * slowdown, queues * permille));
    for (const std::int64_t bound_ns : bound_to) {
        const std::int64_t rest = total - bound_ns;
        bound = std::max(bound, bound_ns + divided_up(rest * (slowdown - permille), (queues - 1) * permille));
    }
    return bound;
}

} // namespace tyndall::rg::stages
