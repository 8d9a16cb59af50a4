#include "rendergraph/optimality.hpp"

#include "rendergraph/plan_text.hpp"

namespace tyndall::rg {
namespace {

/// ", 4.2 % over", nothing where the bound is met. Tenths, rounded up, so that 0.0 means none.
std::string over(std::uint64_t value, std::uint64_t bound) {
    if (value <= bound || bound == 0) {
        return value == bound ? ", met" : "";
    }
    const std::uint64_t tenths = ((value - bound) * 1'000 + bound - 1) / bound;
    return ", " + std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " % over";
}

} // namespace

Optimality optimality(const GraphDesc& graph, const Plan& plan, const Timeline& timeline) {
    Optimality out;
    out.transient_bytes = plan.statistics.transient_bytes;
    out.transient_bytes_unaliased = plan.statistics.transient_bytes_unaliased;
    out.transient_bound_bytes = plan.statistics.largest_live_set_bytes;
    for (std::uint32_t r = 0; r < plan.placements.size(); ++r) {
        const bool both_copies = plan.placements[r].kind == PlacementKind::history && graph.resources[r].has_history;
        out.history_bytes += both_copies ? 2 * plan.placements[r].size_bytes : 0;
    }
    out.makespan_ns = timeline.makespan_ns;
    out.makespan_bound_ns = plan.decision.lower_bound_ns;
    out.serial_ns = plan.decision.serial_ns;
    for (const PlannedPass& pass : plan.passes) {
        out.barrier_call_count += pass.barrier_count > 0 ? 1 : 0;
    }
    for (const Batch& batch : plan.batches) {
        out.barrier_call_count += batch.releases.empty() ? 0 : 1;
        out.wait_count += static_cast<std::uint32_t>(batch.waits.size());
    }
    out.barrier_call_count += plan.exit_barrier_count > 0 ? 1 : 0;
    for (const Dependency& dependency : plan.dependencies) {
        out.transition_count += dependency.old_layout != dependency.new_layout ? 1 : 0;
        out.ownership_count += dependency.transfers_ownership ? 1 : 0;
    }
    out.barrier_count = static_cast<std::uint32_t>(plan.dependencies.size());
    out.batch_count = static_cast<std::uint32_t>(plan.batches.size());
    return out;
}

std::string to_text(const Optimality& o) {
    const auto nanoseconds = [](std::int64_t ns) { return ns > 0 ? static_cast<std::uint64_t>(ns) : 0; };
    std::string text = "transient memory " + mebibytes_text(o.transient_bytes) + ", at least " +
                       mebibytes_text(o.transient_bound_bytes) + " are in use at once" +
                       over(o.transient_bytes, o.transient_bound_bytes) + "; without sharing " +
                       mebibytes_text(o.transient_bytes_unaliased);
    if (o.history_bytes > 0) {
        text += "; history, both copies, " + mebibytes_text(o.history_bytes);
    }
    text += "\nframe " + milliseconds_text(o.makespan_ns) + " predicted, on these queues at least " +
            milliseconds_text(o.makespan_bound_ns) +
            over(nanoseconds(o.makespan_ns), nanoseconds(o.makespan_bound_ns)) + "; on one queue " +
            milliseconds_text(o.serial_ns);
    text += "\n" + std::to_string(o.barrier_count) + " barriers in " + std::to_string(o.barrier_call_count) +
            " calls, " + std::to_string(o.transition_count) + " change a layout, " + std::to_string(o.ownership_count) +
            " change the owner; " + std::to_string(o.batch_count) + " submissions, " + std::to_string(o.wait_count) +
            " waits between queues\n";
    return text;
}

} // namespace tyndall::rg
