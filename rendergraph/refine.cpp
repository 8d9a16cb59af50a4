// Exact scheduling around compile.
// In: what compile gets. Out: a plan whose schedule a search chose. Invariant: the plan is one that compile made, so
// that it has passed through the same stages as any other.
#include "rendergraph/refine.hpp"

#include <algorithm>

#include "rendergraph/compile.hpp"
#include "rendergraph/search.hpp"
#include "rendergraph/simulate.hpp"
#include "rendergraph/variants.hpp"

namespace tyndall::rg {
namespace {

using namespace stages;

/// The most bytes of transients in use at once, from the first start to the last end of each.
VkDeviceSize peak_bytes(const GraphDesc& graph, const MemoryRequirements& memory, const Schedule& schedule,
                        const QueueRun& run) {
    struct Change {
        std::int64_t time = 0;
        VkDeviceSize more = 0;
        VkDeviceSize less = 0;
    };
    std::vector<Change> changes;
    for (std::uint32_t r = 0; r < graph.resources.size(); ++r) {
        const std::uint32_t first = schedule.first_use[r];
        const std::uint32_t last = schedule.first_use[r + 1];
        if (graph.resources[r].lifetime != ResourceLifetime::transient || first == last) {
            continue;
        }
        std::int64_t from = run.start_ns[schedule.uses[first].slot];
        std::int64_t to = 0;
        for (std::uint32_t i = first; i < last; ++i) {
            from = std::min(from, run.start_ns[schedule.uses[i].slot]);
            to = std::max(to, run.end_ns[schedule.uses[i].slot]);
        }
        changes.push_back({from, memory.of_resource[r].size_bytes, 0});
        changes.push_back({to, 0, memory.of_resource[r].size_bytes});
    }
    // What ends makes room before what starts at the same moment.
    std::sort(changes.begin(), changes.end(),
              [](const Change& a, const Change& b) { return a.time != b.time ? a.time < b.time : a.more < b.more; });
    VkDeviceSize bytes = 0;
    VkDeviceSize peak = 0;
    for (const Change& change : changes) {
        bytes = bytes + change.more - change.less;
        peak = std::max(peak, bytes);
    }
    return peak;
}

/// What compile's `previous` needs to know of a plan.
Plan as_previous(const Work& work, const ItemSchedule& schedule, const Plan& like) {
    Plan plan;
    plan.variants = like.variants;
    plan.topology = like.topology;
    plan.passes_hash = like.passes_hash;
    for (std::size_t i = 0; i < schedule.items.size(); ++i) {
        plan.passes.push_back({.pass = work.pass[schedule.items[i]], .queue = schedule.queue[i]});
    }
    return plan;
}

} // namespace

tl::expected<Refined, Diagnostics> refine(const GraphDesc& graph, const QueueTopology& topology,
                                          const MemoryRequirements& memory, CompileOptions options, const Costs& costs,
                                          const Plan* previous, std::uint64_t most_steps) {
    options.effort = Effort::thorough;
    const ScratchScope scope;
    tl::expected<Plan, Diagnostics> compiled = compile(graph, topology, memory, options, costs, previous);
    if (!compiled) {
        return tl::unexpected(std::move(compiled.error()));
    }
    Refined refined{std::move(*compiled)};
    const AsyncDecision& current = refined.plan.decision;
    const bool may_choose = current.reason != DecisionReason::one_queue &&
                            current.reason != DecisionReason::switched_off &&
                            current.reason != DecisionReason::nothing_measured;
    if (!may_choose) {
        return refined;
    }
    std::vector<std::uint32_t> forms;
    for (const VariantDecision& variant : refined.plan.variants) {
        forms.push_back(variant.form);
    }
    const OneForm one = with_forms(graph, forms);
    const Cells cells = cut_into_cells(one.graph);
    const Flow everything = follow_versions(one.graph, cells);
    const Order order = order_passes(one.graph, everything);
    const Kept kept = cull(one.graph, everything, order, options.culling);
    const Flow flow = follow_versions(one.graph, cells, &kept.pass);
    const QueueChoices choices = choose_queues(one.graph, topology, kept, options.async);
    const Work work = collect_work(flow, order, kept, choices, topology, costs);
    const Judge judge = [&](const ItemSchedule& items) {
        const Schedule scheduled = schedule(one.graph, topology, cells, flow, assignment_of(work, items, choices));
        const QueueRun run = run_queues(program_of(scheduled, costs), costs);
        return Score{run.makespan_ns, peak_bytes(one.graph, memory, scheduled, run),
                     static_cast<std::uint32_t>(scheduled.waits.size())};
    };
    const std::int64_t current_ns = simulate(graph, refined.plan, costs).makespan_ns;
    Found found = search_schedule(work, costs, judge, most_steps);
    refined.shortest = found.shortest;
    refined.steps = found.steps;
    // With no plan to keep, an equal length is enough: then it is for less memory or fewer waits.
    const bool fresh = previous == nullptr && current.reason == DecisionReason::overlap_pays;
    const std::int64_t least_gain_ns = fresh ? 0 : std::max<std::int64_t>(current.threshold_ns, 1);
    if (current_ns - found.score.makespan_ns >= least_gain_ns) {
        const Plan better = as_previous(work, found.schedule, refined.plan);
        refined.plan = *compile(graph, topology, memory, options, costs, &better);
        refined.plan.decision.kept_by_hysteresis = false; // it is the new one
    }
    return refined;
}

} // namespace tyndall::rg
