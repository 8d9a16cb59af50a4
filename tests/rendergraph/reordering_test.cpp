// The switch CompileOptions::reordering: queues are chosen, but nothing overtakes what was declared before it.
#include <algorithm>

#include "rendergraph/verify.hpp"
#include "tests/rendergraph/any_frame.hpp"
#include "tests/rendergraph/frames.hpp"
#include "tests/rendergraph/random_costs.hpp"

namespace tyndall::rg::test {
namespace {

/// Passes of a queue that come before one that is earlier in the frame on one queue.
std::size_t overtakings(const GraphDesc& graph, const Plan& plan, const Plan& serial) {
    std::vector<std::uint32_t> place(graph.passes.size(), none);
    for (std::uint32_t i = 0; i < serial.passes.size(); ++i) {
        place[serial.passes[i].pass] = i;
    }
    std::vector<std::uint32_t> last(plan.topology.queues.size(), 0);
    std::size_t count = 0;
    for (const PlannedPass& pass : plan.passes) {
        if (place[pass.pass] == none) {
            continue; // a variant that the serial plan did not choose
        }
        count += place[pass.pass] < last[pass.queue] ? 1 : 0;
        last[pass.queue] = std::max(last[pass.queue], place[pass.pass]);
    }
    return count;
}

TEST(Reordering, SwitchedOffEachQueueKeepsTheOrderOfDeclaration) {
    std::size_t with = 0;
    std::size_t overlapping = 0;
    for (std::uint32_t seed = 0; seed < random_graph_count(400) && !HasFailure(); ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const AnyFrame made = any_frame(seed);
        const MemoryRequirements memory = estimate_memory(made.graph);
        const Costs costs = random_costs(seed, made.graph.passes.size(), true);
        const auto serial = compile(made.graph, made.topology, memory, {.async = false}, costs);
        const auto free = compile(made.graph, made.topology, memory, {}, costs);
        ASSERT_TRUE(serial && free);
        const auto kept = compile(made.graph, made.topology, memory, {.reordering = false}, costs, &*free);
        ASSERT_TRUE(kept);
        EXPECT_EQ(overtakings(made.graph, *kept, *serial), 0U);
        EXPECT_TRUE(verify(made.graph, *kept).empty());
        with += overtakings(made.graph, *free, *serial);
        overlapping += kept->decision.reason == DecisionReason::overlap_pays ? 1 : 0;
    }
    EXPECT_GT(with, 0U) << "no frame here is reordered at all";
    EXPECT_GT(overlapping, 0U);
}

} // namespace
} // namespace tyndall::rg::test
