// Plans run on the CPU find, in every read, what the graph says.
#include "tests/rendergraph/cpu_executor.hpp"

#include <gtest/gtest.h>

#include "tests/rendergraph/any_frame.hpp"
#include "tests/rendergraph/frames.hpp"

namespace tyndall::rg::test {
namespace {

TEST(CpuExecutor, FindsWhatTheGraphSays) {
    const std::uint32_t count = std::min(random_graph_count(60), 2000U); // a thread for each access
    std::uint64_t reads = 0;
    for (std::uint32_t seed = 1; seed <= count; ++seed) {
        const AnyFrame frame = any_frame(seed);
        const auto plan = plan_of(frame);
        ASSERT_TRUE(plan.has_value());
        for (const Values values : {Values::own, Values::from_reads}) {
            const CpuRun run = run_on_cpu(frame.graph, *plan, values);
            ASSERT_TRUE(run.started);
            ASSERT_EQ(run.mismatches, 0U) << "seed " << seed << ": " << run.first_mismatch;
            reads += run.reads;
        }
    }
    EXPECT_GT(reads, 1000U * count);
    std::printf("seeds 1 to %u: %llu cells read\n", count, static_cast<unsigned long long>(reads));
}

TEST(CpuExecutor, FindsBytesThatAnotherResourceOverwrote) {
#ifdef __SANITIZE_THREAD__
    GTEST_SKIP() << "the sanitiser reports the race itself; tyndall_rendergraph_races asks it to";
#endif
    const DeclaredGraph declared = fog_frame();
    Plan plan = compiled(declared.desc, one_queue());
    const auto named = [&](std::string_view name) {
        const auto it = std::find_if(declared.desc.resources.begin(), declared.desc.resources.end(),
                                     [&](const ResourceDesc& r) { return r.name == name; });
        return static_cast<std::size_t>(it - declared.desc.resources.begin());
    };
    plan.placements[named("esm")].offset_bytes = plan.placements[named("cascades")].offset_bytes;
    EXPECT_GT(run_on_cpu(declared.desc, plan, Values::own).mismatches, 0U);
}

TEST(CpuExecutor, RefusesAWaitThatNothingAnswers) {
    const DeclaredGraph declared = fog_frame();
    Plan plan = compiled(declared.desc, two_queues());
    for (std::uint32_t b = 0; b < plan.batches.size(); ++b) {
        for (BatchWait& wait : plan.batches[b].waits) {
            wait.batch = b;
        }
    }
    EXPECT_FALSE(run_on_cpu(declared.desc, plan, Values::own).started);
}

} // namespace
} // namespace tyndall::rg::test
