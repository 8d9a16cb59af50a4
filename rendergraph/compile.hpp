// From a declared frame to a plan: a pure function.
#pragma once

#include <tl/expected.hpp>

#include "rendergraph/plan.hpp"

namespace tyndall::rg {

/// Compiles `graph` for `topology`. The same input gives a byte-identical plan everywhere. On failure, all the mistakes
/// of the graph together, never an empty list.
[[nodiscard]] tl::expected<Plan, Diagnostics> compile(const GraphDesc& graph, const QueueTopology& topology,
                                                      const MemoryRequirements& memory,
                                                      const CompileOptions& options = {});

} // namespace tyndall::rg
