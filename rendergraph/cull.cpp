// Leaving out what no one needs, with the reason.
// In: edges, order. Out: kept passes with the reason each lives, culled ones with the first consumer that was missing.
// Invariant: removing culled passes changes no content that a root can see. O(passes + edges).
#include "rendergraph/stages.hpp"

namespace tyndall::rg::stages {

Kept cull(const GraphDesc& graph, const Flow& flow, const Order& order, bool enabled) {
    const std::size_t count = graph.passes.size();
    Kept kept;
    kept.pass.assign(count, false);
    kept.reason.assign(count, KeepReason::feeds_kept_pass);
    kept.keeps_for.assign(count, none);

    for (std::uint32_t pass = 0; pass < count; ++pass) {
        if (graph.passes[pass].has_side_effect) {
            kept.pass[pass] = true;
            kept.reason[pass] = KeepReason::side_effect;
        }
    }
    for (std::size_t i = 0; i < flow.last_writers.size(); ++i) {
        const std::uint32_t pass = flow.last_writers[i];
        const std::uint32_t resource = flow.last_writer_resource[i];
        if (!kept.pass[pass]) {
            kept.pass[pass] = true;
            kept.reason[pass] =
                graph.resources[resource].has_history ? KeepReason::writes_history : KeepReason::writes_import;
            kept.keeps_for[pass] = resource;
        }
    }
    // Edges are sorted by consumer: with the order backward, each pass is decided before its producers are visited.
    Scratch<std::uint32_t> first_in(count + 1, 0);
    for (const Edge& edge : flow.edges) {
        ++first_in[edge.to + 1];
    }
    for (std::size_t i = 0; i < count; ++i) {
        first_in[i + 1] += first_in[i];
    }
    Scratch<std::uint32_t> first_consumer(count, none);
    Scratch<std::uint32_t> first_output(count, none);
    for (auto pass = order.passes.rbegin(); pass != order.passes.rend(); ++pass) {
        for (std::uint32_t i = first_in[*pass]; i < first_in[*pass + 1]; ++i) {
            const Edge& edge = flow.edges[i];
            if (edge.hazard != Hazard::read_after_write) {
                continue;
            }
            first_consumer[edge.from] = *pass;
            if (kept.pass[*pass] && !kept.pass[edge.from]) {
                kept.pass[edge.from] = true;
                kept.keeps_for[edge.from] = *pass;
            }
        }
    }
    for (const AccessDesc& access : graph.accesses) {
        if (is_write(access.direction) && first_output[access.pass] == none) {
            first_output[access.pass] = access.resource;
        }
    }
    Scratch<bool> touched(graph.resources.size(), false);
    Scratch<bool> touched_by_kept(graph.resources.size(), false);
    for (std::uint32_t pass = 0; pass < count; ++pass) {
        // What touches nothing is of another form than the one compiled; it goes even with culling off.
        const bool may_go = enabled || graph.passes[pass].access_count == 0;
        if (!kept.pass[pass] && may_go) {
            const bool no_consumer = first_consumer[pass] == none;
            kept.culled_passes.push_back({pass, no_consumer ? CullReason::no_consumer : CullReason::consumer_culled,
                                          no_consumer ? first_output[pass] : first_consumer[pass]});
        }
        kept.pass[pass] = kept.pass[pass] || !may_go;
    }
    for (const AccessDesc& access : graph.accesses) {
        touched[access.resource] = true;
        touched_by_kept[access.resource] = touched_by_kept[access.resource] || kept.pass[access.pass];
    }
    for (std::uint32_t resource = 0; resource < graph.resources.size(); ++resource) {
        if (!touched_by_kept[resource]) {
            kept.culled_resources.push_back(
                {resource, touched[resource] ? CullReason::all_passes_culled : CullReason::never_used});
        }
    }
    return kept;
}

} // namespace tyndall::rg::stages
