// From a declared frame to a plan: a pure function.
#pragma once

#include <tl/expected.hpp>

#include "rendergraph/costs.hpp"
#include "rendergraph/plan.hpp"

namespace tyndall::rg {

/// Compiles `graph` for `topology`. The same input gives a byte-identical plan everywhere. On failure, all the mistakes
/// of the graph together, never an empty list. Passes whose queue is free are scheduled by `costs`; `previous` is the
/// plan of the frame before (or of refine), whose schedule and memory stay where they fit and no other gains enough.
[[nodiscard]] tl::expected<Plan, Diagnostics> compile(const GraphDesc& graph, const QueueTopology& topology,
                                                      const MemoryRequirements& memory,
                                                      const CompileOptions& options = {}, const Costs& costs = {},
                                                      const Plan* previous = nullptr);

} // namespace tyndall::rg
