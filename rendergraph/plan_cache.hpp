// Compiling an unchanged frame again costs a look-up.
//
//   rg::PlanCache cache;                                       // one a view; lives over the frames
//   const auto plan = cache.compile(graph.desc, queues, memory);  // every frame
#pragma once

#include <cstdint>
#include <string>

#include "rendergraph/compile.hpp"
#include "rendergraph/plan_hash.hpp"

namespace tyndall::rg {

/// Where two plans of one graph first differ, with what stands there in each; empty if they are equal. O(plans).
[[nodiscard]] std::string first_difference(const GraphDesc& graph, const Plan& a, const Plan& b);

/// Keeps the last plan and returns it again while nothing that decides it has changed.
class PlanCache {
public:
    /// With `shadow_compile`, a debug option, every hit is compiled all the same and compared: a plan that compiling
    /// would not have given is returned as a diagnostic in its place.
    explicit PlanCache(bool shadow_compile = false) : shadow_compile_(shadow_compile) {}

    /// As rg::compile, with the plan before as `previous`. The plan stays valid until the next call that compiles, and
    /// its address tells whether it is another: see compiled(). After a failure the last plan is still kept. Unchanged
    /// inputs: O(hash_of_inputs), no heap allocation.
    [[nodiscard]] tl::expected<const Plan*, Diagnostics> compile(const GraphDesc& graph, const QueueTopology& topology,
                                                                 const MemoryRequirements& memory,
                                                                 const CompileOptions& options = {},
                                                                 const Costs& costs = {});

    /// Takes a better plan of the last frame, as refine() makes it: the next call compiles with it as the plan before.
    void prefer(Plan plan);

    /// How many calls made a new plan.
    [[nodiscard]] std::uint64_t compiled() const { return compiled_; }

private:
    bool shadow_compile_;
    std::uint64_t compiled_ = 0;
    PlanHash hash_; ///< of the inputs of plan_
    Plan plan_;
    Plan before_; ///< what plan_ was compiled from, which a shadow compile needs again
};

} // namespace tyndall::rg
