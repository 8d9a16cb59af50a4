#include "rendergraph/explain.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <vector>

#include "rendergraph/plan_text.hpp"

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

std::string mebibytes(VkDeviceSize bytes) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.2f MiB", static_cast<double>(bytes) / (1024.0 * 1024.0));
    return text.data();
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
    for (std::uint32_t b = 0; b < plan.batches.size(); ++b) {
        for (const BatchWait& wait : plan.batches[b].waits) {
            text += "batch " + std::to_string(b) + " (from '" +
                    graph.passes[plan.passes[plan.batches[b].first_pass].pass].name + "') waits for batch " +
                    std::to_string(wait.batch);
            if (wait.first_dependency != none) {
                text += ": " + describe(graph, plan.dependencies[wait.first_dependency]);
            }
            text += "\n";
        }
    }
    text += "transient memory " + mebibytes(plan.statistics.transient_bytes) + ", without sharing " +
            mebibytes(plan.statistics.transient_bytes_unaliased) + ", at least " +
            mebibytes(plan.statistics.largest_live_set_bytes) + " are live at once\n";
    return text;
}

} // namespace tyndall::rg
