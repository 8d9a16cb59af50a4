// The timeline of small frames, computed by hand. Times in nanoseconds.
#include "rendergraph/simulate.hpp"
#include "tests/rendergraph/frames.hpp"

namespace tyndall::rg::test {
namespace {

/// Frames of compute passes with buffers of 256 bytes between them.
class Simulate : public testing::Test {
protected:
    Buffer out(const char* name) { return graph_.import_buffer(name, {.size_bytes = 64}, {.has_final = true}); }
    Buffer data(const char* name) { return graph_.create_buffer(name, {.size_bytes = 256}); }
    PassBuilder pass(const char* name, std::int64_t duration_ns, QueueWish wish = QueueWish::graphics) {
        costs_.of_pass.push_back({.mean_ns = duration_ns});
        PassBuilder added = graph_.add_pass(name, PassKind::compute);
        added.on_queue(wish);
        return added;
    }
    Timeline run() {
        declared_ = graph_.finish();
        return simulate(declared_.desc, compiled(declared_.desc, two_queues_one_family()), costs_);
    }
    static constexpr Access storage = Access::storage_compute;
    static constexpr QueueWish async = QueueWish::async_compute;

    GraphBuilder graph_;
    DeclaredGraph declared_;
    Costs costs_ = {.cross_queue_ns = 10, .slowdown_permille = 1'500};
};

TEST_F(Simulate, OneQueueIsTheSumInOrder) {
    Buffer a = data("a");
    Buffer b = out("b");
    pass("first", 30).writes(a, storage);
    pass("second", 50).reads(a, storage).writes(b, storage);
    const Timeline timeline = run();
    const std::vector<TimelinePass> expected = {{0, 0, 0, 30}, {1, 0, 30, 80}};
    EXPECT_EQ(timeline.passes, expected);
    EXPECT_EQ(timeline.makespan_ns, 80);
    EXPECT_EQ(timeline.critical_path, (std::vector<std::uint32_t>{0, 1}));
    EXPECT_TRUE(timeline.waits.empty());
}

TEST_F(Simulate, AWaitCostsItsLatencyAndTheQueueIdles) {
    Buffer a = data("a");
    Buffer b = out("b");
    pass("producer", 30).writes(a, storage);
    pass("consumer", 50, async).reads(a, storage).writes(b, storage);
    const Timeline timeline = run();
    const std::vector<TimelinePass> expected = {{0, 0, 0, 30}, {1, 1, 40, 90}}; // 30 + 10 for the wait
    EXPECT_EQ(timeline.passes, expected);
    const std::vector<TimelineWait> waits = {{1, 0, 0, 40}};
    EXPECT_EQ(timeline.waits, waits);
    EXPECT_EQ(timeline.critical_path, (std::vector<std::uint32_t>{0, 1}));
}

TEST_F(Simulate, PassesThatOverlapSlowEachOther) {
    Buffer a = out("a");
    Buffer b = out("b");
    pass("short", 30).writes(a, storage);
    pass("long", 100, async).writes(b, storage);
    const Timeline timeline = run();
    // Both run at 1/1.5 until the short one has had its 30: at 45. The long one has had 30 and needs 70 more.
    const std::vector<TimelinePass> expected = {{0, 0, 0, 45}, {1, 1, 0, 115}};
    EXPECT_EQ(timeline.passes, expected);
    EXPECT_EQ(timeline.critical_path, (std::vector<std::uint32_t>{1}));
}

TEST_F(Simulate, WithoutSlowdownOverlapIsFree) {
    costs_.slowdown_permille = 1'000;
    Buffer a = out("a");
    Buffer b = out("b");
    pass("short", 30).writes(a, storage);
    pass("long", 100, async).writes(b, storage);
    EXPECT_EQ(run().makespan_ns, 100);
}

TEST_F(Simulate, EndsAreRoundedUpToWholeNanoseconds) {
    costs_.slowdown_permille = 1'333;
    Buffer a = out("a");
    Buffer b = out("b");
    pass("one", 10).writes(a, storage);
    pass("two", 10, async).writes(b, storage);
    EXPECT_EQ(run().makespan_ns, 14); // 13.33
}

TEST_F(Simulate, ASemaphoreIsSignalledAtTheEndOfItsBatch) {
    Buffer a = data("a");
    Buffer b = out("b");
    Buffer c = out("c");
    pass("before", 20).writes(c, storage);
    pass("producer", 30).writes(a, storage);
    pass("own work", 5, async).has_side_effect("counts");
    pass("consumer", 40, async).reads(a, storage).writes(b, storage);
    const Timeline timeline = run();
    // Graphics: "before" beside "own work" (5 solo in 7.5, up to 8 whole; by then "before" has had 5.33), so it ends at
    // 8 + 14.67 = 22.67 -> 23, "producer" at 53; the consumer starts 10 later.
    const std::int64_t consumer_start = timeline.passes.back().start_ns;
    EXPECT_EQ(timeline.passes.back().pass, 3U);
    EXPECT_EQ(consumer_start, 63);
    const std::vector<TimelineWait> waits = {{3, 1, 8, 63}};
    EXPECT_EQ(timeline.waits, waits);
    EXPECT_EQ(timeline.critical_path, (std::vector<std::uint32_t>{0, 1, 3}));
}

TEST_F(Simulate, MemoryIsInUseFromTheFirstPassToTheLast) {
    Buffer a = data("a");
    Buffer b = data("b");
    Buffer c = out("c");
    pass("make a", 10).writes(a, storage);
    pass("a to b", 20).reads(a, storage).writes(b, storage);
    pass("b to c", 40).reads(b, storage).writes(c, storage);
    const Timeline timeline = run();
    const std::vector<MemorySample> expected = {{0, 256}, {10, 512}, {30, 256}, {70, 0}};
    EXPECT_EQ(timeline.memory, expected);
}

TEST_F(Simulate, AnUnknownPassLastsTheDefault) {
    costs_.unknown_pass_ns = 77;
    Buffer a = out("a");
    pass("unknown", 0).writes(a, storage);
    EXPECT_EQ(run().makespan_ns, 77);
}

TEST_F(Simulate, NonsenseCostsAreCutOffAndNeverOverflow) {
    costs_.cross_queue_ns = std::numeric_limits<std::int64_t>::max();
    costs_.slowdown_permille = std::numeric_limits<std::int64_t>::max();
    Buffer a = data("a");
    Buffer b = out("b");
    pass("one", std::numeric_limits<std::int64_t>::max()).writes(a, storage);
    pass("two", -5, async).reads(a, storage).writes(b, storage);
    EXPECT_EQ(run().makespan_ns, 20'000'100'000); // 10 s, a wait of 10 s, and a pass of unknown length
}

TEST_F(Simulate, AWaitThatNothingAnswersEndsTheRun) {
    Buffer a = data("a");
    Buffer b = out("b");
    pass("producer", 30).writes(a, storage);
    pass("consumer", 50, async).reads(a, storage).writes(b, storage);
    declared_ = graph_.finish();
    Plan plan = compiled(declared_.desc, two_queues_one_family());
    plan.batches[0].waits.push_back({.batch = 1});
    const Timeline timeline = simulate(declared_.desc, plan, costs_);
    EXPECT_EQ(timeline.makespan_ns, 0);
    EXPECT_EQ(timeline.passes.size(), 2U);
}

} // namespace
} // namespace tyndall::rg::test
