// Queues chosen by durations: when overlap pays, when it does not, and that a plan does not flutter.
#include <iostream>

#include "rendergraph/plan_text.hpp"
#include "rendergraph/simulate.hpp"
#include "rendergraph/verify.hpp"
#include "tests/rendergraph/any_frame.hpp"
#include "tests/rendergraph/random_costs.hpp"
#include "tests/rendergraph/random_graph.hpp"

namespace tyndall::rg::test {
namespace {

constexpr std::int64_t ms = 1'000'000;

/// Fog beside opaque work: "density" (compute) needs nothing, "opaque" (graphics) needs nothing, "apply" needs both.
class Scheduling : public testing::Test {
protected:
    Scheduling() { declare(graph_); }

    static void declare(GraphBuilder& graph, QueueWish wish = QueueWish::automatic, bool forbid = false) {
        Image output = graph.import_image("output", color_image(), left_for_host());
        Image color = graph.create_image("color", color_image());
        Buffer density = graph.create_buffer("density", {.size_bytes = 4096});
        PassBuilder fog = graph.add_pass("density", PassKind::compute);
        fog.writes(density, Access::storage_compute).on_queue(wish);
        if (forbid) {
            fog.never_on(QueueKind::compute);
        }
        graph.add_pass("opaque", PassKind::graphics).writes(color, Access::color_attachment);
        graph.add_pass("apply", PassKind::graphics)
            .reads(color, Access::sampled_fragment)
            .reads(density, Access::storage_fragment)
            .writes(output, Access::color_attachment);
    }
    static Costs costs(std::int64_t density_ns, std::int64_t opaque_ns, std::int64_t apply_ns) {
        Costs costs;
        costs.of_pass = {{density_ns, 0}, {opaque_ns, 0}, {apply_ns, 0}};
        return costs;
    }
    static Plan compiled_with(const GraphDesc& graph, const Costs& costs, const Plan* previous = nullptr,
                              const QueueTopology& topology = two_queues(), const CompileOptions& options = {}) {
        auto plan = compile(graph, topology, estimate_memory(graph), options, costs, previous);
        EXPECT_TRUE(plan.has_value());
        EXPECT_TRUE(verify(graph, *plan).empty());
        return plan.value_or(Plan{});
    }
    static std::uint32_t queue_of(const Plan& plan, std::uint32_t pass) {
        for (const PlannedPass& planned : plan.passes) {
            if (planned.pass == pass) {
                return planned.queue;
            }
        }
        return none;
    }

