// The checker on single faults that random mutants seldom make, and from one frame to the next.
#include <array>

#include "rendergraph/verify.hpp"
#include "tests/rendergraph/frames.hpp"

namespace tyndall::rg::test {
namespace {

std::vector<ViolationCode> codes(const std::vector<Violation>& violations) {
    std::vector<ViolationCode> out;
    for (const Violation& violation : violations) {
        out.push_back(violation.code);
    }
    return out;
}
bool has(const std::vector<Violation>& violations, ViolationCode code) {
    const std::vector<ViolationCode> all = codes(violations);
    return std::find(all.begin(), all.end(), code) != all.end();
}

TEST(VerifyFrames, OverlapOnlyWhereTheExecutorOrdersThem) {
    const DeclaredGraph declared = fog_frame();
    const Plan plan = compiled(declared.desc, two_queues());
    const std::array<PlannedFrame, 2> frames = {{{&declared.desc, &plan}, {&declared.desc, &plan}}};
    EXPECT_TRUE(verify_sequence(frames).empty());
    EXPECT_TRUE(has(verify_sequence(frames, BetweenFrames::nothing), ViolationCode::race));
    EXPECT_TRUE(verify_sequence({frames.data(), 1}, BetweenFrames::nothing).empty());
}

TEST(VerifyFrames, APlanMayFollowAnother) {
    const DeclaredGraph declared = fog_frame();
    const Plan overlap = compiled(declared.desc, two_queues());
    const Plan serial = compiled(declared.desc, two_queues(), {.aliasing = false, .async = false});
    const std::array<PlannedFrame, 4> frames = {
        {{&declared.desc, &overlap}, {&declared.desc, &serial}, {&declared.desc, &overlap}, {&declared.desc, &serial}}};
    EXPECT_TRUE(verify_sequence(frames, BetweenFrames::executor).empty());
    EXPECT_TRUE(has(verify_sequence(frames, BetweenFrames::nothing), ViolationCode::race));
}

TEST(VerifyFrames, AHistoryThatAnotherFamilyWroteIsNotReadWithoutATransfer) {
    GraphBuilder graph;
    Image current = graph.create_image("current", color_image());
    Image previous = graph.history_of(current);
    Image output = graph.import_image("output", color_image(), left_for_host());
    graph.add_pass("accumulate", PassKind::compute)
        .writes(current, Access::storage_compute)
        .on_queue(QueueWish::async_compute);
    graph.add_pass("show", PassKind::graphics)
        .reads(previous, Access::sampled_fragment)
        .writes(output, Access::color_attachment);
    const DeclaredGraph declared = graph.finish();
    Plan plan = compiled(declared.desc, two_queues());
    ASSERT_TRUE(verify(declared.desc, plan).empty());
    for (Placement& placement : plan.placements) {
        placement.concurrent = false;
    }
    const std::array<PlannedFrame, 2> frames = {{{&declared.desc, &plan}, {&declared.desc, &plan}}};
    EXPECT_TRUE(verify_sequence({frames.data(), 1}).empty()); // nobody owns it yet
    EXPECT_TRUE(has(verify_sequence(frames), ViolationCode::ownership));
}

/// An import with semaphores on both ends, copied through a transfer queue.
class HostSemaphores : public testing::Test {
protected:
    HostSemaphores() {
        ImportDesc import = left_for_host();
        import.waits_semaphore = import.signals_semaphore = true;
        import.final_stages = import.final_access = 0;
        GraphBuilder graph;
        Image image = graph.import_image("image", color_image(), import);
        graph.add_pass("draw", PassKind::graphics).writes(image, Access::color_attachment);
        graph_ = graph.finish().desc;
        plan_ = compiled(graph_, one_queue());
    }
    GraphDesc graph_;
    Plan plan_;
};

TEST_F(HostSemaphores, AreWaitedForBeforeTheFirstUse) {
    ASSERT_TRUE(verify(graph_, plan_).empty());
    plan_.batches[0].waits_imports.clear();
    EXPECT_TRUE(has(verify(graph_, plan_), ViolationCode::race));
}

TEST_F(HostSemaphores, AreSignalled) {
    plan_.batches[0].signals_imports.clear();
    EXPECT_TRUE(has(verify(graph_, plan_), ViolationCode::exit_state));
}

/// One pass draws over what another drew.
class Attachments : public testing::Test {
protected:
    Attachments() {
        GraphBuilder graph;
        Image image = graph.import_image("image", color_image(), left_for_host());
        graph.add_pass("first", PassKind::graphics)
            .writes(image, Access::color_attachment, {.clear = clear_color(0, 0, 0, 1)});
        graph.add_pass("second", PassKind::graphics).modifies(image, Access::color_attachment);
        graph_ = graph.finish().desc;
        plan_ = compiled(graph_, one_queue());
    }
    GraphDesc graph_;
    Plan plan_;
};

TEST_F(Attachments, ThatAreDrawnOverAreStoredAndLoaded) {
    ASSERT_EQ(plan_.attachments.size(), 2U);
    ASSERT_TRUE(verify(graph_, plan_).empty());
    Plan broken = plan_;
    broken.attachments[0].store = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    EXPECT_TRUE(has(verify(graph_, broken), ViolationCode::undefined_content));
    broken = plan_;
    broken.attachments[1].load = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    EXPECT_TRUE(has(verify(graph_, broken), ViolationCode::undefined_content));
    broken = plan_;
    broken.attachments[1].store = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    EXPECT_TRUE(has(verify(graph_, broken), ViolationCode::exit_state));
    broken = plan_;
    broken.attachments[0].load = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    EXPECT_TRUE(has(verify(graph_, broken), ViolationCode::undefined_content));
    broken = plan_;
    broken.passes[1].attachment_count = 0;
    EXPECT_TRUE(has(verify(graph_, broken), ViolationCode::malformed));
}

TEST(VerifyForm, StageMasksFitTheirQueue) {
    const DeclaredGraph declared = fog_frame();
    QueueTopology topology = two_queues();
    Plan plan = compiled(declared.desc, topology);
    const auto async = std::find_if(plan.passes.begin(), plan.passes.end(),
                                    [](const PlannedPass& p) { return p.queue == 1 && p.barrier_count > 0; });
    ASSERT_NE(async, plan.passes.end());
    plan.dependencies[async->first_barrier].dst_stages |= VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT;
    EXPECT_TRUE(has(verify(declared.desc, plan), ViolationCode::queue_cannot));
    // A transfer queue has no shaders at all.
    plan = compiled(declared.desc, topology);
    plan.topology.queues[1].capabilities = can_transfer;
    EXPECT_TRUE(has(verify(declared.desc, plan), ViolationCode::queue_cannot));
    // Nor may a submission wait with stages that its queue lacks.
    plan = compiled(declared.desc, topology);
    for (Batch& batch : plan.batches) {
        for (BatchWait& wait : batch.waits) {
            wait.stages |= batch.queue == 1 ? VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT : 0;
        }
    }
    EXPECT_TRUE(has(verify(declared.desc, plan), ViolationCode::queue_cannot));
}

TEST(VerifyForm, TellsWhatIsMalformed) {
    const DeclaredGraph declared = fog_frame();
    const Plan plan = compiled(declared.desc, two_queues());
    const auto malformed = [&](auto&& break_it) {
        Plan broken = plan;
        break_it(broken);
        return codes(verify(declared.desc, broken)) == std::vector{ViolationCode::malformed};
    };
    EXPECT_TRUE(malformed([](Plan& p) { p.passes.back().pass = p.passes.front().pass; }));
    EXPECT_TRUE(malformed([](Plan& p) { p.culled_passes.clear(); }));
    EXPECT_TRUE(malformed([](Plan& p) { p.batches.pop_back(); }));
    EXPECT_TRUE(malformed([](Plan& p) { p.placements.pop_back(); }));
    EXPECT_TRUE(malformed([](Plan& p) { p.dependencies[0].resource = none; }));
    EXPECT_TRUE(malformed([](Plan& p) { p.dependencies[0].image_range.base_mip = 99; }));
    EXPECT_TRUE(malformed([](Plan& p) { p.dependencies[0].consumer = 1000; }));
    EXPECT_TRUE(malformed([](Plan& p) { p.attachments[0].access = none; }));
    EXPECT_TRUE(malformed([](Plan& p) { p.placements[1].size_bytes = 0; }));
    EXPECT_TRUE(malformed([](Plan& p) { p.passes[0].first_barrier = none; }));
    EXPECT_TRUE(malformed([](Plan& p) { p.exit_barrier_count = none; }));
    Plan around = plan; // the sum of offset and size is small again
    around.placements[1].offset_bytes = ~VkDeviceSize{0};
    EXPECT_TRUE(has(verify(declared.desc, around), ViolationCode::memory_overlap));
    Plan outside = plan;
    for (Placement& placement : outside.placements) {
        placement.offset_bytes += placement.kind == PlacementKind::heap ? VkDeviceSize{1} << 40U : 0;
    }
    EXPECT_TRUE(has(verify(declared.desc, outside), ViolationCode::memory_overlap));
}

} // namespace
} // namespace tyndall::rg::test
