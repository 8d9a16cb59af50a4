// How urgent each item is, and how short the frame can be at best.
// In: items with durations and edges. Out: upward ranks; a lower bound of the makespan.
// O(items log items + items x queues + edges).
#include <algorithm>
#include <bit>
#include <limits>

#include "rendergraph/assign.hpp"
#include "rendergraph/radix_sort.hpp"

namespace tyndall::rg::stages {
namespace {

/// A wait wherever no queue could run both ends of an edge.
std::int64_t forced_wait_ns(const Work& work, std::uint32_t from, std::uint32_t to, std::int64_t cross_ns) {
    return (work.allowed[from] & work.allowed[to]) == 0 ? cross_ns : 0;
}

/// By item: the longest way from the frame's start to its start.
Scratch<std::int64_t> heads(const Work& work, std::int64_t cross_ns) {
    Scratch<std::int64_t> head(work.pass.size(), 0);
    for (std::uint32_t item = 0; item < head.size(); ++item) {
        for (std::uint32_t edge = work.first_in[item]; edge < work.first_in[item + 1]; ++edge) {
            const std::uint32_t from = work.in[edge];
            head[item] =
                std::max(head[item], head[from] + work.duration_ns[from] + forced_wait_ns(work, from, item, cross_ns));
        }
    }
    return head;
}

/// The shortest time in which the queues can do the items added so far. Beside the sum there are two weights of work
/// that no moment of the model exceeds (s: slowdown, Q: usable queues). Everything counts s/Q: with k of Q queues busy,
/// k/s of work is done, which counts k/Q <= 1; alone, 1 counts s/Q. Or work bound to one queue counts 1 and the rest
/// (s-1)/(Q-1): beside k others it is (1 + k(s-1)/(Q-1))/s <= 1, and k others without it count k(s-1)/((Q-1)s) < 1.
class Load {
public:
    Load(const Work& work, std::int64_t queues, std::int64_t slowdown)
        : work_(work), queues_(queues), slowdown_(slowdown), bound_to_(work.queue_count, 0) {}
    void add(std::uint32_t item) {
        total_ += work_.duration_ns[item];
        if (is_one_queue(work_.allowed[item])) {
            bound_to_[static_cast<std::uint32_t>(std::countr_zero(work_.allowed[item]))] += work_.duration_ns[item];
        }
    }
    [[nodiscard]] std::int64_t least_ns() const {
        std::int64_t least = divided_up(total_ * slowdown_, queues_ * permille);
        for (const std::int64_t bound : bound_to_) {
            const std::int64_t rest = (total_ - bound) * (slowdown_ - permille);
            least = std::max(least, bound + divided_up(rest, (queues_ - 1) * permille));
        }
        return least;
    }

private:
    const Work& work_;
    std::int64_t queues_;
    std::int64_t slowdown_;
    std::int64_t total_ = 0;
    Scratch<std::int64_t> bound_to_; ///< by queue
};

} // namespace

Scratch<std::int64_t> tails(const Work& work, std::int64_t cross_ns) {
    Scratch<std::int64_t> tail(work.pass.size(), 0);
    for (auto item = static_cast<std::uint32_t>(work.pass.size()); item-- > 0;) {
        for (std::uint32_t edge = work.first_in[item]; edge < work.first_in[item + 1]; ++edge) {
            const std::uint32_t from = work.in[edge];
            tail[from] =
                std::max(tail[from], tail[item] + work.duration_ns[item] + forced_wait_ns(work, from, item, cross_ns));
        }
    }
    return tail;
}

Urgency urgency_of(const Work& work, const Costs& costs) {
    const std::int64_t cross_ns = cross_queue_within_limits(costs);
    Urgency urgency;
    Scratch<std::int64_t>& rank = urgency.rank_ns;
    rank.assign(work.pass.size(), 0);
    for (auto item = static_cast<std::uint32_t>(work.pass.size()); item-- > 0;) {
        rank[item] += work.duration_ns[item];
        const QueueMask here = work.allowed[item];
        const std::int64_t here_count = count_queues(here);
        for (std::uint32_t edge = work.first_in[item]; edge < work.first_in[item + 1]; ++edge) {
            // The mean over all pairs of queues, of which those with one queue for both cost nothing.
            const QueueMask there = work.allowed[work.in[edge]];
            const std::int64_t pairs = here_count * count_queues(there);
            const std::int64_t mean =
                pairs == 1 ? (here == there ? 0 : cross_ns) : cross_ns * (pairs - count_queues(here & there)) / pairs;
            std::int64_t& before = rank[work.in[edge]];
            before = std::max(before, rank[item] + mean);
        }
    }
    // Descending: durations are positive, waits not negative.
    urgency.items = order_by_key(rank.size(), [&](std::uint32_t i) { return ~static_cast<std::uint64_t>(rank[i]); });
    return urgency;
}

// Any set of items must be done before the shortest of their tails begins, and cannot begin before the shortest of
// their heads is over. The sets looked at are the most urgent items and the least urgent ones, of every number; that of
// all items is among them. The critical path bounds it too.
std::int64_t lower_bound_ns(const Work& work, const Urgency& urgency, const Costs& costs) {
    const std::int64_t slowdown = slowdown_within_limits(costs);
    const std::int64_t cross_ns = cross_queue_within_limits(costs);
    QueueMask usable = 0;
    std::int64_t total = 0;
    for (std::uint32_t item = 0; item < work.pass.size(); ++item) {
        usable |= work.allowed[item];
        total += work.duration_ns[item];
    }
    const std::int64_t queues = count_queues(usable);
    if (queues < 2 || slowdown >= queues * permille) {
        return total; // even with all queues busy no more is done than by one
    }
    const Scratch<std::int64_t> head = heads(work, cross_ns);
    const Scratch<std::int64_t> tail = tails(work, cross_ns);
    std::int64_t bound = 0;
    Load first(work, queues, slowdown);
    std::int64_t shortest_tail = std::numeric_limits<std::int64_t>::max();
    for (const std::uint32_t item : urgency.items) {
        first.add(item);
        shortest_tail = std::min(shortest_tail, tail[item]);
        bound = std::max({bound, first.least_ns() + shortest_tail, head[item] + work.duration_ns[item] + tail[item]});
    }
    Load last(work, queues, slowdown);
    std::int64_t shortest_head = std::numeric_limits<std::int64_t>::max();
    for (auto item = urgency.items.rbegin(); item != urgency.items.rend(); ++item) {
        last.add(*item);
        shortest_head = std::min(shortest_head, head[*item]);
        bound = std::max(bound, shortest_head + last.least_ns());
    }
    return bound;
}

} // namespace tyndall::rg::stages
