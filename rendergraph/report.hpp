// A plan in formats for other programs: Graphviz, trace viewers, browsers.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "rendergraph/costs.hpp"
#include "rendergraph/plan.hpp"
#include "rendergraph/simulate.hpp"

namespace tyndall::rg {

/// Graphviz: a cluster a queue, a node a pass, an edge a dependency, waits between queues dashed. O(plan).
[[nodiscard]] std::string to_dot(const GraphDesc& graph, const Plan& plan);

/// Trace events (JSON) for Perfetto or chrome://tracing: a process for the prediction and, where there is a
/// measurement, one for that; in each a thread a queue, a slice a pass; the prediction has arrows for waits and a
/// counter of transient bytes. Microseconds with three decimals. Format: "Trace Event Format", Google, 2016. O(plan).
[[nodiscard]] std::string to_trace(const GraphDesc& graph, const Plan& plan, const Timeline& predicted,
                                   std::span<const TimelinePass> measured = {});

/// One page that needs nothing else and asks nothing of the network: timeline by queue, lifetimes of transients over
/// the heap, tables; a click on a pass, barrier, wait or resource shows its reason. `about` stands under the title.
[[nodiscard]] std::string to_html(std::string_view title, std::string_view about, const GraphDesc& graph,
                                  const Plan& plan, const Costs& costs);

} // namespace tyndall::rg
