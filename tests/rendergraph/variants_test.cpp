// Alternative forms: cull by depth (waits for the pre-pass, lights less) or overlap (runs beside it, lights more).
#include <algorithm>

#include "rendergraph/refine.hpp"
#include "rendergraph/simulate.hpp"
#include "rendergraph/verify.hpp"
#include "tests/rendergraph/frames.hpp"

namespace tyndall::rg::test {
namespace {

constexpr std::int64_t ms = 1'000'000;

class Variants : public testing::Test {
protected:
    enum Pass : std::uint32_t { prepass, opaque, reduce, cull_by_depth, light_few, light_all, apply };

    Variants() {
        Image output = graph_.import_image("output", color_image(), left_for_host());
        Image depth = graph_.create_image("depth", {.format = VK_FORMAT_D32_SFLOAT, .extent = {64, 64, 1}});
        Image color = graph_.create_image("color", color_image());
        Image far = graph_.create_image("farthest depth", color_image(16, 16));
        Buffer list = graph_.create_buffer("visible froxels", {.size_bytes = 4096});
        Buffer fog = graph_.create_buffer("fog", {.size_bytes = 8192});
        graph_.add_pass("depth pre-pass", PassKind::graphics)
            .writes(depth, Access::depth_attachment, {.clear = clear_depth(0.0F)});
        graph_.add_pass("opaque", PassKind::graphics)
            .reads(depth, Access::depth_attachment)
            .writes(color, Access::color_attachment);
        variant_ = graph_.add_variant("froxel culling");
        graph_.begin_form(variant_, "by depth");
        graph_.add_pass("reduce depth", PassKind::compute)
            .reads(depth, Access::sampled_compute)
            .writes(far, Access::storage_compute);
        graph_.add_pass("cull froxels", PassKind::compute)
            .reads(far, Access::sampled_compute)
            .writes(list, Access::storage_compute);
        Buffer few = fog;
        graph_.add_pass("light visible froxels", PassKind::compute)
            .reads(list, Access::storage_compute)
            .writes(few, Access::storage_compute);
        graph_.begin_form(variant_, "overlap");
        Buffer all = fog;
        graph_.add_pass("light all froxels", PassKind::compute).writes(all, Access::storage_compute);
        graph_.end_form();
        fog = either(few, all);
        graph_.add_pass("apply fog", PassKind::graphics)
            .reads(fog, Access::storage_fragment)
            .reads(color, Access::sampled_fragment)
            .writes(output, Access::color_attachment);
        declared_ = graph_.finish();
    }
    /// Lighting all froxels takes `all_ns`, the visible ones 1 ms; the pre-pass 3 ms, opaque work 1 ms.
    static Costs costs(std::int64_t all_ns) {
        Costs costs;
        costs.of_pass = {{3 * ms, 0}, {ms, 0}, {ms / 5, 0}, {ms / 10, 0}, {ms, 0}, {all_ns, 0}, {ms / 2, 0}};
        return costs;
    }
    Plan compiled_with(const Costs& costs, const QueueTopology& topology, const Plan* previous = nullptr,
                       const CompileOptions& options = {}) {
        auto plan = compile(declared_.desc, topology, estimate_memory(declared_.desc), options, costs, previous);
        EXPECT_TRUE(plan.has_value()) << (plan ? "" : to_text(plan.error()));
        const auto violations = verify(declared_.desc, *plan);
        EXPECT_TRUE(violations.empty()) << violations.front().message;
        return *plan;
    }
    static bool runs(const Plan& plan, std::uint32_t pass) {
        return std::any_of(plan.passes.begin(), plan.passes.end(),
                           [&](const PlannedPass& planned) { return planned.pass == pass; });
    }

