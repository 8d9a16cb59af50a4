// Which queue each pass runs on, and in what order: from what is possible, through what is predicted, to what is worth
// it. Each step a pure function. Internal.
#pragma once

#include "rendergraph/queue_model.hpp"
#include "rendergraph/stages.hpp"

namespace tyndall::rg::stages {

// ---- what is possible --------------------------------------------------------------------------------------------

/// Bits of logical queues; the first 32 queues of a topology are enough for anybody.
using QueueMask = std::uint32_t;
inline constexpr std::uint32_t most_queues = 32;
// Masks have one or two bits, and std::popcount is a library call where the target may lack the instruction.
[[nodiscard]] constexpr bool is_one_queue(QueueMask queues) {
    return queues != 0 && (queues & (queues - 1)) == 0;
}
[[nodiscard]] constexpr std::int64_t count_queues(QueueMask queues) {
    std::int64_t count = 0;
    for (; queues != 0; queues &= queues - 1) {
        ++count;
    }
    return count;
}

/// By pass: the queues that it may run on. A pass with one queue only is not free.
struct QueueChoices {
    Scratch<QueueMask> allowed;
    Scratch<std::uint32_t> home; ///< the queue without any scheduling: the one asked for, or graphics
    Scratch<QueueReason> reason; ///< why home
    bool any_free = false;       ///< some kept pass has more than one queue
    bool any_away = false;       ///< the home of some kept pass is not the graphics queue
    Diagnostics errors;          ///< passes that forbid all that they are left
};
/// O(accesses).
[[nodiscard]] QueueChoices choose_queues(const GraphDesc& graph, const QueueTopology& topology, const Kept& kept,
                                         bool async);

// ---- what is predicted -------------------------------------------------------------------------------------------

/// The kept passes as items, numbered in a topological order, with everything that the queue model needs.
struct Work {
    std::uint32_t queue_count = 1;
    Scratch<std::uint32_t> pass;     ///< by item
    Scratch<std::uint32_t> item_of;  ///< by pass, `none` if it is left out
    Scratch<std::uint32_t> first_in; ///< items + 1 entries into `in`
    Scratch<std::uint32_t> in;       ///< items that come before
    Scratch<QueueMask> allowed;      ///< by item
    Scratch<std::uint32_t> home;     ///< by item
    Scratch<std::int64_t> duration_ns;
};
/// O(passes + edges).
[[nodiscard]] Work collect_work(const Flow& flow, const Order& order, const Kept& kept, const QueueChoices& choices,
                                const QueueTopology& topology, const Costs& costs);

/// Items in submission order, which respects all edges, and the queue of each. Only the order on each queue means
/// anything; `merged` gives all schedules with the same queues the same form.
struct ItemSchedule {
    Scratch<std::uint32_t> items;
    Scratch<std::uint32_t> queue; ///< parallel to items
    friend bool operator==(const ItemSchedule&, const ItemSchedule&) = default;
};
/// Everything at home, in the order of the items.
[[nodiscard]] ItemSchedule at_home(const Work& work);
/// The queues' orders merged into one, the lowest item first that may come. O(items x queues + edges).
[[nodiscard]] ItemSchedule merged(const Work& work, const ItemSchedule& schedule);
/// The frame's length in the queue model. O((items + edges) x queues).
[[nodiscard]] std::int64_t makespan_ns(const Work& work, const ItemSchedule& schedule, const Costs& costs);

/// The upward ranks of HEFT: by item, the longest way from its start to the frame's end, with the mean cost of crossing
/// queues on each edge. And the items in that order, the longest way first; ties by number.
struct Urgency {
    Scratch<std::int64_t> rank_ns;
    Scratch<std::uint32_t> items;
};
/// O(items log items + edges).
[[nodiscard]] Urgency urgency_of(const Work& work, const Costs& costs);
/// By item: the longest way from its end to the frame's end, with a wait only where no queue can run both passes.
[[nodiscard]] Scratch<std::int64_t> tails(const Work& work, std::int64_t cross_ns);
/// No schedule of these items on these queues is shorter: critical path, work bound to one queue, all work over all
/// queues, each with the slowdown of the model and with what must come before and after. O(items x queues + edges).
[[nodiscard]] std::int64_t lower_bound_ns(const Work& work, const Urgency& urgency, const Costs& costs);
/// List scheduling by upward rank with insertion (HEFT; Topcuoglu, Hariri, Wu 2002), reluctant to use a queue for what
/// can run elsewhere, in proportion to the work that cannot. O(items log items + edges).
[[nodiscard]] ItemSchedule list_schedule(const Work& work, const Urgency& urgency, const Costs& costs,
                                         std::int64_t reluctance_permille = permille);

// ---- what is worth it --------------------------------------------------------------------------------------------

/// The schedule of `previous` for this frame's items; empty where its passes, queues or order no longer fit.
[[nodiscard]] ItemSchedule previous_schedule(const Work& work, const QueueTopology& topology, std::uint64_t passes_hash,
                                             const Plan& previous);
/// Hash of all pass names, in order.
[[nodiscard]] std::uint64_t hash_of_passes(const GraphDesc& graph);

struct Decided {
    ItemSchedule schedule;
    ItemSchedule previous;          ///< the previous schedule where a new one replaces it; else empty
    ItemSchedule home;              ///< what to fall back to
    std::int64_t home_ns = 0;       ///< its length
    std::int64_t least_gain_ns = 0; ///< of a new schedule over the one that it replaces
    AsyncDecision decision;
};
/// Compares home, list schedule and the earlier one (or none) in the queue model, and takes what pays. Without
/// CompileOptions::reordering only the queues are chosen, and each keeps the order of the items.
[[nodiscard]] Decided decide(const Work& work, const QueueChoices& choices, const CompileOptions& options,
                             const Costs& costs, const ItemSchedule& earlier);

/// A schedule with all waits that it turned out to need: some only the uses tell, as a layout that is changed once for
/// readers on several queues. Its run is what simulate() says of the finished plan. Items are slots.
[[nodiscard]] QueueProgram program_of(const Schedule& schedule, const Costs& costs);

/// Passes in submission order with queue and reason: what the rest of compile works from.
[[nodiscard]] Assignment assignment_of(const Work& work, const ItemSchedule& schedule, const QueueChoices& choices);

} // namespace tyndall::rg::stages
