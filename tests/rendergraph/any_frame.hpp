// Seeded random frames of everything that a graph can say. For planning only: no driver need be able to run them (see
// random_graph.hpp for those).
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "rendergraph/compile.hpp"
#include "rendergraph/graph.hpp"

namespace tyndall::rg::test {

struct AnyFrame {
    GraphDesc graph;
    QueueTopology topology;
    Costs costs;
};

/// 1 to 3 queues of the same or different families; 2D, layered, mipped, 3D, colour, depth and stencil images; buffers
/// with byte ranges; imports in all states, with semaphores and families; histories of both kinds; concurrent sharing;
/// variants; graphics, compute, transfer and host passes with queue wishes, forbidden queues and side effects; every
/// access of the table; reads of versions that were overwritten; durations for which overlap often pays. The same seed
/// gives the same frame everywhere. Compiles without a diagnostic.
[[nodiscard]] AnyFrame any_frame(std::uint32_t seed);

/// As compile makes it, with estimated memory.
[[nodiscard]] tl::expected<Plan, Diagnostics> plan_of(const AnyFrame& frame, const CompileOptions& options = {});

/// Options that switch one thing off each, by the name of what they do.
[[nodiscard]] std::vector<std::pair<std::string, CompileOptions>> each_switch();
/// Any of the switches together. 32 seeds in a row give all combinations.
[[nodiscard]] CompileOptions any_switches(std::uint32_t seed);

/// TYNDALL_RANDOM_GRAPHS, or `otherwise`: how many random frames a test goes through.
[[nodiscard]] std::uint32_t random_graph_count(std::uint32_t otherwise);

} // namespace tyndall::rg::test
