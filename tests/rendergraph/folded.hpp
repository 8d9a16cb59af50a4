// A plan of several queues as a device with one queue runs it.
#pragma once

#include "rendergraph/plan.hpp"

namespace tyndall::rg::test {

struct FoldedFrame {
    GraphDesc graph; ///< without families: there is one, and the host has no other
    Plan plan;
};
/// What the executor makes of it (executor_barriers.cpp), said again as a plan: one queue that can do everything, no
/// waits; each dependency whole before its consumer; no release halves, no transfers of ownership; what the host's
/// semaphores bring reaches everything behind them.
[[nodiscard]] FoldedFrame folded(const GraphDesc& graph, const Plan& plan);

} // namespace tyndall::rg::test