    GraphBuilder graph_;
};

TEST_F(Scheduling, OverlapsWhereItPaysAndSaysByHowMuch) {
    const DeclaredGraph declared = graph_.finish();
    const Plan plan = compiled_with(declared.desc, costs(2 * ms, 3 * ms, 1 * ms));
    EXPECT_EQ(queue_of(plan, 0), 1U);
    EXPECT_EQ(queue_of(plan, 1), 0U);
    const AsyncDecision& d = plan.decision;
    EXPECT_TRUE(d.overlaps);
    EXPECT_EQ(d.reason, DecisionReason::overlap_pays);
    EXPECT_EQ(d.serial_ns, 6 * ms);
    // Both at 1/1.5 until density has had its 2 ms, at 3; opaque's last 1 ms alone, to 4 (the wait of 0.02 is over by
    // then); apply to 5.
    EXPECT_EQ(d.overlap_ns, 5 * ms);
    EXPECT_EQ(d.overlap_ns, simulate(declared.desc, plan, costs(2 * ms, 3 * ms, 1 * ms)).makespan_ns);
    // 4 ms only graphics can do, and half of the other 2 as slowdown.
    EXPECT_EQ(d.lower_bound_ns, 5 * ms);
    EXPECT_EQ(d.ceiling_ns, 1 * ms);
    EXPECT_EQ(d.threshold_ns, 120'000); // 2 % of 6 ms
    EXPECT_EQ(plan.passes[0].queue_reason, QueueReason::overlap_pays);
}

TEST_F(Scheduling, StaysSerialBelowTheThresholdAndSaysWhy) {
    const DeclaredGraph declared = graph_.finish();
    // The ceiling is half of density's time: 0.05 ms of the 0.1 wanted.
    const Plan small = compiled_with(declared.desc, costs(100'000, 3 * ms, 1 * ms));
    EXPECT_FALSE(small.decision.overlaps);
    EXPECT_EQ(small.decision.reason, DecisionReason::ceiling_below_threshold);
    // A perfect schedule could gain 0.15 ms of 1.7, but the wait before "apply" eats it.
    Costs waits = costs(300'000, 400'000, 1 * ms);
    waits.cross_queue_ns = 300'000;
    const Plan eaten = compiled_with(declared.desc, waits);
    EXPECT_FALSE(eaten.decision.overlaps);
    EXPECT_EQ(eaten.decision.reason, DecisionReason::gain_below_threshold);
    EXPECT_EQ(eaten.batches.size(), 1U);
}

TEST_F(Scheduling, WhyItIsSerial) {
    const DeclaredGraph declared = graph_.finish();
    const Costs worth_it = costs(2 * ms, 3 * ms, 1 * ms);
    EXPECT_EQ(compiled_with(declared.desc, worth_it, nullptr, one_queue()).decision.reason, DecisionReason::one_queue);
    EXPECT_EQ(compiled_with(declared.desc, worth_it, nullptr, two_queues(), {.async = false}).decision.reason,
              DecisionReason::switched_off);
    EXPECT_EQ(compiled_with(declared.desc, {}).decision.reason, DecisionReason::nothing_measured);
    GraphBuilder forbidden;
    declare(forbidden, QueueWish::automatic, true);
    const DeclaredGraph nowhere = forbidden.finish();
    const Plan plan = compiled_with(nowhere.desc, worth_it);
    EXPECT_EQ(plan.decision.reason, DecisionReason::nothing_async_capable);
    EXPECT_EQ(plan.passes[0].queue_reason, QueueReason::forbidden);
}

TEST_F(Scheduling, APassThatForbidsGraphicsRunsElsewhere) {
    GraphDesc graph = graph_.finish().desc;
    graph.passes[0].forbidden_queues = queue_bit(QueueKind::graphics);
    const Plan plan = compiled_with(graph, {});
    EXPECT_EQ(plan.passes[0].queue, 1U);
    EXPECT_EQ(plan.passes[0].queue_reason, QueueReason::forbidden);
    EXPECT_EQ(why_queue(plan.passes[0]), "other queues that could are forbidden");
    // A switch is for looking for faults: it wins.
    const Plan serial = compiled_with(graph, {}, nullptr, two_queues(), {.async = false});
    EXPECT_EQ(serial.passes[0].queue, 0U);
    EXPECT_EQ(serial.passes[0].queue_reason, QueueReason::async_switched_off);
}

TEST_F(Scheduling, SlowdownOfTwoLeavesNothingToGain) {
    const DeclaredGraph declared = graph_.finish();
    Costs shared = costs(2 * ms, 3 * ms, 1 * ms);
    shared.slowdown_permille = 2'000;
    const Plan plan = compiled_with(declared.desc, shared);
    EXPECT_EQ(plan.decision.ceiling_ns, 0);
    EXPECT_FALSE(plan.decision.overlaps);
}

TEST_F(Scheduling, AGainWithinOneStandardDeviationIsNoise) {
    const DeclaredGraph declared = graph_.finish();
    Costs noisy = costs(2 * ms, 3 * ms, 1 * ms);
    noisy.of_pass[0].deviation_ns = 3 * ms / 2; // more than the 1 ms that overlap would gain
    const Plan plan = compiled_with(declared.desc, noisy);
    EXPECT_EQ(plan.decision.threshold_ns, 3 * ms / 2);
    EXPECT_FALSE(plan.decision.overlaps);
    noisy.of_pass[0].deviation_ns = ms / 2;
    EXPECT_TRUE(compiled_with(declared.desc, noisy).decision.overlaps);
}

TEST_F(Scheduling, ARequestIsARequest) {
    GraphBuilder asks;
    declare(asks, QueueWish::async_compute);
    const DeclaredGraph declared = asks.finish();
    const Plan plan = compiled_with(declared.desc, costs(1'000, 3 * ms, 1 * ms)); // it cannot pay
    EXPECT_EQ(queue_of(plan, 0), 1U);
    EXPECT_EQ(plan.decision.reason, DecisionReason::forced);
    GraphBuilder refuses;
    declare(refuses, QueueWish::graphics);
    const DeclaredGraph stays = refuses.finish();
    EXPECT_EQ(queue_of(compiled_with(stays.desc, costs(2 * ms, 3 * ms, 1 * ms)), 0), 0U);
}

/// Clusters from an import, resource 0, beside opaque work; then both meet.
DeclaredGraph clusters_from(const ImportDesc& import, QueueWish wish = QueueWish::automatic) {
    GraphBuilder graph;
    Buffer lights = graph.import_buffer("lights", {.size_bytes = 64}, import);
    Image output = graph.import_image("output", color_image(), left_for_host());
    Buffer list = graph.create_buffer("list", {.size_bytes = 64});
    graph.add_pass("cluster", PassKind::compute)
        .reads(lights, Access::storage_compute)
        .writes(list, Access::storage_compute)
        .on_queue(wish);
    graph.add_pass("opaque", PassKind::graphics).writes(output, Access::color_attachment);
    graph.add_pass("apply", PassKind::graphics)
        .reads(list, Access::storage_fragment)
        .modifies(output, Access::color_attachment);
    return graph.finish();
}

TEST_F(Scheduling, AnImportThatTheHostDoesNotShareStaysInItsFamily) {
    DeclaredGraph declared = clusters_from({.read_only = true});
    const Costs worth_it = costs(2 * ms, 3 * ms, 1 * ms);
    const Plan apart = compiled_with(declared.desc, worth_it);
    EXPECT_EQ(queue_of(apart, 0), 0U);
    EXPECT_EQ(apart.passes[0].queue_reason, QueueReason::import_not_shared);
    EXPECT_EQ(queue_of(compiled_with(declared.desc, worth_it, nullptr, two_queues_one_family()), 0), 1U);
    declared.desc.resources[0].concurrent = true;
    EXPECT_EQ(queue_of(compiled_with(declared.desc, worth_it), 0), 1U);
}

TEST_F(Scheduling, AnImportThatOnlyTheFirstQueueComesBeforeStaysThere) {
    GraphBuilder graph;
    Buffer out = graph.import_buffer("out", {.size_bytes = 64},
                                     {.has_final = true,
                                      .final_stages = VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                                      .final_access = VK_ACCESS_2_SHADER_STORAGE_READ_BIT});
    graph.share_between_queues(out);
    graph.add_pass("beside", PassKind::compute).writes(out, Access::storage_compute).on_queue(QueueWish::async_compute);
    DeclaredGraph declared = graph.finish();
    const auto planned = [&] {
        Plan plan = compiled_with(declared.desc, {});
        EXPECT_TRUE(verify(declared.desc, plan).empty());
        return plan;
    };
    const Plan stays = planned();
    EXPECT_EQ(queue_of(stays, 0), 0U);
    EXPECT_EQ(stays.passes[0].queue_reason, QueueReason::import_ordered_by_queue);
    EXPECT_EQ(stays.dependencies.back().dst_stages, VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT);
    // A semaphore orders it from any queue, from which it goes on to stages that the queue cannot name.
    declared.desc.imports[0].signals_semaphore = true;
    const Plan away = planned();
    EXPECT_EQ(queue_of(away, 0), 1U);
    EXPECT_EQ(away.dependencies.back().dst_stages, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT);
    // Nor is the host itself in need of one queue: it waits for the whole frame.
    declared.desc.imports[0].signals_semaphore = false;
    declared.desc.imports[0].final_stages = VK_PIPELINE_STAGE_2_HOST_BIT;
    EXPECT_EQ(queue_of(planned(), 0), 1U);
}

TEST_F(Scheduling, AnImportThatOnlyTheFirstQueueComesAfterStaysThere) {
    for (const QueueWish wish : {QueueWish::automatic, QueueWish::async_compute}) {
        DeclaredGraph declared = clusters_from({.initial_stages = VK_PIPELINE_STAGE_2_COPY_BIT,
                                                .initial_access = VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                                .read_only = true},
                                               wish);
        declared.desc.resources[0].concurrent = true;
        const Costs worth_it = costs(2 * ms, 3 * ms, 1 * ms);
        const Plan plan = compiled_with(declared.desc, worth_it);
        EXPECT_EQ(queue_of(plan, 0), 0U);
        EXPECT_EQ(plan.passes[0].queue_reason, QueueReason::import_ordered_by_queue);
        EXPECT_TRUE(verify(declared.desc, plan).empty());
        // A semaphore orders it for every queue, and what the host itself wrote is there before anything is submitted.
        ImportDesc& import = declared.desc.imports[0];
        import.waits_semaphore = true;
        EXPECT_EQ(queue_of(compiled_with(declared.desc, worth_it), 0), 1U);
        import.waits_semaphore = false;
        import.initial_stages = VK_PIPELINE_STAGE_2_HOST_BIT;
        import.initial_access = VK_ACCESS_2_HOST_WRITE_BIT;
        Plan away = compiled_with(declared.desc, worth_it);
        EXPECT_EQ(queue_of(away, 0), 1U);
        EXPECT_TRUE(verify(declared.desc, away).empty());
        // The checker does not take a barrier of one queue for the order of another.
        import.initial_stages = VK_PIPELINE_STAGE_2_COPY_BIT;
        import.initial_access = VK_ACCESS_2_TRANSFER_WRITE_BIT;
        for (Dependency& dependency : away.dependencies) {
            if (dependency.hazard == Hazard::import_entry && dependency.src_stages == VK_PIPELINE_STAGE_2_HOST_BIT) {
                dependency.src_stages = dependency.local_stages = import.initial_stages;
                dependency.src_access = dependency.local_access = import.initial_access;
            }
        }
        EXPECT_FALSE(verify(declared.desc, away).empty());
    }
}

TEST_F(Scheduling, AQueueGetsOnlyWhatItCanDo) {
    GraphBuilder graph;
    Buffer source = graph.create_buffer("source", {.size_bytes = 64});
    Buffer copy = graph.create_buffer("copy", {.size_bytes = 64});
    Image output = graph.import_image("output", color_image(), left_for_host());
    graph.add_pass("fill and copy", PassKind::compute)
        .writes(source, Access::storage_compute)
        .writes(copy, Access::transfer_destination);
    graph.add_pass("opaque", PassKind::graphics).writes(output, Access::color_attachment);
    graph.add_pass("apply", PassKind::graphics)
        .reads(source, Access::storage_fragment)
        .reads(copy, Access::storage_fragment)
        .modifies(output, Access::color_attachment);
    const DeclaredGraph declared = graph.finish();
    const Costs worth_it = costs(2 * ms, 3 * ms, 1 * ms);
    QueueTopology topology = two_queues();
    EXPECT_EQ(queue_of(compiled_with(declared.desc, worth_it, nullptr, topology), 0), 1U);
    topology.queues[1].capabilities = can_compute;
    const Plan plan = compiled_with(declared.desc, worth_it, nullptr, topology);
    EXPECT_EQ(queue_of(plan, 0), 0U);
    EXPECT_EQ(plan.passes[0].queue_reason, QueueReason::only_queue_that_can);
}

TEST_F(Scheduling, AWaitThatHidesNothingIsNotTaken) {
    // A pass that could run elsewhere, in the middle of a chain of graphics passes: moving it would cost two waits.
    GraphBuilder graph;
    Image scene = graph.create_image("scene", color_image());
    Buffer fog = graph.create_buffer("fog", {.size_bytes = 64});
    Buffer exposure = graph.create_buffer("exposure", {.size_bytes = 64});
    Image output = graph.import_image("output", color_image(), left_for_host());
    graph.add_pass("fog", PassKind::compute).writes(fog, Access::storage_compute);
    graph.add_pass("opaque", PassKind::graphics).writes(scene, Access::color_attachment);
    graph.add_pass("apply", PassKind::graphics)
        .reads(fog, Access::storage_fragment)
        .modifies(scene, Access::color_attachment);
    graph.add_pass("exposure", PassKind::compute)
        .reads(scene, Access::sampled_compute)
        .writes(exposure, Access::storage_compute);
    graph.add_pass("tone mapping", PassKind::graphics)
        .reads(scene, Access::sampled_fragment)
        .reads(exposure, Access::storage_fragment)
        .writes(output, Access::color_attachment);
    const DeclaredGraph declared = graph.finish();
    Costs chain;
    chain.of_pass = {{2 * ms, 0}, {3 * ms, 0}, {1 * ms, 0}, {ms / 10, 0}, {ms / 5, 0}};
    const Plan plan = compiled_with(declared.desc, chain);
    EXPECT_EQ(queue_of(plan, 0), 1U);
    EXPECT_EQ(queue_of(plan, 3), 0U);
    EXPECT_EQ(plan.statistics.wait_count, 1U);
}

TEST_F(Scheduling, ReadersOfAFinishedImportDoNotWaitForEachOther) {
    GraphBuilder graph;
    Buffer parameters = graph.import_buffer("parameters", {.size_bytes = 64}, {.read_only = true});
    graph.share_between_queues(parameters);
    Image output = graph.import_image("output", color_image(), left_for_host());
    Buffer fog = graph.create_buffer("fog", {.size_bytes = 64});
    graph.add_pass("fog", PassKind::compute)
        .reads(parameters, Access::uniform_compute)
        .writes(fog, Access::storage_compute);
    graph.add_pass("opaque", PassKind::graphics)
        .reads(parameters, Access::uniform_graphics)
        .writes(output, Access::color_attachment);
    graph.add_pass("apply", PassKind::graphics)
        .reads(fog, Access::storage_fragment)
        .modifies(output, Access::color_attachment);
    const DeclaredGraph declared = graph.finish();
    const Plan plan = compiled_with(declared.desc, costs(2 * ms, 3 * ms, 1 * ms));
    EXPECT_EQ(queue_of(plan, 0), 1U);
    EXPECT_EQ(plan.statistics.wait_count, 1U) << to_text(declared.desc, plan); // apply waits for fog, and that is all
    EXPECT_EQ(plan.decision.overlap_ns, 5 * ms);
}

TEST_F(Scheduling, APlanStaysWhileCostsChangeALittle) {
    const DeclaredGraph declared = graph_.finish();
    // Gain is half of density's time; the threshold 0.1 ms. At 0.26 ms overlap starts ...
    const Plan overlapped = compiled_with(declared.desc, costs(260'000, 3 * ms, 100'000));
    ASSERT_TRUE(overlapped.decision.overlaps);
    // ... at 0.15 ms it would not start, but stays ...
    const Costs fewer = costs(150'000, 3 * ms, 100'000);
    EXPECT_FALSE(compiled_with(declared.desc, fewer).decision.overlaps);
    const Plan kept = compiled_with(declared.desc, fewer, &overlapped);
    EXPECT_TRUE(kept.decision.overlaps);
    EXPECT_TRUE(kept.decision.kept_by_hysteresis);
    EXPECT_EQ(to_text(declared.desc, kept), to_text(declared.desc, overlapped));
    // ... and a serial plan does not start it for that gain either.
    const Plan serial = compiled_with(declared.desc, costs(50'000, 3 * ms, 100'000));
    EXPECT_FALSE(compiled_with(declared.desc, fewer, &serial).decision.overlaps);
    // Where it loses outright (here by a wait longer than what it hides) it goes.
    Costs losing = costs(150'000, 100'000, 100'000);
    losing.cross_queue_ns = 500'000;
    EXPECT_FALSE(compiled_with(declared.desc, losing, &overlapped).decision.overlaps);
}

TEST_F(Scheduling, AThousandFramesOfNoisyCostsKeepOnePlan) {
    const DeclaredGraph declared = graph_.finish();
    std::mt19937 bits(7);
    Plan plan = compiled_with(declared.desc, costs(260'000, 3 * ms, 100'000));
    const std::string first = to_text(declared.desc, plan);
    for (int frame = 0; frame < 1'000; ++frame) {
        const auto noise = [&] { return static_cast<std::int64_t>(bits() % 100'000) - 50'000; };
        plan = compiled_with(declared.desc, costs(200'000 + noise(), 3 * ms + noise(), 100'000 + noise()), &plan);
        ASSERT_EQ(to_text(declared.desc, plan), first) << frame;
    }
}

TEST_F(Scheduling, APreviousPlanOfAnotherFrameIsIgnored) {
    const DeclaredGraph declared = graph_.finish();
    const Costs worth_it = costs(2 * ms, 3 * ms, 1 * ms);
    const Plan fresh = compiled_with(declared.desc, worth_it);
    Plan other = fresh;
    other.passes_hash += 1;
    std::swap(other.passes[0], other.passes[1]);
    Plan broken = fresh; // fits by name, but not in order
    std::reverse(broken.passes.begin(), broken.passes.end());
    Plan twice = fresh;
    twice.passes[1] = twice.passes[0];
    Plan last_twice = fresh;
    last_twice.passes[2] = last_twice.passes[1];
    for (const Plan* previous : {&other, &broken, &twice, &last_twice}) {
        const Plan plan = compiled_with(declared.desc, worth_it, previous);
        EXPECT_EQ(to_text(declared.desc, plan), to_text(declared.desc, fresh));
        EXPECT_FALSE(plan.decision.kept_by_hysteresis);
    }
}

TEST(SchedulingCorpus, OverlapIsNeverLongerThanSerialNorShorterThanTheBound) {
    const std::uint32_t seeds = random_graph_count(2'000);
    std::uint32_t overlapped = 0;
    std::uint32_t chosen = 0;
    for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
        const AnyFrame any = any_frame(seed);
        const DeclaredGraph small = random_frame(seed);
        const GraphDesc& graph = seed % 4 < 2 ? any.graph : small.desc;
        const QueueTopology topology = seed % 4 < 2 ? any.topology : random_topology(seed);
        const Costs costs = random_costs(seed, graph.passes.size(), seed % 2 == 0);
        const auto plan = compile(graph, topology, estimate_memory(graph), {}, costs);
        ASSERT_TRUE(plan.has_value()) << seed;
        ASSERT_TRUE(verify(graph, *plan).empty()) << seed;
        const AsyncDecision& d = plan->decision;
        const std::int64_t makespan = simulate(graph, *plan, costs).makespan_ns;
        ASSERT_GE(makespan, d.lower_bound_ns) << seed;
        overlapped += d.overlaps ? 1 : 0;
        if (d.reason == DecisionReason::overlap_pays) {
            ++chosen;
            ASSERT_EQ(makespan, d.overlap_ns) << seed;
            // Against everything at home: the graphics queue, and where passes were asked for.
            Costs never = costs;
            never.threshold_ns = 1'000 * ms;
            const auto home = compile(graph, topology, estimate_memory(graph), {}, never);
            const bool same_forms =
                std::equal(plan->variants.begin(), plan->variants.end(), home->variants.begin(),
                           [](const VariantDecision& a, const VariantDecision& b) { return a.form == b.form; });
            if (same_forms) { // else another frame
                ASSERT_LE(makespan + std::max<std::int64_t>(d.threshold_ns, 1),
                          simulate(graph, *home, costs).makespan_ns)
                    << seed;
            }
        } else if (!d.overlaps) {
            ASSERT_EQ(makespan, d.serial_ns) << seed;
        }
        // The plan under its own costs, given back, stays what it is.
        const auto again = compile(graph, topology, estimate_memory(graph), {}, costs, &*plan);
        ASSERT_EQ(to_text(graph, *again), to_text(graph, *plan)) << seed;
        ASSERT_FALSE(again->decision.kept_by_hysteresis) << seed;
    }
    std::cout << seeds << " random frames: " << overlapped << " overlap, " << chosen << " of them by choice\n";
    EXPECT_GT(chosen, seeds / 20);
}

} // namespace
} // namespace tyndall::rg::test
