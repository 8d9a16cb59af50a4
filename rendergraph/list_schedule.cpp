// List scheduling by upward rank with insertion.
// In: items, the most urgent first. Out: queue and order of each. Invariant: an item starts after all items before it,
// with the latency of crossing queues. Each item, the most urgent first, takes the queue on which it ends first, in a
// gap if one is long enough; equal ends go to its home, then to the first queue. A queue to which much work is bound
// that can run nowhere else counts as later for an item that can: without that, items crowd out work that only the
// graphics queue can do, while the other queues idle. Source: HEFT (Topcuoglu, Hariri, Wu: Performance-effective and
// low-complexity task scheduling for heterogeneous computing, 2002). Only the last few gaps of a queue are looked at,
// as earlier ones lie before anything that is still ready: O(items log items + edges).
#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "rendergraph/assign.hpp"

namespace tyndall::rg::stages {
namespace {

constexpr std::size_t remembered_gaps = 8;

struct Gap {
    std::int64_t from = 0;
    std::int64_t to = 0;
};

class Lane {
public:
    struct Place {
        std::int64_t start = 0;
        std::size_t gap = remembered_gaps; ///< remembered_gaps: behind everything
    };
    [[nodiscard]] Place find(std::int64_t ready, std::int64_t duration) const {
        Place best{std::max(ready, end_)};
        for (std::size_t i = 0; i < count_; ++i) {
            const std::int64_t start = std::max(ready, gaps_[i].from);
            if (start + duration <= gaps_[i].to && start < best.start) {
                best = {start, i};
            }
        }
        return best;
    }
    void take(const Place& place, std::int64_t duration) {
        const std::int64_t end = place.start + duration;
        if (place.gap == remembered_gaps) {
            remember({end_, place.start});
            end_ = end;
            return;
        }
        const Gap gap = gaps_[place.gap];
        gaps_[place.gap] = {gap.from, place.start};
        remember({end, gap.to});
    }

private:
    /// Keeps the latest gaps; empty ones give way first.
    void remember(const Gap& gap) {
        if (gap.from >= gap.to) {
            return;
        }
        if (count_ < remembered_gaps) {
            gaps_[count_++] = gap;
            return;
        }
        const auto earliest = std::min_element(gaps_.begin(), gaps_.end(), [](const Gap& a, const Gap& b) {
            const bool a_empty = a.from >= a.to;
            const bool b_empty = b.from >= b.to;
            return a_empty != b_empty ? a_empty : a.to < b.to;
        });
        if (earliest->from >= earliest->to || earliest->to < gap.to) {
            *earliest = gap;
        }
    }

    std::array<Gap, remembered_gaps> gaps_ = {};
    std::size_t count_ = 0;
    std::int64_t end_ = 0;
};

/// By queue: the work that can run nowhere else.
Scratch<std::int64_t> bound_work(const Work& work) {
    Scratch<std::int64_t> bound(work.queue_count, 0);
    for (std::uint32_t item = 0; item < work.pass.size(); ++item) {
        if (is_one_queue(work.allowed[item])) {
            bound[static_cast<std::uint32_t>(std::countr_zero(work.allowed[item]))] += work.duration_ns[item];
        }
    }
    return bound;
}

} // namespace

ItemSchedule list_schedule(const Work& work, const Urgency& urgency, const Costs& costs,
                           std::int64_t reluctance_permille) {
    Scratch<std::int64_t> unplaced = bound_work(work); // of it, by queue
    const std::int64_t total = std::accumulate(work.duration_ns.begin(), work.duration_ns.end(), std::int64_t{1});
    Scratch<std::int64_t> share(unplaced.size()); // in permille of a fair share of all work
    std::transform(unplaced.begin(), unplaced.end(), share.begin(), [&](std::int64_t bound) {
        return bound / permille * work.queue_count * reluctance_permille / (total / permille + 1);
    });
    const std::int64_t cross_ns = cross_queue_within_limits(costs);
    const auto count = static_cast<std::uint32_t>(work.pass.size());
    Scratch<Lane> lanes(work.queue_count);
    Scratch<std::int64_t> starts(count);
    Scratch<std::uint32_t> queue(count);
    Scratch<Scratch<std::uint32_t>> sequence(work.queue_count); // by queue: its items by start
    for (Scratch<std::uint32_t>& items : sequence) {
        items.reserve(count);
    }
    for (const std::uint32_t item : urgency.items) {
        const std::int64_t duration = work.duration_ns[item];
        const bool free = !is_one_queue(work.allowed[item]);
        std::uint32_t best_queue = none;
        std::int64_t best_start = 0;
        Lane::Place best;
        for (std::uint32_t q = 0; q < std::min(work.queue_count, most_queues); ++q) {
            if ((work.allowed[item] >> q & 1U) == 0) {
                continue;
            }
            std::int64_t ready = 0;
            for (std::uint32_t edge = work.first_in[item]; edge < work.first_in[item + 1]; ++edge) {
                const std::uint32_t from = work.in[edge];
                ready = std::max(ready, starts[from] + work.duration_ns[from] + (queue[from] != q ? cross_ns : 0));
            }
            const Lane::Place place = lanes[q].find(ready, duration);
            // Bound work that comes after this item anyway does not compete with it.
            const std::int64_t competing = std::max<std::int64_t>(unplaced[q] - (urgency.rank_ns[item] - duration), 0);
            const std::int64_t start = place.start + (free ? std::min(competing, duration * share[q] / permille) : 0);
            if (best_queue == none || start < best_start || (start == best_start && q == work.home[item])) {
                best_queue = q;
                best_start = start;
                best = place;
            }
        }
        lanes[best_queue].take(best, duration);
        // Starts of one queue differ, as no duration is zero; most come in order.
        auto at = sequence[best_queue].end();
        while (at != sequence[best_queue].begin() && starts[*std::prev(at)] > best.start) {
            --at;
        }
        sequence[best_queue].insert(at, item);
        unplaced[best_queue] -= free ? 0 : duration;
        starts[item] = best.start;
        queue[item] = best_queue;
    }
    ItemSchedule schedule;
    schedule.items.reserve(count);
    schedule.queue.reserve(count);
    for (std::uint32_t q = 0; q < work.queue_count; ++q) {
        schedule.items.insert(schedule.items.end(), sequence[q].begin(), sequence[q].end());
        schedule.queue.insert(schedule.queue.end(), sequence[q].size(), q);
    }
    return merged(work, schedule);
}

} // namespace tyndall::rg::stages
