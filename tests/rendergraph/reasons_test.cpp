// Nothing in a plan lacks a reason, and each reason is one that a reader can check.
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "rendergraph/explain.hpp"
#include "rendergraph/json.hpp"
#include "rendergraph/optimality.hpp"
#include "rendergraph/reasons.hpp"
#include "tests/rendergraph/any_frame.hpp"
#include "tests/rendergraph/frames.hpp"
#include "tests/rendergraph/random_costs.hpp"

namespace tyndall::rg::test {
namespace {

std::size_t count_of(const std::string& text, const std::string& what) {
    std::size_t count = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) {
        ++count;
    }
    return count;
}

/// A reason is a sentence: words, and no part of it left empty.
void expect_reason(const std::string& reason) {
    EXPECT_GE(reason.size(), 8U) << reason;
    EXPECT_EQ(reason.find("''"), std::string::npos) << reason;
    EXPECT_FALSE(reason.ends_with(": ") || reason.ends_with(" ")) << reason;
}

/// The recorded reason is the one that the plan itself shows.
void expect_memory_reason(const GraphDesc& graph, const Plan& plan, const PlanOrder& order, std::uint32_t r) {
    const Placement& placement = plan.placements[r];
    const std::string& name = graph.resources[r].name;
    EXPECT_EQ(placement.reason == MemoryReason::host_owns, graph.resources[r].import != none) << name;
    EXPECT_EQ(placement.reason == MemoryReason::outlives_frame, placement.kind == PlacementKind::history) << name;
    EXPECT_EQ(placement.reason == MemoryReason::takes_over, placement.shares_with != none) << name;
    if (placement.kind != PlacementKind::heap) {
        return;
    }
    std::uint32_t could_share = 0;
    for (std::uint32_t other = 0; other < plan.placements.size(); ++other) {
        const Placement& its = plan.placements[other];
        const bool same_heap = its.kind == PlacementKind::heap && its.heap == placement.heap;
        could_share += other != r && same_heap && (order.resource_before(other, r) || order.resource_before(r, other));
    }
    EXPECT_EQ(placement.could_share, could_share) << name;
    const bool shares = !order.sharers(plan, r).empty();
    EXPECT_EQ(placement.reason == MemoryReason::takes_over || placement.reason == MemoryReason::is_taken_over, shares)
        << name;
    EXPECT_EQ(placement.reason == MemoryReason::never_idle,
              could_share == 0 && placement.reason != MemoryReason::sharing_off)
        << name;
}

void expect_all_reasons(const GraphDesc& graph, const Plan& plan) {
    const PlanOrder order(graph, plan);
    std::set<std::uint32_t> passes;
    for (const PlannedPass& pass : plan.passes) {
        passes.insert(pass.pass);
        expect_reason(why_kept(graph, pass));
        expect_reason(why_queue(pass));
        EXPECT_FALSE(pass.queue_reason == QueueReason::default_graphics && pass.queue != 0);
    }
    for (const CulledPass& pass : plan.culled_passes) {
        passes.insert(pass.pass);
        expect_reason(why_culled(graph, pass));
    }
    EXPECT_EQ(passes.size(), graph.passes.size()) << "a pass is neither kept nor left out";
    for (const Dependency& dependency : plan.dependencies) {
        const std::string reason = describe(graph, dependency);
        expect_reason(reason);
        EXPECT_FALSE(name_of(dependency.hazard).empty());
        EXPECT_NE(reason.find(" -> "), std::string::npos) << reason;
    }
    std::size_t waits = 0;
    std::size_t releases = 0;
    for (std::uint32_t b = 0; b < plan.batches.size(); ++b) {
        for (const BatchWait& wait : plan.batches[b].waits) {
            ++waits;
            const std::string reason = why_wait(graph, plan, order, b, wait);
            expect_reason(reason);
            EXPECT_EQ(reason.find("later passes"), std::string::npos) << "a wait whose need is not in the plan";
        }
        releases += plan.batches[b].releases.size();
    }
    std::size_t placed = 0;
    for (std::uint32_t r = 0; r < graph.resources.size(); ++r) {
        const std::string reason = why_memory(graph, plan, order, r);
        expect_reason(reason);
        placed += plan.placements[r].kind == PlacementKind::unplaced ? 0 : 1;
        if (plan.placements[r].shares_with != none) {
            EXPECT_NE(reason.find(" after those of "), std::string::npos) << reason;
            EXPECT_NE(reason.find("'" + graph.resources[plan.placements[r].shares_with].name + "'"), std::string::npos);
        }
        expect_memory_reason(graph, plan, order, r);
        for (const std::uint32_t other : order.sharers(plan, r)) {
            EXPECT_TRUE(order.resource_before(r, other) || order.resource_before(other, r))
                << graph.resources[r].name << " and " << graph.resources[other].name << " share bytes at once";
        }
    }
    const std::string text = explain_table(graph, plan);
    std::size_t barriers = 0;
    std::set<std::uint32_t> listed;
    for (const PlannedPass& pass : plan.passes) {
        barriers += pass.barrier_count;
        for (std::uint32_t d = pass.first_barrier; d < pass.first_barrier + pass.barrier_count; ++d) {
            listed.insert(d);
        }
    }
    for (const Batch& batch : plan.batches) {
        listed.insert(batch.releases.begin(), batch.releases.end());
    }
    for (std::uint32_t d = 0; d < plan.exit_barrier_count; ++d) {
        listed.insert(plan.first_exit_barrier + d);
    }
    EXPECT_EQ(count_of(text, "\n    barrier: "), barriers);
    EXPECT_EQ(listed.size(), plan.dependencies.size()) << "a dependency is neither before a pass nor at an end";
    EXPECT_EQ(count_of(text, " waits for batch "), waits);
    EXPECT_EQ(count_of(text, ") ends with: "), releases);
    EXPECT_EQ(count_of(text, "\nthe frame ends with: "), plan.exit_barrier_count);
    EXPECT_EQ(count_of(text, "\nmemory of '"), placed);
    EXPECT_EQ(count_of(text, "' is not created: "), plan.culled_resources.size());
    EXPECT_EQ(count_of(text, "left out: "), plan.culled_passes.size());
    EXPECT_EQ(count_of(text, "\nceiling "), 1U);
}

TEST(Reasons, NothingInAPlanLacksOne) {
    const std::uint32_t count = random_graph_count(400);
    std::size_t waits = 0;
    std::size_t shared = 0;
    for (std::uint32_t seed = 0; seed < count && !::testing::Test::HasFailure(); ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const AnyFrame made = any_frame(seed);
        const auto plan = compile(made.graph, made.topology, estimate_memory(made.graph));
        ASSERT_TRUE(plan);
        expect_all_reasons(made.graph, *plan);
        const auto by_costs = plan_of(made);
        ASSERT_TRUE(by_costs);
        expect_all_reasons(made.graph, *by_costs);
        waits += plan->statistics.wait_count;
        for (const Placement& placement : plan->placements) {
            shared += placement.shares_with != none ? 1 : 0;
        }
    }
    EXPECT_GT(waits, 0U);
    EXPECT_GT(shared, 0U);
}

TEST(Reasons, OfASideEffectWithoutAName) {
    GraphBuilder graph;
    graph.add_pass("print", PassKind::compute).has_side_effect("");
    const DeclaredGraph declared = graph.finish();
    expect_all_reasons(declared.desc, compiled(declared.desc, one_queue()));
}

TEST(Reasons, OfTheCorpusAndOfTheSampleFrames) {
    std::size_t frames = 0;
    for (const char* folder : {TYNDALL_CORPUS_DIR, TYNDALL_SAMPLE_FRAMES}) {
        for (const auto& entry : std::filesystem::directory_iterator(folder)) {
            SCOPED_TRACE(entry.path().string());
            std::ifstream file(entry.path());
            std::stringstream text;
            text << file.rdbuf();
            const auto frame = frame_from_json(text.str());
            ASSERT_TRUE(frame) << to_text(frame.error());
            const auto plan = compile(frame->graph, frame->topology, estimate_memory(frame->graph), {}, frame->costs);
            ASSERT_TRUE(plan);
            expect_all_reasons(frame->graph, *plan);
            ++frames;
        }
    }
    EXPECT_GT(frames, 3U);
}

TEST(Reasons, WhereEachOptimisationIsSwitchedOff) {
    const DeclaredGraph fog = fog_frame();
    for (const CompileOptions& options :
         {CompileOptions{.culling = false}, CompileOptions{.aliasing = false}, CompileOptions{.async = false},
          CompileOptions{.reordering = false}, CompileOptions{.full_barriers = true}}) {
        expect_all_reasons(fog.desc, compiled(fog.desc, two_queues(), options));
    }
}

TEST(Reasons, OfRefusedSharing) {
    const DeclaredGraph fog = fog_frame();
    const auto reasons_of = [&](const CompileOptions& options) {
        std::set<MemoryReason> reasons;
        const Plan plan = compiled(fog.desc, one_queue(), options);
        for (const Placement& placement : plan.placements) {
            reasons.insert(placement.reason);
        }
        return reasons;
    };
    using enum MemoryReason;
    EXPECT_EQ(reasons_of({}),
              (std::set{not_created, host_owns, outlives_frame, takes_over, is_taken_over, never_idle, better_apart}));
    EXPECT_EQ(reasons_of({.aliasing = false}), (std::set{not_created, host_owns, outlives_frame, sharing_off}));
    const Plan plan = compiled(fog.desc, one_queue(), {.aliasing = false});
    EXPECT_EQ(why_memory(fog.desc, plan, PlanOrder(fog.desc, plan), 1), "alone: sharing memory is switched off");
}

TEST(Reasons, TheDecisionInOneLine) {
    AsyncDecision decision{.overlaps = true,
                           .reason = DecisionReason::overlap_pays,
                           .serial_ns = 5'000'000,
                           .overlap_ns = 4'780'400,
                           .lower_bound_ns = 4'590'000,
                           .ceiling_ns = 410'000,
                           .threshold_ns = 100'000};
    EXPECT_EQ(describe(decision), "ceiling 0.41 ms, predicted 0.22 ms, threshold 0.10 ms: overlap");
    decision.kept_by_hysteresis = true;
    EXPECT_EQ(describe(decision),
              "ceiling 0.41 ms, predicted 0.22 ms, threshold 0.10 ms: overlap, kept from the frame before");
    EXPECT_EQ(describe(AsyncDecision{.overlap_ns = 123'456'789}),
              "ceiling 0.00 ms, predicted -123.46 ms, threshold 0.00 ms: serial, there is one queue");
}

TEST(Reasons, Units) {
    EXPECT_EQ(milliseconds_text(0), "0.00 ms");
    EXPECT_EQ(milliseconds_text(1'234'999), "1.23 ms");
    EXPECT_EQ(milliseconds_text(-1'235'000), "-1.24 ms");
    EXPECT_EQ(mebibytes_text(0), "0.00 MiB");
    EXPECT_EQ(mebibytes_text((VkDeviceSize{1} << 20U) - 1), "1.00 MiB");
    EXPECT_EQ(mebibytes_text(VkDeviceSize{198} << 20U | VkDeviceSize{1} << 19U), "198.50 MiB");
}

TEST(Optimality, FiguresOfTheFogFrameAgainstTheirBounds) {
    const DeclaredGraph fog = fog_frame();
    const Plan plan = compiled(fog.desc, two_queues());
    const Optimality figures = optimality(fog.desc, plan, simulate(fog.desc, plan, {}));
    EXPECT_EQ(figures.transient_bytes, plan.statistics.transient_bytes);
    EXPECT_GE(figures.transient_bytes, figures.transient_bound_bytes);
    EXPECT_GE(figures.transient_bytes_unaliased, figures.transient_bytes);
    EXPECT_GE(figures.makespan_ns, figures.makespan_bound_ns);
    EXPECT_GT(figures.makespan_bound_ns, 0);
    EXPECT_EQ(figures.barrier_count, plan.dependencies.size());
    EXPECT_EQ(figures.wait_count, plan.statistics.wait_count);
    EXPECT_LE(figures.barrier_call_count, plan.passes.size() + plan.batches.size() + 1);
    EXPECT_GT(figures.history_bytes, 0U);
    const std::string text = to_text(Optimality{.transient_bytes = 110U << 20U,
                                                .transient_bytes_unaliased = 200U << 20U,
                                                .transient_bound_bytes = 100U << 20U,
                                                .makespan_ns = 2'000'000,
                                                .makespan_bound_ns = 2'000'000,
                                                .serial_ns = 3'000'000,
                                                .barrier_count = 4,
                                                .barrier_call_count = 3,
                                                .transition_count = 2,
                                                .ownership_count = 1,
                                                .batch_count = 5,
                                                .wait_count = 6});
    EXPECT_EQ(text, "transient memory 110.00 MiB, at least 100.00 MiB are needed, 10.0 % over; without sharing "
                    "200.00 MiB\n"
                    "frame 2.00 ms predicted, on these queues at least 2.00 ms, met; on one queue 3.00 ms\n"
                    "4 barriers in 3 calls, 2 change a layout, 1 change the owner; 5 submissions, 6 waits between "
                    "queues\n");
}

} // namespace
} // namespace tyndall::rg::test
