// Measured durations become costs: alone, freed of the slowdown, with deviation; and the plan follows only when it
// pays.
#include "rendergraph/durations.hpp"

#include <random>

#include "rendergraph/simulate.hpp"
#include "tests/rendergraph/frames.hpp"

namespace tyndall::rg::test {
namespace {

constexpr std::int64_t ms = 1'000'000;

/// Two passes that nothing orders, and one that needs both.
class MeasuredDurations : public testing::Test {
protected:
    MeasuredDurations() {
        GraphBuilder graph;
        Buffer fog = graph.create_buffer("fog", {.size_bytes = 64});
        Image color = graph.create_image("color", color_image());
        Image output = graph.import_image("output", color_image(), left_for_host());
        graph.add_pass("fog", PassKind::compute).writes(fog, Access::storage_compute);
        graph.add_pass("opaque", PassKind::graphics).writes(color, Access::color_attachment);
        graph.add_pass("apply", PassKind::graphics)
            .reads(color, Access::sampled_fragment)
            .reads(fog, Access::storage_fragment)
            .writes(output, Access::color_attachment);
        graph_ = graph.finish().desc;
    }
    [[nodiscard]] Plan plan(const Costs& costs, const CompileOptions& options = {}, const Plan* previous = nullptr) {
        return *compile(graph_, two_queues(), estimate_memory(graph_), options, costs, previous);
    }
    static Costs known(std::int64_t fog, std::int64_t opaque, std::int64_t apply) {
        Costs costs;
        costs.of_pass = {{fog, 0}, {opaque, 0}, {apply, 0}};
        return costs;
    }
    /// What a device that behaves as the model says would measure.
    [[nodiscard]] std::vector<PassTiming> measured(const Plan& plan, const Costs& truth) const {
        std::vector<PassTiming> timings;
        for (const TimelinePass& pass : simulate(graph_, plan, truth).passes) {
            timings.push_back({pass.pass, static_cast<double>(pass.start_ns) * 1e-6,
                               static_cast<double>(pass.end_ns - pass.start_ns) * 1e-6});
        }
        return timings;
    }

