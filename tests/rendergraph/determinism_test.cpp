// The same input gives the same plan, byte for byte: twice within one build, and across compilers by a digest of many
// plans, which is kept as a file. compile() takes no clock and no switch for profiling, so neither can matter.
#include <array>
#include <cstdio>

#include "rendergraph/compile.hpp"
#include "rendergraph/json.hpp"
#include "rendergraph/refine.hpp"
#include "tests/rendergraph/any_frame.hpp"
#include "tests/rendergraph/golden.hpp"
#include "tests/rendergraph/random_costs.hpp"
#include "tests/rendergraph/random_graph.hpp"

namespace tyndall::rg::test {
namespace {

void add(std::uint64_t& digest, std::string_view text) {
    for (const char c : text) { // FNV-1a
        digest = (digest ^ static_cast<unsigned char>(c)) * 0x100000001b3;
    }
}

TEST(Determinism, EqualInputsGiveEqualBytes) {
    constexpr std::uint32_t usual_frames = 300;
    const std::uint32_t frames = random_graph_count(usual_frames);
    std::uint64_t digest = 0xcbf29ce484222325;
    for (std::uint32_t seed = 1; seed <= frames; ++seed) {
        const AnyFrame any = any_frame(seed);
        const DeclaredGraph small = random_frame(seed);
        const QueueTopology topology = random_topology(seed);
        for (const bool of_any : {true, false}) {
            const GraphDesc& graph = of_any ? any.graph : small.desc;
            const QueueTopology& queues = of_any ? any.topology : topology;
            const Costs costs = random_costs(seed, graph.passes.size(), true);
            const auto plan = compile(graph, queues, estimate_memory(graph), {}, costs);
            const auto again = compile(graph, queues, estimate_memory(graph), {}, costs);
            ASSERT_TRUE(plan.has_value()) << seed;
            const std::string text = plan_to_json(graph, *plan);
            ASSERT_EQ(text, plan_to_json(graph, *again)) << seed;
            add(digest, text);
            const auto refined = refine(graph, queues, estimate_memory(graph), {}, costs, &*plan, 2'000);
            add(digest, plan_to_json(graph, refined->plan));
        }
    }
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "digest of %u plans: %016llx\n", 4 * frames,
                  static_cast<unsigned long long>(digest));
    std::fputs(text.data(), stdout);
    if (frames == usual_frames) {
        expect_golden("plan_digest", text.data());
    }
}

} // namespace
} // namespace tyndall::rg::test
