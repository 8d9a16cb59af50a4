#include "rendergraph/compile.hpp"

#include <algorithm>

#include "rendergraph/assign.hpp"
#include "rendergraph/stages.hpp"
#include "rendergraph/variants.hpp"

namespace tyndall::rg {
namespace {

void append(Diagnostics& to, Diagnostics from) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

Diagnostics mistakes_of(const stages::Flow& flow, const stages::Order& order) {
    Diagnostics errors = flow.errors;
    append(errors, order.errors);
    return errors;
}

/// What the data flow adds to mistakes already found, so that one run tells all. Nothing where a missing access or an
/// impossible range would make it speak of consequences, or where each form of a variant has a flow of its own.
Diagnostics further_mistakes(const GraphDesc& graph, const Diagnostics& found) {
    const bool hides_flow = std::any_of(found.begin(), found.end(), [](const Diagnostic& mistake) {
        return mistake.code == DiagnosticCode::range_outside || mistake.code == DiagnosticCode::bad_description ||
               mistake.code == DiagnosticCode::foreign_handle;
    });
    if (hides_flow || !graph.variants.empty()) {
        return {};
    }
    const stages::Flow flow = stages::follow_versions(graph, stages::cut_into_cells(graph));
    return mistakes_of(flow, stages::order_passes(graph, flow));
}

/// What was ordered through a culled pass must be ordered directly: where one comes before a kept pass, versions are
/// followed again without it.
stages::Flow flow_between_kept(const GraphDesc& graph, const stages::Cells& cells, stages::Flow& everything,
                               const stages::Kept& kept) {
    const auto culled = [&](std::uint32_t pass) { return !kept.pass[pass]; };
    const bool goes_through = std::any_of(everything.edges.begin(), everything.edges.end(),
                                          [&](const auto& edge) { return culled(edge.from) && !culled(edge.to); });
    if (goes_through) {
        return follow_versions(graph, cells, &kept.pass);
    }
    stages::Flow flow = std::move(everything);
    std::erase_if(flow.edges, [&](const auto& edge) { return culled(edge.to); });
    return flow;
}

/// The decided schedule, unless waits that only a schedule knows cost what it gained.
stages::Schedule schedule_what_pays(const GraphDesc& graph, const QueueTopology& topology, const stages::Cells& cells,
                                    const stages::Flow& flow, const stages::Work& work,
                                    const stages::QueueChoices& choices, const Costs& costs, stages::Decided& decided) {
    const auto scheduled = [&](const stages::ItemSchedule& items) {
        return schedule(graph, topology, cells, flow, assignment_of(work, items, choices));
    };
    AsyncDecision& decision = decided.decision;
    stages::Schedule best = scheduled(decided.schedule);
    if (decision.reason != DecisionReason::overlap_pays) {
        return best;
    }
    decision.overlap_ns = run_queues(program_of(best, costs), costs).makespan_ns;
    if (!decided.previous.items.empty()) {
        stages::Schedule kept = scheduled(decided.previous);
        const std::int64_t kept_ns = run_queues(program_of(kept, costs), costs).makespan_ns;
        if (kept_ns - decision.overlap_ns < decided.least_gain_ns) {
            best = std::move(kept);
            decision.overlap_ns = kept_ns;
            decision.kept_by_hysteresis = true;
        }
    }
    const std::int64_t least_gain_ns = decision.kept_by_hysteresis ? 0 : decided.least_gain_ns;
    if (decided.home_ns - decision.overlap_ns >= least_gain_ns) {
        return best;
    }
    decision.reason = choices.any_away ? DecisionReason::forced : DecisionReason::gain_below_threshold;
    decision.overlaps = choices.any_away;
    decision.kept_by_hysteresis = false;
    return scheduled(decided.home);
}

/// Gives each wait the first dependency that shows why; `none` stays where only the order of memory asks for it.
/// O(dependencies x queues).
void name_reasons_of_waits(std::span<const std::uint32_t> batch_of_pass, Plan& plan) {
    for (std::uint32_t i = 0; i < plan.dependencies.size(); ++i) {
        const Dependency& d = plan.dependencies[i];
        if (d.consumer == none || d.producer == none) {
            continue;
        }
        for (BatchWait& wait : plan.batches[batch_of_pass[d.consumer]].waits) {
            if (wait.first_dependency == none && wait.batch == batch_of_pass[d.producer]) {
                wait.first_dependency = i;
            }
        }
    }
}

/// Everything after validation, for a graph without variants.
tl::expected<Plan, Diagnostics> compile_valid(const GraphDesc& graph, const QueueTopology& topology,
                                              const MemoryRequirements& memory, const CompileOptions& options,
                                              const Costs& costs, const Plan* previous, std::uint64_t passes_hash) {
    using namespace stages;
    const ScratchScope scope; // the forms of a variant take turns
    const Cells cells = cut_into_cells(graph);
    Flow everything = follow_versions(graph, cells);
    const Order order = order_passes(graph, everything);
    if (Diagnostics errors = mistakes_of(everything, order); !errors.empty()) {
        return tl::unexpected(std::move(errors));
    }
    Kept kept = cull(graph, everything, order, options.culling);
    const Flow flow = flow_between_kept(graph, cells, everything, kept);
    const QueueChoices choices = choose_queues(graph, topology, kept, options.async);
    if (!choices.errors.empty()) {
        return tl::unexpected(choices.errors);
    }
    const Work work = collect_work(flow, order, kept, choices, topology, costs);
    Decided decided =
        decide(work, choices, options, costs,
               previous != nullptr ? previous_schedule(work, topology, passes_hash, *previous) : ItemSchedule{});
    const Schedule sched = schedule_what_pays(graph, topology, cells, flow, work, choices, costs, decided);
    Memory placed = place(graph, topology, sched, memory, options, previous);
    Batches batches = make_batches(graph, sched);
    Synchronised sync = synchronise(graph, topology, cells, sched, placed, batches, options.full_barriers);

    Attachments attachments = choose_attachment_operations(graph, cells, sched);

    Plan plan;
    plan.topology = topology;
    plan.first_exit_barrier = sync.first_exit;
    plan.exit_barrier_count = static_cast<std::uint32_t>(sync.dependencies.size()) - sync.first_exit;
    plan.dependencies = std::move(sync.dependencies);
    plan.attachments = std::move(attachments.operations);
    plan.placements = std::move(placed.placements);
    plan.heaps = std::move(placed.heaps);
    plan.batches = std::move(batches.batches);
    plan.culled_passes = std::move(kept.culled_passes);
    plan.culled_resources = std::move(kept.culled_resources);
    plan.passes.reserve(batches.order.size());
    Scratch<std::uint32_t> batch_of_pass(graph.passes.size(), none);
    for (const std::uint32_t slot : batches.order) {
        const std::uint32_t pass = sched.order[slot];
        batch_of_pass[pass] = batches.batch_of[slot];
        plan.passes.push_back({
            .pass = pass,
            .queue = sched.queue[slot],
            .batch = batches.batch_of[slot],
            .slot = sched.position[slot],
            .keep_reason = kept.reason[pass],
            .keep_for = kept.keeps_for[pass],
            .queue_reason = sched.queue_reason[slot],
            .first_barrier = sync.first_of_slot[slot],
            .barrier_count = sync.first_of_slot[slot + 1] - sync.first_of_slot[slot],
            .first_attachment = attachments.first_of_slot[slot],
            .attachment_count = attachments.first_of_slot[slot + 1] - attachments.first_of_slot[slot],
        });
    }
    for (std::uint32_t i = 0; i < plan.batches.size(); ++i) {
        plan.batches[i].releases = std::move(sync.releases[i]);
        plan.statistics.wait_count += static_cast<std::uint32_t>(plan.batches[i].waits.size());
    }
    name_reasons_of_waits(batch_of_pass, plan);
    for (std::uint32_t resource = 0; resource < plan.placements.size(); ++resource) {
        plan.placements[resource].resting_layout = sync.resting_layout[resource];
    }
    for (const Heap& heap : plan.heaps) {
        plan.statistics.transient_bytes += heap.size_bytes;
    }
    plan.statistics.transient_bytes_unaliased = placed.unaliased_bytes;
    plan.statistics.transient_bound_bytes = placed.bound_bytes;
    plan.statistics.barrier_count = static_cast<std::uint32_t>(plan.dependencies.size());
    plan.decision = decided.decision;
    plan.passes_hash = passes_hash;
    return plan;
}

} // namespace

tl::expected<Plan, Diagnostics> compile(const GraphDesc& graph, const QueueTopology& topology,
                                        const MemoryRequirements& memory, const CompileOptions& options,
                                        const Costs& costs, const Plan* previous) {
    const stages::ScratchScope scope;
    Diagnostics errors = graph.declaration_errors;
    append(errors, stages::validate(graph, topology));
    const bool is_described = std::none_of(errors.begin(), errors.end(), [](const Diagnostic& mistake) {
        return mistake.code == DiagnosticCode::bad_description;
    });
    if (is_described) {
        append(errors, stages::validate_memory(graph, memory));
    }
    if (!errors.empty()) {
        append(errors, further_mistakes(graph, errors));
        return tl::unexpected(std::move(errors));
    }
    const std::uint64_t passes_hash = stages::hash_of_passes(graph);
    const auto compile_form = [&](const GraphDesc& form) {
        return compile_valid(form, topology, memory, options, costs, previous, passes_hash);
    };
    return graph.variants.empty() ? compile_form(graph)
                                  : stages::compile_variants(graph, costs, passes_hash, previous, compile_form);
}

} // namespace tyndall::rg
