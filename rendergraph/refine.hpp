// A better plan than compile has time for.
#pragma once

#include <tl/expected.hpp>

#include "rendergraph/costs.hpp"
#include "rendergraph/plan.hpp"

namespace tyndall::rg {

struct Refined {
    Plan plan;               ///< the previous plan's schedule where no better one pays
    bool shortest = false;   ///< proved: no choice of queues and no order on them gives a shorter frame
    std::uint64_t steps = 0; ///< taken
};

/// Searches queues and orders for the shortest frame in the model of simulate.hpp; among equals for the lowest peak of
/// transient memory, then the fewest waits, then declaration order; and the plan's memory for the smallest packing,
/// with Effort::thorough whatever the options say. With `previous`, a new schedule is taken when it gains the threshold
/// over the one that compile gives; without, the best is. Exact for frames of up to about ten passes that are free to
/// choose their queue, else the best that `most_steps` meet. The effort is counted in steps (one pass placed), never in
/// time, so that the result is the same everywhere. Meant for a thread beside the frame: hand the plan to a later
/// compile as its `previous`, or to PlanCache::prefer. Errors are those of compile.
[[nodiscard]] tl::expected<Refined, Diagnostics> refine(const GraphDesc& graph, const QueueTopology& topology,
                                                        const MemoryRequirements& memory, CompileOptions options,
                                                        const Costs& costs, const Plan* previous = nullptr,
                                                        std::uint64_t most_steps = 200'000);

} // namespace tyndall::rg
