// How far a plan is from what no plan could beat.
#pragma once

#include <string>

#include "rendergraph/costs.hpp"
#include "rendergraph/plan.hpp"
#include "rendergraph/simulate.hpp"

namespace tyndall::rg {

struct Optimality {
    VkDeviceSize transient_bytes = 0;
    VkDeviceSize transient_bytes_unaliased = 0;
    VkDeviceSize transient_bound_bytes = 0; ///< no packing is smaller
    VkDeviceSize history_bytes = 0;         ///< both copies; outside the bound
    std::int64_t makespan_ns = 0;           ///< predicted
    std::int64_t makespan_bound_ns = 0;     ///< critical path, work that only graphics can do, all work over the queues
    std::int64_t serial_ns = 0;
    std::uint32_t barrier_count = 0;
    std::uint32_t barrier_call_count =
        0; ///< vkCmdPipelineBarrier2: at most one a pass, one a batch's end, one at the end
    std::uint32_t transition_count = 0; ///< barriers that change a layout
    std::uint32_t ownership_count = 0;
    std::uint32_t batch_count = 0;
    std::uint32_t wait_count = 0;
};

/// O(plan).
[[nodiscard]] Optimality optimality(const GraphDesc& graph, const Plan& plan, const Timeline& timeline);

/// A few lines: each figure against its bound.
[[nodiscard]] std::string to_text(const Optimality& figures);

} // namespace tyndall::rg
