// Exact search, within a number of steps.
// In: items, costs, a judge. Out: the best schedule met, and whether any shorter one can exist. Invariant: the score
// never gets worse than that of the list schedule or of everything at home.
//
// Branch and bound over sequences of (item, queue). Only the order on each queue matters, so of all sequences that
// interleave the same queues only one is visited: an item never follows a later-numbered one of another queue that it
// could as well have preceded. A branch is cut when even its optimistic times (nothing slows anything) plus what must
// still follow are no better than the best schedule met.
#include "rendergraph/search.hpp"

#include <algorithm>
#include <bit>

namespace tyndall::rg::stages {
namespace {

class Search {
public:
    Search(const Work& work, const Costs& costs, const Judge& judge, std::uint64_t most_steps)
        : work_(work), costs_(costs), judge_(judge), most_steps_(most_steps), urgency_(urgency_of(work, costs)),
          cross_ns_(cross_queue_within_limits(costs)), slowdown_(slowdown_within_limits(costs)) {}

    Found run() {
        best_.schedule = at_home(work_);
        best_.score = judge_(best_.schedule);
        for (const std::int64_t reluctance : {permille, permille / 2, std::int64_t{0}, 2 * permille}) {
            consider([&] { return list_schedule(work_, urgency_, costs_, reluctance); });
        }
        try_other_queues();
        const std::int64_t bound = lower_bound_ns(work_, urgency_, costs_);
        if (best_.score.makespan_ns > bound) {
            branch();
        }
        best_.shortest = best_.score.makespan_ns == bound || !stopped_;
        // With the steps that are left: as short, but with less memory, or fewer waits.
        if (best_.shortest) {
            ties_matter_ = true;
            branch();
        }
        best_.steps = steps_;
        return std::move(best_);
    }

private:
    /// Takes the schedule that `make` gives where it is better. The best one has had all items from the start, so that
    /// keeping another takes no memory that would have to outlive the scope.
    template <typename Make>
    void consider(Make&& make) {
        const ScratchScope scope;
        const ItemSchedule schedule = make();
        if (makespan_ns(work_, schedule, costs_) > best_.score.makespan_ns) {
            return; // the judge can only find it longer
        }
        const Score score = judge_(schedule);
        if (score < best_.score) {
            best_.score = score;
            best_.schedule = schedule;
        }
    }
    bool step(std::uint64_t count) {
        stopped_ = stopped_ || steps_ + count > most_steps_;
        steps_ += stopped_ ? 0 : count;
        return !stopped_;
    }

    // ---- other queues, with the order of the list schedule ----

    void try_other_queues() {
        Scratch<std::uint32_t> free;
        std::uint64_t combinations = 1;
        constexpr std::uint64_t few = 1'024;
        for (std::uint32_t item = 0; item < work_.pass.size(); ++item) {
            const auto choices = static_cast<std::uint64_t>(count_queues(work_.allowed[item]));
            if (choices > 1) {
                free.push_back(item);
                combinations = std::min(combinations * choices, few + 1);
            }
        }
        Work fixed = work_;
        if (combinations <= few) {
            try_all(fixed, free, 0);
            return;
        }
        bool better = true;
        while (better && !stopped_) {
            better = false;
            for (std::uint32_t i = 0; i < best_.schedule.items.size(); ++i) {
                fixed.allowed[best_.schedule.items[i]] = QueueMask{1} << best_.schedule.queue[i];
            }
            const Score before = best_.score;
            for (const std::uint32_t item : free) {
                const QueueMask here = fixed.allowed[item];
                for (QueueMask rest = work_.allowed[item] & ~here; rest != 0; rest &= rest - 1) {
                    fixed.allowed[item] = rest & (~rest + 1);
                    if (step(work_.pass.size())) {
                        consider([&] { return list_schedule(fixed, urgency_, costs_); });
                    }
                }
                fixed.allowed[item] = here;
            }
            better = best_.score < before;
        }
    }
    void try_all(Work& fixed, const Scratch<std::uint32_t>& free, std::size_t at) {
        if (at == free.size()) {
            if (step(work_.pass.size())) {
                consider([&] { return list_schedule(fixed, urgency_, costs_); });
            }
            return;
        }
        for (QueueMask rest = work_.allowed[free[at]]; rest != 0 && !stopped_; rest &= rest - 1) {
            fixed.allowed[free[at]] = rest & (~rest + 1);
            try_all(fixed, free, at + 1);
        }
    }

    // ---- branch and bound ----

    void branch() {
        const auto count = static_cast<std::uint32_t>(work_.pass.size());
        tail_ = tails(work_, cross_ns_);
        remaining_ = 0;
        bound_to_.assign(work_.queue_count, 0);
        waiting_on_.assign(work_.queue_count, 0);
        usable_ = 0;
        for (std::uint32_t item = 0; item < count; ++item) {
            remaining_ += work_.duration_ns[item];
            usable_ |= work_.allowed[item];
            if (const std::uint32_t queue = only_queue(item); queue != none) {
                bound_to_[queue] += work_.duration_ns[item];
                waiting_on_[queue] += work_.duration_ns[item];
            }
        }
        total_ = remaining_;
        placed_.assign(count, 0);
        end_.assign(count, 0);
        queue_.assign(count, none);
        free_at_.assign(work_.queue_count, 0);
        sequence_ = {};
        sequence_.items.reserve(count);
        sequence_.queue.reserve(count);
        extend();
    }

