#include <algorithm>

#include "rendergraph/plan_text.hpp"
#include "rendergraph/report.hpp"

namespace tyndall::rg {
namespace {

/// A string of Graphviz: quotes, backslashes and line ends escaped.
std::string quoted(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') {
            out += '\\';
        }
        out += c == '\n' ? std::string("\\n") : std::string(1, c);
    }
    return out + "\"";
}

std::string node(std::uint32_t pass) {
    return "p" + std::to_string(pass);
}

} // namespace

std::string to_dot(const GraphDesc& graph, const Plan& plan) {
    std::string text = "digraph frame {\n  rankdir=LR;\n  node [shape=box, style=\"rounded,filled\", "
                       "fillcolor=\"#e8eefc\", fontname=\"sans-serif\"];\n  edge [fontname=\"sans-serif\", "
                       "fontsize=9];\n";
    for (std::uint32_t queue = 0; queue < plan.topology.queues.size(); ++queue) {
        text += "  subgraph cluster_" + std::to_string(queue) +
                " {\n    label=" + quoted(name_of(plan.topology.queues[queue].kind)) + ";\n";
        for (const PlannedPass& pass : plan.passes) {
            if (pass.queue == queue) {
                text += "    " + node(pass.pass) + " [label=" + quoted(graph.passes[pass.pass].name) +
                        ", tooltip=" + quoted(why_kept(graph, pass)) + "];\n";
            }
        }
        text += "  }\n";
    }
    for (const CulledPass& pass : plan.culled_passes) {
        text += "  " + node(pass.pass) + " [label=" + quoted(graph.passes[pass.pass].name) +
                ", style=dashed, tooltip=" + quoted(why_culled(graph, pass)) + "];\n";
    }
    for (const Dependency& d : plan.dependencies) {
        if (d.producer != none && d.consumer != none) {
            text += "  " + node(d.producer) + " -> " + node(d.consumer) +
                    " [label=" + quoted(graph.resources[d.resource].name) + ", tooltip=" + quoted(describe(graph, d)) +
                    (d.hazard == Hazard::aliased_memory ? ", color=\"#b7791f\"" : "") + "];\n";
        }
    }
    for (const Batch& batch : plan.batches) {
        for (const BatchWait& wait : batch.waits) {
            const Batch& producer = plan.batches[wait.batch];
            text += "  " + node(plan.passes[producer.first_pass + producer.pass_count - 1].pass) + " -> " +
                    node(plan.passes[batch.first_pass].pass) + " [style=dashed, color=\"#d1495b\", label=\"wait\"];\n";
        }
    }
    return text + "}\n";
}

} // namespace tyndall::rg
