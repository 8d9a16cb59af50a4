// Whether overlap is worth it.
// In: items, costs, the previous schedule. Out: a schedule and the numbers it was decided by. Invariant: what the
// scheduler moves away from home makes the frame shorter in the queue model, by the threshold when it first moves; it
// stays while it still gains, and gives way only to what gains the threshold over it. O(items log items + edges).
#include <algorithm>
#include <numeric>

#include "rendergraph/assign.hpp"

namespace tyndall::rg::stages {
namespace {

bool anything_measured(const Work& work, const Costs& costs) {
    return std::any_of(work.pass.begin(), work.pass.end(), [&](std::uint32_t pass) {
        return pass < costs.of_pass.size() && costs.of_pass[pass].mean_ns > 0;
    });
}

/// One standard deviation of the work that is free to move: a gain below it may be noise. In microseconds inside, so
/// that the squares of any number of passes fit.
std::int64_t deviation_ns(const Work& work, const Costs& costs) {
    constexpr std::int64_t ns_per_us = 1'000;
    constexpr std::int64_t most_us = 1'000'000;
    std::int64_t squares = 0;
    for (std::uint32_t item = 0; item < work.pass.size(); ++item) {
        const bool free = (work.allowed[item] & (work.allowed[item] - 1)) != 0;
        if (free && work.pass[item] < costs.of_pass.size()) {
            const std::int64_t deviation = costs.of_pass[work.pass[item]].deviation_ns;
            const std::int64_t us = std::clamp<std::int64_t>(deviation / ns_per_us, 0, most_us);
            squares += us * us;
        }
    }
    return square_root(squares) * ns_per_us;
}

std::int64_t threshold_ns(const Work& work, const Costs& costs, std::int64_t serial_ns) {
    const std::int64_t share = std::clamp<std::int64_t>(costs.threshold_permille, 0, permille);
    return std::max({costs.threshold_ns, serial_ns * share / permille, deviation_ns(work, costs)});
}

/// The same queues, each in the order of the items, which is that of declaration where the data allow it.
ItemSchedule in_item_order(const ItemSchedule& schedule) {
    Scratch<std::uint32_t> queue_of(schedule.items.size());
    for (std::size_t i = 0; i < schedule.items.size(); ++i) {
        queue_of[schedule.items[i]] = schedule.queue[i];
    }
    ItemSchedule ordered{.queue = std::move(queue_of)};
    ordered.items.resize(ordered.queue.size());
    std::iota(ordered.items.begin(), ordered.items.end(), 0U);
    return ordered;
}

} // namespace

Decided decide(const Work& work, const QueueChoices& choices, const CompileOptions& options, const Costs& costs,
               const ItemSchedule& earlier) {
    const ItemSchedule previous = options.reordering ? earlier : in_item_order(earlier);
    Decided out;
    AsyncDecision& decision = out.decision;
    out.home = at_home(work);
    for (const std::int64_t duration : work.duration_ns) {
        decision.serial_ns += duration;
    }
    out.home_ns = choices.any_away ? makespan_ns(work, out.home, costs) : decision.serial_ns;
    const Urgency urgency = urgency_of(work, costs);
    decision.lower_bound_ns = lower_bound_ns(work, urgency, costs);
    decision.ceiling_ns = decision.serial_ns - decision.lower_bound_ns;
    decision.threshold_ns = threshold_ns(work, costs, decision.serial_ns);
    decision.overlap_ns = out.home_ns;

    const auto stay_home = [&](DecisionReason reason) {
        decision.reason = choices.any_away ? DecisionReason::forced : reason;
        decision.overlaps = choices.any_away;
        out.schedule = out.home;
        return out;
    };
    if (work.queue_count < 2) {
        return stay_home(DecisionReason::one_queue);
    }
    if (!options.async) {
        return stay_home(DecisionReason::switched_off);
    }
    if (!choices.any_free) {
        return stay_home(DecisionReason::nothing_async_capable);
    }
    if (!anything_measured(work, costs)) {
        return stay_home(DecisionReason::nothing_measured);
    }
    const std::int64_t least_gain = std::max<std::int64_t>(decision.threshold_ns, 1);
    const std::int64_t previous_ns = previous.items.empty() ? 0 : makespan_ns(work, previous, costs);
    const bool previous_gains = !previous.items.empty() && previous != out.home && previous_ns <= out.home_ns;
    if (!previous_gains && out.home_ns - decision.lower_bound_ns < least_gain) {
        return stay_home(DecisionReason::ceiling_below_threshold);
    }
    ItemSchedule list = list_schedule(work, urgency, costs);
    if (!options.reordering) {
        list = in_item_order(list);
    }
    const std::int64_t list_ns = makespan_ns(work, list, costs);
    const bool list_pays = out.home_ns - list_ns >= least_gain;
    if (previous_gains && previous_ns - std::min(list_ns, out.home_ns) < least_gain) {
        decision.kept_by_hysteresis = !list_pays || list != previous;
        decision.overlap_ns = previous_ns;
        out.schedule = previous;
    } else {
        decision.overlap_ns = list_ns;
        if (!list_pays) {
            return stay_home(DecisionReason::gain_below_threshold);
        }
        out.schedule = std::move(list);
        out.least_gain_ns = least_gain;
        out.previous = previous_gains ? previous : ItemSchedule{};
    }
    decision.reason = DecisionReason::overlap_pays;
    decision.overlaps = true;
    return out;
}

} // namespace tyndall::rg::stages
