// A topological order of all passes, or the cycles that forbid one.
// In: edges. Out: an order, ties by declaration. Invariant: the same graph gives the same order. O(edges log passes).
#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>

#include "rendergraph/stages.hpp"

namespace tyndall::rg::stages {
namespace {

/// Names of the passes of one cycle among those that `remaining` marks; every such pass has a predecessor among them.
Scratch<std::uint32_t> find_cycle(const Flow& flow, const Scratch<std::uint32_t>& remaining) {
    Scratch<std::uint32_t> predecessor(remaining.size(), none);
    for (const Edge& edge : flow.edges) {
        if (remaining[edge.from] != 0 && remaining[edge.to] != 0 && predecessor[edge.to] == none) {
            predecessor[edge.to] = edge.from;
        }
    }
    auto at = static_cast<std::uint32_t>(
        std::find_if(remaining.begin(), remaining.end(), [](std::uint32_t n) { return n != 0; }) - remaining.begin());
    Scratch<bool> seen(remaining.size(), false);
    while (!seen[at]) {
        seen[at] = true;
        at = predecessor[at];
    }
    Scratch<std::uint32_t> cycle = {at};
    for (std::uint32_t next = predecessor[at]; next != at; next = predecessor[next]) {
        cycle.push_back(next);
    }
    cycle.push_back(at);
    std::reverse(cycle.begin(), cycle.end());
    return cycle;
}

} // namespace

Order order_passes(const GraphDesc& graph, const Flow& flow) {
    Order order;
    const std::size_t count = graph.passes.size();
    const bool as_declared =
        std::all_of(flow.edges.begin(), flow.edges.end(), [](const Edge& edge) { return edge.from < edge.to; });
    if (as_declared) { // which is what the smallest index first comes to
        order.passes.resize(count);
        std::iota(order.passes.begin(), order.passes.end(), 0U);
        return order;
    }
    Scratch<std::uint32_t> incoming(count, 0);
    Scratch<std::uint32_t> first_out(count + 1, 0);
    for (const Edge& edge : flow.edges) {
        ++incoming[edge.to];
        ++first_out[edge.from + 1];
    }
    for (std::size_t i = 0; i < count; ++i) {
        first_out[i + 1] += first_out[i];
    }
    Scratch<std::uint32_t> out(flow.edges.size());
    Scratch<std::uint32_t> fill(first_out.begin(), first_out.end() - 1);
    for (const Edge& edge : flow.edges) {
        out[fill[edge.from]++] = edge.to;
    }
    std::priority_queue<std::uint32_t, Scratch<std::uint32_t>, std::greater<>> ready;
    for (std::uint32_t pass = 0; pass < count; ++pass) {
        if (incoming[pass] == 0) {
            ready.push(pass);
        }
    }
    order.passes.reserve(count);
    while (!ready.empty()) {
        const std::uint32_t pass = ready.top();
        ready.pop();
        order.passes.push_back(pass);
        for (std::uint32_t i = first_out[pass]; i < first_out[pass + 1]; ++i) {
            if (--incoming[out[i]] == 0) {
                ready.push(out[i]);
            }
        }
    }
    if (order.passes.size() < count) {
        const Scratch<std::uint32_t> cycle = find_cycle(flow, incoming);
        std::string chain;
        for (const std::uint32_t pass : cycle) {
            chain += (chain.empty() ? "'" : " -> '") + graph.passes[pass].name + "'";
        }
        order.errors.push_back({.code = DiagnosticCode::cycle,
                                .pass = graph.passes[cycle[0]].name,
                                .message = "The data flow runs in a circle: " + chain +
                                           "; let one of them read an earlier version or a history",
                                .where = graph.passes[cycle[0]].where,
                                .other_where = graph.passes[cycle[1]].where});
    }
    return order;
}

} // namespace tyndall::rg::stages
