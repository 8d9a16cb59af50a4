#include "rendergraph/explain.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <vector>

#include "rendergraph/plan_text.hpp"
#include "rendergraph/reasons.hpp"

namespace tyndall::rg {
namespace {

constexpr std::size_t columns = 7;
using Row = std::array<std::string, columns>;

std::string milliseconds(std::span<const PassDuration> durations, std::uint32_t pass) {
    for (const PassDuration& duration : durations) {
        if (duration.pass == pass) {
            std::array<char, 32> text{};
            std::snprintf(text.data(), text.size(), "%.3f", duration.milliseconds);
            return text.data();
        }
    }
    return "";
}

std::string point_name(const GraphDesc& graph, std::uint32_t pass) {
    const std::uint32_t point = graph.passes[pass].point;
    return point == none ? "-" : graph.points[point];
}

std::string first_pass_of(const GraphDesc& graph, const Plan& plan, std::uint32_t batch) {
    return "batch " + std::to_string(batch) + " (from '" +
           graph.passes[plan.passes[plan.batches[batch].first_pass].pass].name + "')";
}

/// Waits, releases and the host's semaphores, batch by batch.
std::string explain_batches(const GraphDesc& graph, const Plan& plan, const PlanOrder& order) {
    std::string text;
    for (std::uint32_t b = 0; b < plan.batches.size(); ++b) {
        const Batch& batch = plan.batches[b];
        const std::string subject = first_pass_of(graph, plan, b);
        for (const BatchWait& wait : batch.waits) {
            text += subject + " waits for batch " + std::to_string(wait.batch) + ": " +
                    why_wait(graph, plan, order, b, wait) + "\n";
        }
        for (const std::uint32_t resource : batch.waits_imports) {
            text += subject + " waits for the host's semaphore: it is the first to use '" +
                    graph.resources[resource].name + "'\n";
        }
        for (const std::uint32_t dependency : batch.releases) {
            text += subject + " ends with: " + describe(graph, plan.dependencies[dependency]) + "\n";
        }
        for (const std::uint32_t resource : batch.signals_imports) {
            text += subject + " signals the host's semaphore: it is the last to use '" +
                    graph.resources[resource].name + "'\n";
        }
    }
    for (std::uint32_t d = plan.first_exit_barrier; d < plan.first_exit_barrier + plan.exit_barrier_count; ++d) {
        text += "the frame ends with: " + describe(graph, plan.dependencies[d]) + "\n";
    }
    return text;
}

std::string explain_memory(const GraphDesc& graph, const Plan& plan, const PlanOrder& order) {
    std::string text;
    for (std::uint32_t r = 0; r < plan.placements.size(); ++r) {
        const Placement& placement = plan.placements[r];
        if (placement.kind == PlacementKind::heap) {
            text += "memory of '" + graph.resources[r].name + "': " + mebibytes_text(placement.size_bytes) + " at " +
                    mebibytes_text(placement.offset_bytes) + " of heap " + std::to_string(placement.heap) + ", " +
                    why_memory(graph, plan, order, r) + "\n";
        } else if (placement.kind == PlacementKind::history) {
            text += "memory of '" + graph.resources[r].name + "': " + why_memory(graph, plan, order, r) + "\n";
        }
    }
    for (const CulledResource& resource : plan.culled_resources) {
        text += "'" + graph.resources[resource.resource].name + "' is not created: " + why_omitted(resource) + "\n";
    }
    return text;
}

} // namespace

std::string explain_table(const GraphDesc& graph, const Plan& plan, std::span<const PassDuration> durations) {
    std::vector<Row> rows = {{"pass", "declared at", "queue", "slot", "ms", "why", "why this queue"}};
    for (const PlannedPass& pass : plan.passes) {
        rows.push_back({graph.passes[pass.pass].name, point_name(graph, pass.pass),
                        std::string(name_of(plan.topology.queues[pass.queue].kind)), std::to_string(pass.slot),
                        milliseconds(durations, pass.pass), why_kept(graph, pass), why_queue(pass)});
    }
    for (const CulledPass& pass : plan.culled_passes) {
        rows.push_back({graph.passes[pass.pass].name, point_name(graph, pass.pass), "-", "-", "",
                        "left out: " + why_culled(graph, pass), ""});
    }
    std::array<std::size_t, columns> width{};
    for (const Row& row : rows) {
        for (std::size_t c = 0; c < columns; ++c) {
            width[c] = std::max(width[c], row[c].size());
        }
    }
    std::string text;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        for (std::size_t c = 0; c < columns; ++c) {
            const std::string padding(width[c] - rows[r][c].size(), ' ');
            const bool number = c == 3 || c == 4;
            text += (number ? padding + rows[r][c] : rows[r][c] + padding) + (c + 1 < columns ? "  " : "");
        }
        text.erase(text.find_last_not_of(' ') + 1);
        text += "\n";
        if (r == 0 || r > plan.passes.size()) {
            continue;
        }
        const PlannedPass& pass = plan.passes[r - 1];
        for (std::uint32_t d = pass.first_barrier; d < pass.first_barrier + pass.barrier_count; ++d) {
            text += "    barrier: " + describe(graph, plan.dependencies[d]) + "\n";
        }
    }
    const PlanOrder order(graph, plan);
    text += explain_batches(graph, plan, order);
    text += explain_memory(graph, plan, order);
    for (std::uint32_t variant = 0; variant < plan.variants.size(); ++variant) {
        text += why_form(graph, plan, variant) + "\n";
    }
    text += "transient memory " + mebibytes_text(plan.statistics.transient_bytes) + ", without sharing " +
            mebibytes_text(plan.statistics.transient_bytes_unaliased) + ", at least " +
            mebibytes_text(plan.statistics.transient_bound_bytes) + " are needed\n";
    text += describe(plan.decision) + "\n";
    return text;
}

} // namespace tyndall::rg