    GraphBuilder graph_;
    DeclaredGraph declared_;
    std::uint32_t variant_ = none;
};

TEST_F(Variants, OneQueueKeepsTheFormWithLessWork) {
    const Plan plan = compiled_with(costs(2 * ms), one_queue());
    ASSERT_EQ(plan.variants.size(), 1U);
    EXPECT_EQ(plan.variants[0].form, 0U);
    EXPECT_EQ(plan.variants[0].reason, VariantReason::shortest_frame);
    // 3 + 1 + 0.5 ms of graphics, and 0.2 + 0.1 + 1 by depth against 2 for all.
    EXPECT_EQ(plan.variants[0].predicted_ns, (std::vector<std::int64_t>{5'800'000, 6'500'000}));
    EXPECT_TRUE(runs(plan, light_few));
    EXPECT_FALSE(runs(plan, light_all));
    const auto culled = std::find_if(plan.culled_passes.begin(), plan.culled_passes.end(),
                                     [](const CulledPass& pass) { return pass.pass == light_all; });
    ASSERT_NE(culled, plan.culled_passes.end());
    EXPECT_EQ(culled->reason, CullReason::other_form);
    EXPECT_EQ(why_culled(declared_.desc, *culled), "another form of 'froxel culling' is kept");
}

TEST_F(Variants, TwoQueuesKeepTheFormThatOverlaps) {
    // By depth waits for the pre-pass and shares the rest of the frame; all froxels run beside everything.
    const Plan plan = compiled_with(costs(3 * ms / 2), two_queues());
    EXPECT_EQ(plan.variants[0].form, 1U);
    EXPECT_TRUE(plan.decision.overlaps);
    EXPECT_TRUE(runs(plan, light_all));
    EXPECT_FALSE(runs(plan, cull_by_depth));
    EXPECT_LT(plan.variants[0].predicted_ns[1], plan.variants[0].predicted_ns[0]);
    EXPECT_EQ(plan.variants[0].predicted_ns[1], simulate(declared_.desc, plan, costs(3 * ms / 2)).makespan_ns);
    // "farthest depth" belongs to the other form only.
    const auto unused = std::find_if(plan.culled_resources.begin(), plan.culled_resources.end(),
                                     [](const CulledResource& r) { return r.resource == 3; });
    ASSERT_NE(unused, plan.culled_resources.end());
    EXPECT_EQ(unused->reason, CullReason::all_passes_culled);
    // Where lighting all froxels is dear enough, culling by depth pays even so.
    EXPECT_EQ(compiled_with(costs(9 * ms), two_queues()).variants[0].form, 0U);
}

TEST_F(Variants, AFormStaysWhileAnotherGainsLessThanTheThreshold) {
    const Plan by_depth = compiled_with(costs(2 * ms), one_queue());
    ASSERT_EQ(by_depth.variants[0].form, 0U);
    // All froxels would now save 0.1 ms of 5.8; the threshold is 2 %, 0.116 ms.
    const Plan kept = compiled_with(costs(1'200'000), one_queue(), &by_depth);
    EXPECT_EQ(kept.variants[0].form, 0U);
    EXPECT_EQ(kept.variants[0].reason, VariantReason::kept_by_hysteresis);
    EXPECT_EQ(compiled_with(costs(1'200'000), one_queue()).variants[0].form, 1U);
    EXPECT_EQ(compiled_with(costs(1'100'000), one_queue(), &by_depth).variants[0].form, 1U);
}

TEST_F(Variants, WithoutMeasurementsTheFirstFormIsKept) {
    const Plan plan = compiled_with({}, one_queue());
    EXPECT_EQ(plan.variants[0].form, 0U);
    EXPECT_EQ(plan.variants[0].reason, VariantReason::nothing_measured);
}

TEST_F(Variants, TheOtherFormGoesEvenWithCullingOff) {
    const Plan plan = compiled_with(costs(2 * ms), one_queue(), nullptr, {.culling = false});
    EXPECT_FALSE(runs(plan, light_all));
    EXPECT_EQ(plan.passes.size(), 6U);
}

TEST_F(Variants, RefiningKeepsTheForm) {
    Costs any_gain = costs(3 * ms / 2);
    any_gain.threshold_ns = 0;
    any_gain.threshold_permille = 0;
    const auto refined = refine(declared_.desc, two_queues(), estimate_memory(declared_.desc), {}, any_gain);
    ASSERT_TRUE(refined.has_value());
    EXPECT_TRUE(refined->shortest);
    EXPECT_EQ(refined->plan.variants[0].form, 1U);
    EXPECT_TRUE(verify(declared_.desc, refined->plan).empty());
}

TEST_F(Variants, TheCheckerKnowsOnlyTheKeptForm) {
    Plan plan = compiled_with(costs(2 * ms), one_queue());
    plan.variants[0].form = 1; // the plan runs the passes of form 0
    ASSERT_FALSE(verify(declared_.desc, plan).empty());
    EXPECT_EQ(verify(declared_.desc, plan)[0].message, "a pass of a form that is not kept is planned");
    plan.variants.clear();
    EXPECT_EQ(verify(declared_.desc, plan)[0].message, "the plan does not say which form of each variant it has");
}

TEST_F(Variants, AFormMayHaveNoPasses) {
    GraphBuilder graph;
    Buffer out = graph.import_buffer("out", {.size_bytes = 64}, {.has_final = true});
    Buffer list = graph.create_buffer("list", {.size_bytes = 64});
    graph.add_pass("clear", PassKind::compute).writes(list, Access::storage_compute);
    const std::uint32_t variant = graph.add_variant("culling");
    graph.begin_form(variant, "cull");
    Buffer culled = list;
    graph.add_pass("cull", PassKind::compute).modifies(culled, Access::storage_compute);
    graph.begin_form(variant, "none");
    graph.end_form();
    list = either(culled, list);
    graph.add_pass("use", PassKind::compute).reads(list, Access::storage_compute).writes(out, Access::storage_compute);
    declared_ = graph.finish();
    Costs costs;
    costs.of_pass = {{ms, 0}, {ms, 0}, {ms, 0}};
    const Plan plan = compiled_with(costs, one_queue());
    EXPECT_EQ(plan.variants[0].form, 1U);
    EXPECT_EQ(plan.passes.size(), 2U);
}

TEST_F(Variants, AMistakeInAnyFormIsAMistakeOfTheFrame) {
    GraphBuilder graph;
    Buffer out = graph.import_buffer("out", {.size_bytes = 64}, {.has_final = true});
    Buffer never = graph.create_buffer("never written", {.size_bytes = 64});
    const std::uint32_t variant = graph.add_variant("choice");
    graph.begin_form(variant, "good");
    Buffer good = out;
    graph.add_pass("good pass", PassKind::compute).writes(good, Access::storage_compute);
    graph.begin_form(variant, "bad");
    Buffer bad = out;
    graph.add_pass("bad pass", PassKind::compute)
        .reads(never, Access::storage_compute)
        .writes(bad, Access::storage_compute);
    graph.end_form();
    const DeclaredGraph declared = graph.finish();
    const auto plan = compile(declared.desc, one_queue(), estimate_memory(declared.desc));
    ASSERT_FALSE(plan.has_value());
    ASSERT_EQ(plan.error().size(), 1U);
    EXPECT_EQ(plan.error()[0].code, DiagnosticCode::read_of_unwritten);
    GraphBuilder empty;
    static_cast<void>(empty.add_variant("nothing"));
    const DeclaredGraph without = empty.finish();
    const auto refused = compile(without.desc, one_queue(), estimate_memory(without.desc));
    ASSERT_FALSE(refused.has_value());
    EXPECT_EQ(refused.error()[0].message, "Variant 'nothing' has no form; give it at least one");
}

} // namespace
} // namespace tyndall::rg::test