    [[nodiscard]] std::uint32_t only_queue(std::uint32_t item) const {
        return is_one_queue(work_.allowed[item]) ? static_cast<std::uint32_t>(std::countr_zero(work_.allowed[item]))
                                                 : none;
    }
    [[nodiscard]] bool ready(std::uint32_t item) const {
        for (std::uint32_t edge = work_.first_in[item]; edge < work_.first_in[item + 1]; ++edge) {
            if (placed_[work_.in[edge]] == 0) {
                return false;
            }
        }
        return true;
    }
    /// `item` on `queue` after the last of the sequence is the same as before it, and that order is visited too.
    [[nodiscard]] bool swaps_with_last(std::uint32_t item, std::uint32_t queue) const {
        if (sequence_.items.empty() || sequence_.queue.back() == queue || item > sequence_.items.back()) {
            return false;
        }
        const auto begin = work_.in.begin() + work_.first_in[item];
        const auto end = work_.in.begin() + work_.first_in[item + 1];
        return std::find(begin, end, sequence_.items.back()) == end;
    }
    [[nodiscard]] std::int64_t earliest(std::uint32_t item, std::uint32_t queue) const {
        std::int64_t start = free_at_[queue];
        for (std::uint32_t edge = work_.first_in[item]; edge < work_.first_in[item + 1]; ++edge) {
            const std::uint32_t from = work_.in[edge];
            start = std::max(start, end_[from] + (queue_[from] != queue ? cross_ns_ : 0));
        }
        return start;
    }
    /// What is placed, and the load that must still follow; the weights are those of lower_bound_ns.
    [[nodiscard]] std::int64_t load_bound() const {
        const std::int64_t queues = count_queues(usable_);
        std::int64_t bound = 0;
        std::int64_t busy = remaining_;
        for (std::uint32_t q = 0; q < work_.queue_count; ++q) {
            bound = std::max(bound, free_at_[q] + waiting_on_[q]);
            busy += free_at_[q];
            if (queues > 1 && slowdown_ < queues * permille) {
                const std::int64_t rest = (total_ - bound_to_[q]) * (slowdown_ - permille);
                bound = std::max(bound, bound_to_[q] + divided_up(rest, (queues - 1) * permille));
            }
        }
        return std::max(bound, divided_up(busy, std::max<std::int64_t>(queues, 1)));
    }
    [[nodiscard]] bool hopeless(std::int64_t bound) const {
        return ties_matter_ ? bound > best_.score.makespan_ns : bound >= best_.score.makespan_ns;
    }

    void extend() {
        if (sequence_.items.size() == work_.pass.size()) {
            consider([&] { return merged(work_, sequence_); });
            return;
        }
        for (const std::uint32_t item : urgency_.items) {
            if (placed_[item] != 0 || !ready(item)) {
                continue;
            }
            for (QueueMask rest = work_.allowed[item]; rest != 0; rest &= rest - 1) {
                const auto queue = static_cast<std::uint32_t>(std::countr_zero(rest));
                if (!swaps_with_last(item, queue)) {
                    place(item, queue);
                }
                if (stopped_) {
                    return;
                }
            }
        }
    }

    void place(std::uint32_t item, std::uint32_t queue) {
        if (!step(1)) {
            return;
        }
        const std::int64_t duration = work_.duration_ns[item];
        const std::int64_t before = free_at_[queue];
        const std::uint32_t only = only_queue(item);
        const std::int64_t end = earliest(item, queue) + duration;
        placed_[item] = 1;
        end_[item] = end;
        queue_[item] = queue;
        free_at_[queue] = end;
        remaining_ -= duration;
        (only == none ? bound_to_[queue] : waiting_on_[queue]) += only == none ? duration : -duration;
        sequence_.items.push_back(item);
        sequence_.queue.push_back(queue);
        if (!hopeless(std::max(end + tail_[item], load_bound()))) {
            extend();
        }
        sequence_.items.pop_back();
        sequence_.queue.pop_back();
        (only == none ? bound_to_[queue] : waiting_on_[queue]) -= only == none ? duration : -duration;
        remaining_ += duration;
        free_at_[queue] = before;
        placed_[item] = 0;
    }

    const Work& work_;
    const Costs& costs_;
    const Judge& judge_;
    std::uint64_t most_steps_;
    Urgency urgency_;
    std::int64_t cross_ns_;
    std::int64_t slowdown_;
    Found best_;
    std::uint64_t steps_ = 0;
    bool stopped_ = false;
    bool ties_matter_ = false;

    // Of the branch. Times are optimistic.
    Scratch<std::int64_t> tail_;       ///< by item: the longest way from its end to the frame's end
    Scratch<std::int64_t> bound_to_;   ///< by queue: work that is placed there or can run nowhere else
    Scratch<std::int64_t> waiting_on_; ///< by queue: unplaced work that can run nowhere else
    std::int64_t remaining_ = 0;       ///< unplaced work
    std::int64_t total_ = 0;
    QueueMask usable_ = 0;
    Scratch<std::uint8_t> placed_;
    Scratch<std::int64_t> end_;
    Scratch<std::uint32_t> queue_;
    Scratch<std::int64_t> free_at_;
    ItemSchedule sequence_;
};

} // namespace

Found search_schedule(const Work& work, const Costs& costs, const Judge& judge, std::uint64_t most_steps) {
    return Search(work, costs, judge, most_steps).run();
}

} // namespace tyndall::rg::stages
