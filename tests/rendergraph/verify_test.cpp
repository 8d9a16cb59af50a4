// The checker: silent on what compile makes, and not silent on what is broken on purpose.
#include "rendergraph/verify.hpp"

#include "tests/rendergraph/any_frame.hpp"
#include "tests/rendergraph/frames.hpp"
#include "tests/rendergraph/shrink.hpp"

namespace tyndall::rg::test {
namespace {

std::string text(const std::vector<Violation>& violations) {
    std::string out;
    for (const Violation& v : violations) {
        out += std::string(name_of(v.code)) + ": " + v.message + "\n";
    }
    return out;
}

TEST(Verify, TheFogFrameIsProved) {
    const DeclaredGraph declared = fog_frame();
    for (const QueueTopology& topology : {one_queue(), two_queues(), two_queues_one_family()}) {
        const Plan plan = compiled(declared.desc, topology);
        EXPECT_EQ(text(verify(declared.desc, plan)), "");
    }
}

TEST(Verify, RandomFramesAreProved) {
    const std::uint32_t count = random_graph_count(2000);
    std::uint32_t planned = 0;
    for (std::uint32_t seed = 1; seed <= count; ++seed) {
        const AnyFrame frame = any_frame(seed);
        const auto plan = plan_of(frame);
        ASSERT_TRUE(plan.has_value()) << "seed " << seed << "\n" << to_text(plan.error()) << small_failure(frame);
        ASSERT_EQ(text(verify(frame.graph, *plan)), "") << "seed " << seed << "\n" << small_failure(frame);
        planned += static_cast<std::uint32_t>(plan->passes.size());
    }
    std::printf("seeds 1 to %u: %u passes planned, no violation\n", count, planned);
}

TEST(Verify, EveryDependencyOfTheFogFrameMatters) {
    const DeclaredGraph declared = fog_frame();
    for (const QueueTopology& topology : {one_queue(), two_queues(), two_queues_one_family()}) {
        const Plan plan = compiled(declared.desc, topology);
        for (std::uint32_t i = 0; i < plan.dependencies.size(); ++i) {
            Plan broken = plan;
            Dependency& d = broken.dependencies[i];
            d.src_stages = d.dst_stages = d.local_stages = 0;
            d.src_access = d.dst_access = d.local_access = 0;
            d.new_layout = d.old_layout;
            d.transfers_ownership = false;
            EXPECT_FALSE(verify(declared.desc, broken).empty()) << describe(declared.desc, plan.dependencies[i]);
        }
    }
}

} // namespace
} // namespace tyndall::rg::test
