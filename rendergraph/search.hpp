// The best schedule that a given effort finds. Internal; off the path of compile.
#pragma once

#include <functional>

#include "rendergraph/assign.hpp"

namespace tyndall::rg::stages {

/// What a schedule is worth: less is better, in this order.
struct Score {
    std::int64_t makespan_ns = 0;
    VkDeviceSize peak_bytes = 0; ///< transients in use at once
    std::uint32_t waits = 0;     ///< between queues
    friend auto operator<=>(const Score&, const Score&) = default;
};
/// The true worth of a schedule; its makespan is never below the queue model's.
using Judge = std::function<Score(const ItemSchedule&)>;

struct Found {
    ItemSchedule schedule;
    Score score;
    bool shortest = false;   ///< proved: no queues and no order give a shorter frame
    std::uint64_t steps = 0; ///< taken
};
/// Starts from the better of home and list schedule, tries other queues pass by pass (all combinations where there are
/// few), then branches over everything: which item next, on which queue. Equal scores: the first one met, in order of
/// urgency and then of declaration. A step is one item placed. Same input, same result.
[[nodiscard]] Found search_schedule(const Work& work, const Costs& costs, const Judge& judge, std::uint64_t most_steps);

} // namespace tyndall::rg::stages
