// Leaving out what no one needs, with the reason.
// In: edges, order. Out: kept passes with the reason each lives, culled ones with the first consumer that was missing.
// Invariant: removing culled passes changes no content that a root can see. O(passes + edges).
#include <algorithm>

#include "rendergraph/stages.hpp"

namespace tyndall::rg::stages {
namespace {

enum class Touched : std::uint8_t { never, by_culled, by_kept };

/// The first resource that the pass writes, `none` if it writes nothing.
std::uint32_t first_output(const GraphDesc& graph, const PassDesc& pass) {
    const auto begin = graph.accesses.begin() + pass.first_access;
    const auto end = begin + pass.access_count;
    const auto write = std::find_if(begin, end, [](const AccessDesc& access) { return is_write(access.direction); });
    return write == end ? none : write->resource;
}

} // namespace

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
    for (std::uint32_t pass = 0; pass < count; ++pass) {
        // What touches nothing is of another form than the one compiled; it goes even with culling off.
        const PassDesc& desc = graph.passes[pass];
        const bool may_go = enabled || desc.access_count == 0;
        if (!kept.pass[pass] && may_go) {
            const bool no_consumer = first_consumer[pass] == none;
            kept.culled_passes.push_back({pass, no_consumer ? CullReason::no_consumer : CullReason::consumer_culled,
                                          no_consumer ? first_output(graph, desc) : first_consumer[pass]});
        }
        kept.pass[pass] = kept.pass[pass] || !may_go;
    }
    Scratch<Touched> touched(graph.resources.size(), Touched::never);
    for (const AccessDesc& access : graph.accesses) {
        touched[access.resource] =
            std::max(touched[access.resource], kept.pass[access.pass] ? Touched::by_kept : Touched::by_culled);
    }
    for (std::uint32_t resource = 0; resource < graph.resources.size(); ++resource) {
        if (touched[resource] != Touched::by_kept) {
            kept.culled_resources.push_back({resource, touched[resource] == Touched::never
                                                           ? CullReason::never_used
                                                           : CullReason::all_passes_culled});
        }
    }
    return kept;
}

} // namespace tyndall::rg::stages
