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
    out.transient_bound_bytes = plan.statistics.transient_bound_bytes;
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

std::string to_text(const Optimality& figures) {
    const auto nanoseconds = [](std::int64_t ns) { return ns > 0 ? static_cast<std::uint64_t>(ns) : 0; };
    std::string text = "transient memory " + mebibytes_text(figures.transient_bytes) + ", at least " +
                       mebibytes_text(figures.transient_bound_bytes) + " are needed" +
                       over(figures.transient_bytes, figures.transient_bound_bytes) + "; without sharing " +
                       mebibytes_text(figures.transient_bytes_unaliased);
    if (figures.history_bytes > 0) {
        text += "; history, both copies, " + mebibytes_text(figures.history_bytes);
    }
    text += "\nframe " + milliseconds_text(figures.makespan_ns) + " predicted, on these queues at least " +
            milliseconds_text(figures.makespan_bound_ns) +
            over(nanoseconds(figures.makespan_ns), nanoseconds(figures.makespan_bound_ns)) + "; on one queue " +
            milliseconds_text(figures.serial_ns);
    text += "\n" + std::to_string(figures.barrier_count) + " barriers in " +
            std::to_string(figures.barrier_call_count) + " calls, " + std::to_string(figures.transition_count) +
            " change a layout, " + std::to_string(figures.ownership_count) + " change the owner; " +
            std::to_string(figures.batch_count) + " submissions, " + std::to_string(figures.wait_count) +
            " waits between queues\n";
    return text;
}

} // namespace tyndall::rg
