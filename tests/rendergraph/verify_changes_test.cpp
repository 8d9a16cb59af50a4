// Frames of one plan after frames of another: other costs or other switches move passes between queues and transients
// in memory, and what the frames share (histories, imports, bytes of heaps) must stay ordered and in its layout.
#include <algorithm>
#include <array>
#include <random>

#include "rendergraph/verify.hpp"
#include "tests/rendergraph/frames.hpp"
#include "tests/rendergraph/random_costs.hpp"
#include "tests/rendergraph/random_graph.hpp"

namespace tyndall::rg::test {
namespace {

constexpr std::uint32_t frames_tried = 2'000;

/// Whether a pass has another queue or another place in the order.
bool passes_move(const Plan& a, const Plan& b) {
    return !std::equal(
        a.passes.begin(), a.passes.end(), b.passes.begin(), b.passes.end(),
        [](const PlannedPass& x, const PlannedPass& y) { return x.pass == y.pass && x.queue == y.queue; });
}

CompileOptions random_options(std::mt19937& bits) {
    const auto mostly = [&bits] { return bits() % 4 != 0; };
    return {.aliasing = mostly(), .async = mostly(), .reordering = mostly(), .full_barriers = !mostly()};
}

TEST(VerifyChanges, RandomFramesAreProvedAcrossAChangeOfCostsAndSwitches) {
    std::uint32_t moved = 0;
    std::uint32_t raced = 0;
    for (std::uint32_t seed = 0; seed < frames_tried; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937 bits(seed);
        const DeclaredGraph declared = random_frame(seed);
        const GraphDesc& graph = declared.desc;
        const QueueTopology topology = random_topology(seed);
        const MemoryRequirements memory = estimate_memory(graph);
        const auto before =
            compile(graph, topology, memory, random_options(bits), random_costs(2 * seed, graph.passes.size(), true));
        ASSERT_TRUE(before.has_value()) << to_text(before.error());
        const auto after = compile(graph, topology, memory, random_options(bits),
                                   random_costs(2 * seed + 1, graph.passes.size(), true), &*before);
        ASSERT_TRUE(after.has_value()) << to_text(after.error());
        const PlannedFrame first{&graph, &*before};
        const PlannedFrame second{&graph, &*after};
        const std::array<PlannedFrame, 6> frames = {first, first, second, second, second, first};
        const std::vector<Violation> violations = verify_sequence(frames);
        ASSERT_TRUE(violations.empty()) << violations.front().message;
        moved += passes_move(*before, *after) ? 1 : 0;
        raced += verify_sequence(frames, BetweenFrames::nothing).empty() ? 0 : 1;
    }
    EXPECT_GT(moved, frames_tried / 10) << "the plans must differ for this to say anything";
    EXPECT_GT(raced, frames_tried / 4) << "the frames must share something";
}

} // namespace
} // namespace tyndall::rg::test