    GraphDesc graph_;
};

TEST_F(MeasuredDurations, OfASerialFrameAreTakenAsTheyAre) {
    const Costs truth = known(2 * ms, 3 * ms, 1 * ms);
    Durations durations;
    const Plan serial = plan({});
    durations.add_frame(graph_, serial, measured(serial, truth));
    const Costs costs = durations.costs(graph_);
    EXPECT_EQ(costs.of_pass, truth.of_pass);
    EXPECT_EQ(costs.slowdown_permille, 1'500); // nothing measured: the default
}

TEST_F(MeasuredDurations, WhileOverlappedAreFreedOfTheSlowdown) {
    const Costs truth = known(2 * ms, 3 * ms, 1 * ms);
    Durations durations;
    const Plan overlapped = plan(truth);
    ASSERT_TRUE(overlapped.decision.overlaps);
    durations.add_frame(graph_, overlapped, measured(overlapped, truth)); // fog took 3 ms, opaque 4
    const Costs costs = durations.costs(graph_);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(static_cast<double>(costs.of_pass[i].mean_ns), static_cast<double>(truth.of_pass[i].mean_ns), 2)
            << i;
    }
}

TEST_F(MeasuredDurations, TheSlowdownItselfIsMeasuredAgainstFramesOnOneQueue) {
    Costs truth = known(2 * ms, 3 * ms, 1 * ms);
    const Plan overlapped = plan(truth);
    truth.slowdown_permille = 1'200; // of the device; the default says 1500
    Durations durations({.calibrate_every = 4});
    const Plan serial = plan(truth, {.async = false});
    EXPECT_FALSE(durations.calibration_due());
    durations.add_frame(graph_, serial, measured(serial, truth));
    for (int frame = 0; frame < 4; ++frame) {
        EXPECT_FALSE(durations.calibration_due());
        durations.add_frame(graph_, overlapped, measured(overlapped, truth));
    }
    EXPECT_TRUE(durations.calibration_due());
    const Costs costs = durations.costs(graph_);
    EXPECT_NEAR(static_cast<double>(costs.slowdown_permille), 1'200, 2);
    EXPECT_NEAR(static_cast<double>(costs.of_pass[0].mean_ns), 2e6, 2e4);
    durations.add_frame(graph_, serial, measured(serial, truth));
    EXPECT_FALSE(durations.calibration_due());
}

TEST_F(MeasuredDurations, TheCostOfAWaitIsMeasuredWhereAQueueStoodIdleForIt) {
    Costs truth = known(4 * ms, 3 * ms, 1 * ms); // apply waits for fog
    const Plan overlapped = plan(truth);
    ASSERT_TRUE(overlapped.decision.overlaps);
    truth.cross_queue_ns = 70'000;
    Durations durations;
    durations.add_frame(graph_, overlapped, measured(overlapped, truth));
    EXPECT_EQ(durations.costs(graph_).cross_queue_ns, 70'000);
}

TEST_F(MeasuredDurations, MeanAndDeviationFollowNewFrames) {
    Durations durations;
    const Plan serial = plan({});
    for (int frame = 0; frame < 200; ++frame) {
        const std::int64_t fog = frame % 2 == 0 ? 1'800'000 : 2'200'000;
        durations.add_frame(graph_, serial, measured(serial, known(fog, 3 * ms, 1 * ms)));
    }
    const Costs costs = durations.costs(graph_);
    EXPECT_NEAR(static_cast<double>(costs.of_pass[0].mean_ns), 2e6, 5e4);
    EXPECT_NEAR(static_cast<double>(costs.of_pass[0].deviation_ns), 2e5, 2e4);
    EXPECT_EQ(costs.of_pass[1].deviation_ns, 0);
    for (int frame = 0; frame < 100; ++frame) {
        durations.add_frame(graph_, serial, measured(serial, known(5 * ms, 3 * ms, 1 * ms)));
    }
    EXPECT_NEAR(static_cast<double>(durations.costs(graph_).of_pass[0].mean_ns), 5e6, 1e4);
    durations.clear();
    EXPECT_EQ(durations.costs(graph_).of_pass[0], PassCost{});
}

TEST_F(MeasuredDurations, AreKeptByNameAcrossFramesOfDifferentPasses) {
    Durations durations;
    const Plan serial = plan({});
    durations.add_frame(graph_, serial, measured(serial, known(2 * ms, 3 * ms, 1 * ms)));
    GraphDesc other = graph_;
    std::swap(other.passes[0], other.passes[1]); // another frame, where "opaque" comes first
    other.passes[2].name = "new";
    const Costs costs = durations.costs(other);
    EXPECT_EQ(costs.of_pass[0].mean_ns, 3 * ms);
    EXPECT_EQ(costs.of_pass[1].mean_ns, 2 * ms);
    EXPECT_EQ(costs.of_pass[2], PassCost{}); // not known
}

TEST_F(MeasuredDurations, ThePlanFollowsMeasurementsOnceAndThenStays) {
    // 500 frames of a device whose passes vary by 5 %: serial at first, as nothing is measured; then one change.
    std::mt19937 bits(11);
    const auto varied = [&](std::int64_t ns) {
        return ns + ns / 1'000 * (static_cast<std::int64_t>(bits() % 101) - 50);
    };
    Durations durations;
    Plan current = plan({});
    EXPECT_EQ(current.decision.reason, DecisionReason::nothing_measured);
    int changes = 0;
    for (int frame = 0; frame < 500; ++frame) {
        const Costs truth = known(varied(2 * ms), varied(3 * ms), varied(1 * ms));
        durations.add_frame(graph_, current, measured(current, truth));
        Plan next = plan(durations.costs(graph_), {}, &current);
        changes += to_text(graph_, next) != to_text(graph_, current) ? 1 : 0;
        current = std::move(next);
    }
    EXPECT_EQ(changes, 1);
    EXPECT_TRUE(current.decision.overlaps);
}

TEST_F(MeasuredDurations, NonsenseIsCutOff) {
    Durations durations;
    const Plan serial = plan({});
    const double nan = std::nan("");
    const std::vector<PassTiming> timings = {{0, 0.0, 1e300}, {1, -5.0, nan}, {7, 0.0, 1.0}};
    durations.add_frame(graph_, serial, timings);
    const Costs costs = durations.costs(graph_);
    EXPECT_EQ(costs.of_pass[0].mean_ns, 10'000 * ms);
    EXPECT_EQ(costs.of_pass[1], PassCost{});
}

} // namespace
} // namespace tyndall::rg::test
