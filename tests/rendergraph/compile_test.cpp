// Order, culling, queues and batches, each as a property of small frames.
#include <algorithm>

#include "tests/rendergraph/frames.hpp"

namespace tyndall::rg::test {
namespace {

TEST(Compile, OrderFollowsVersionsNotDeclaration) {
    GraphBuilder graph;
    Buffer data = graph.create_buffer("data", {.size_bytes = 64});
    Buffer out = graph.import_buffer("out", {.size_bytes = 64}, {.has_final = true});
    PassBuilder reader = graph.add_pass("reader", PassKind::compute);
    graph.add_pass("writer", PassKind::compute).writes(data, Access::storage_compute);
    reader.reads(data, Access::storage_compute).writes(out, Access::storage_compute);
    const DeclaredGraph declared = graph.finish();
    const Plan plan = compiled(declared.desc, one_queue());
    EXPECT_LT(place_of(declared.desc, plan, "writer"), place_of(declared.desc, plan, "reader"));
}

TEST(Compile, ReadOfAnOverwrittenVersionRunsBeforeTheOverwrite) {
    GraphBuilder graph;
    Buffer data = graph.create_buffer("data", {.size_bytes = 64});
    Buffer first_out = graph.import_buffer("first out", {.size_bytes = 64}, {.has_final = true});
    Buffer second_out = graph.import_buffer("second out", {.size_bytes = 64}, {.has_final = true});
    graph.add_pass("write one", PassKind::compute).writes(data, Access::storage_compute);
    const Buffer one = data;
    graph.add_pass("write two", PassKind::compute).writes(data, Access::storage_compute);
    graph.add_pass("read two", PassKind::compute)
        .reads(data, Access::storage_compute)
        .writes(second_out, Access::storage_compute);
    graph.add_pass("read one", PassKind::compute)
        .reads(one, Access::storage_compute)
        .writes(first_out, Access::storage_compute);
    const DeclaredGraph declared = graph.finish();
    const Plan plan = compiled(declared.desc, one_queue());
    EXPECT_LT(place_of(declared.desc, plan, "read one"), place_of(declared.desc, plan, "write two"));
}

TEST(Compile, CullsWhatNobodyReadsAndSaysWhy) {
    const DeclaredGraph declared = fog_frame();
    const Plan plan = compiled(declared.desc, one_queue());
    EXPECT_EQ(place_of(declared.desc, plan, "debug"), none);
    ASSERT_EQ(plan.culled_passes.size(), 1U);
    EXPECT_EQ(why_culled(declared.desc, plan.culled_passes[0]), "nothing reads 'debug view'");
    ASSERT_EQ(plan.culled_resources.size(), 1U);
    EXPECT_EQ(declared.desc.resources[plan.culled_resources[0].resource].name, "debug view");
    const Plan everything = compiled(declared.desc, one_queue(), {.culling = false});
    EXPECT_NE(place_of(declared.desc, everything, "debug"), none);
}

TEST(Compile, AChainIntoNothingIsCulledAsAWhole) {
    GraphBuilder graph;
    Buffer a = graph.create_buffer("a", {.size_bytes = 64});
    Buffer b = graph.create_buffer("b", {.size_bytes = 64});
    Buffer out = graph.import_buffer("out", {.size_bytes = 64}, {.has_final = true});
    graph.add_pass("make a", PassKind::compute).writes(a, Access::storage_compute);
    graph.add_pass("a to b", PassKind::compute).reads(a, Access::storage_compute).writes(b, Access::storage_compute);
    graph.add_pass("live", PassKind::compute).writes(out, Access::storage_compute);
    const DeclaredGraph declared = graph.finish();
    const Plan plan = compiled(declared.desc, one_queue());
    ASSERT_EQ(plan.culled_passes.size(), 2U);
    EXPECT_EQ(why_culled(declared.desc, plan.culled_passes[0]), "its consumer 'a to b' is left out");
    EXPECT_EQ(why_culled(declared.desc, plan.culled_passes[1]), "nothing reads 'b'");
}

TEST(Compile, PassesWithASideEffectLive) {
    GraphBuilder graph;
    graph.add_pass("capture", PassKind::compute).has_side_effect("tells a debugger");
    const DeclaredGraph declared = graph.finish();
    const Plan plan = compiled(declared.desc, one_queue());
    ASSERT_EQ(plan.passes.size(), 1U);
    EXPECT_EQ(why_kept(declared.desc, plan.passes[0]), "side effect: tells a debugger");
}

TEST(Compile, OrderThroughACulledPassIsKept) {
    // "second" replaces what "first" wrote; the culled pass between them must not take the hazard with it.
    GraphBuilder graph;
    Buffer data = graph.create_buffer("data", {.size_bytes = 64});
    Buffer out = graph.import_buffer("out", {.size_bytes = 64}, {.has_final = true});
    Buffer other = graph.import_buffer("other", {.size_bytes = 64}, {.has_final = true});
    graph.add_pass("first", PassKind::compute)
        .writes(data, Access::storage_compute)
        .writes(other, Access::storage_compute)
        .on_queue(QueueWish::async_compute);
    graph.add_pass("lost", PassKind::compute).writes(data, Access::storage_compute);
    graph.add_pass("second", PassKind::compute).writes(data, Access::storage_compute);
    graph.add_pass("third", PassKind::compute)
        .reads(data, Access::storage_compute)
        .writes(out, Access::storage_compute);
    const DeclaredGraph declared = graph.finish();
    const Plan plan = compiled(declared.desc, two_queues());
    EXPECT_EQ(place_of(declared.desc, plan, "lost"), none);
    EXPECT_EQ(plan.statistics.wait_count, 1U) << to_text(declared.desc, plan);
}

TEST(Compile, AsyncComputeIsUsedWhereItExists) {
    const DeclaredGraph declared = fog_frame();
    const Plan two = compiled(declared.desc, two_queues());
    for (const PlannedPass& pass : two.passes) {
        const bool asked = declared.desc.passes[pass.pass].wish == QueueWish::async_compute;
        EXPECT_EQ(pass.queue, asked ? 1U : 0U) << declared.desc.passes[pass.pass].name;
    }
    const Plan one = compiled(declared.desc, one_queue());
    for (const PlannedPass& pass : one.passes) {
        EXPECT_EQ(pass.queue, 0U);
    }
    EXPECT_EQ(one.batches.size(), 1U);
    const Plan off = compiled(declared.desc, two_queues(), {.async = false});
    EXPECT_EQ(off.batches.size(), 1U);
}

TEST(Compile, WaitsLookBackwardAndAreFew) {
    const DeclaredGraph declared = fog_frame();
    const Plan plan = compiled(declared.desc, two_queues());
    for (std::uint32_t b = 0; b < plan.batches.size(); ++b) {
        for (const BatchWait& wait : plan.batches[b].waits) {
            EXPECT_LT(wait.batch, b);
            EXPECT_NE(plan.batches[wait.batch].queue, plan.batches[b].queue);
        }
    }
    // Compute waits for the shadow maps, graphics waits for the accumulated fog; nothing else crosses.
    EXPECT_EQ(plan.statistics.wait_count, 2U) << to_text(declared.desc, plan);
}

TEST(Compile, AWaitThatAnotherImpliesIsDropped) {
    GraphBuilder graph;
    Buffer a = graph.create_buffer("a", {.size_bytes = 64});
    Buffer b = graph.create_buffer("b", {.size_bytes = 64});
    Buffer out = graph.import_buffer("out", {.size_bytes = 64}, {.has_final = true});
    graph.add_pass("make a", PassKind::compute).writes(a, Access::storage_compute);
    graph.add_pass("make b", PassKind::compute).writes(b, Access::storage_compute);
    graph.add_pass("use both", PassKind::compute)
        .reads(a, Access::storage_compute)
        .reads(b, Access::storage_compute)
        .writes(out, Access::storage_compute)
        .on_queue(QueueWish::async_compute);
    const DeclaredGraph declared = graph.finish();
    EXPECT_EQ(compiled(declared.desc, two_queues()).statistics.wait_count, 1U);
}

/// A graphics pass, an async one after it, and a graphics pass after both.
TEST(Compile, WhatCameBackThroughAnotherQueueNeedsNoBarrier) {
    GraphBuilder graph;
    Buffer data = graph.create_buffer("data", {.size_bytes = 64});
    Buffer more = graph.create_buffer("more", {.size_bytes = 64});
    Buffer out = graph.import_buffer("out", {.size_bytes = 64}, {.has_final = true});
    graph.add_pass("first", PassKind::compute).writes(data, Access::storage_compute).on_queue(QueueWish::graphics);
    graph.add_pass("beside", PassKind::compute)
        .reads(data, Access::storage_compute)
        .writes(more, Access::storage_compute)
        .on_queue(QueueWish::async_compute);
    graph.add_pass("last", PassKind::compute)
        .reads(data, Access::storage_compute)
        .reads(more, Access::storage_compute)
        .writes(out, Access::storage_compute)
        .on_queue(QueueWish::graphics);
    const DeclaredGraph declared = graph.finish();
    for (const bool full_barriers : {false, true}) {
        const Plan plan = compiled(declared.desc, two_queues(), {.full_barriers = full_barriers});
        const PlannedPass& last = plan.passes[place_of(declared.desc, plan, "last")];
        std::uint32_t of_data = 0;
        for (std::uint32_t i = last.first_barrier; i < last.first_barrier + last.barrier_count; ++i) {
            const Dependency& d = plan.dependencies[i];
            if (d.resource == data.resource) {
                ++of_data;
                EXPECT_EQ(d.local_stages == 0, !full_barriers) << describe(declared.desc, d);
                EXPECT_EQ(d.src_queue, full_barriers ? 0U : 1U); // the queue whose semaphore brings it
                EXPECT_NE(d.src_stages, 0U);                     // whole, for queues that are folded onto one
            }
        }
        EXPECT_EQ(of_data, 1U);
    }
}

TEST(Compile, AWriteAfterReadsNeedsNoBarrierWhereAnotherOrdersThem) {
    for (const bool in_fragment : {false, true}) {
        GraphBuilder graph;
        Buffer a = graph.import_buffer("a", {.size_bytes = 64}, {.has_final = true});
        Buffer b = graph.import_buffer("b", {.size_bytes = 64}, {.has_final = true});
        const Buffer a_before = a;
        // The reader reads in the stage that the barrier of 'b' names, or in another.
        graph.add_pass("read", in_fragment ? PassKind::graphics : PassKind::compute)
            .reads(a_before, in_fragment ? Access::storage_fragment : Access::storage_compute)
            .has_side_effect("test");
        graph.add_pass("make", PassKind::compute).writes(b, Access::storage_compute);
        graph.add_pass("overwrite", PassKind::compute)
            .modifies(b, Access::storage_compute)
            .writes(a, Access::storage_compute);
        const DeclaredGraph declared = graph.finish();
        const Plan plan = compiled(declared.desc, one_queue());
        const PlannedPass& last = plan.passes[place_of(declared.desc, plan, "overwrite")];
        EXPECT_EQ(last.barrier_count, in_fragment ? 2U : 1U) << to_text(declared.desc, plan);
        for (std::uint32_t i = last.first_barrier; i < last.first_barrier + last.barrier_count; ++i) {
            const Dependency& d = plan.dependencies[i];
            EXPECT_EQ(d.dst_access != 0, d.resource == b.resource) << "there is nothing to see after reads";
        }
    }
}

TEST(Compile, ReadsAreMergedIntoOneDependency) {
    GraphBuilder graph;
    Image image = graph.create_image("image", color_image());
    Buffer a = graph.import_buffer("a", {.size_bytes = 64}, {.has_final = true});
    Image b = graph.import_image("b", color_image(), left_for_host());
    graph.add_pass("make", PassKind::compute).writes(image, Access::storage_compute);
    graph.add_pass("read in compute", PassKind::compute)
        .reads(image, Access::sampled_compute)
        .writes(a, Access::storage_compute);
    graph.add_pass("read in fragment", PassKind::graphics)
        .reads(image, Access::sampled_fragment)
        .writes(b, Access::color_attachment);
    const DeclaredGraph declared = graph.finish();
    const Plan plan = compiled(declared.desc, one_queue());
    const auto of_image = std::count_if(plan.dependencies.begin(), plan.dependencies.end(), [&](const Dependency& d) {
        return d.resource == image.resource && d.hazard == Hazard::read_after_write;
    });
    EXPECT_EQ(of_image, 1);
    const auto found = std::find_if(plan.dependencies.begin(), plan.dependencies.end(), [&](const Dependency& d) {
        return d.resource == image.resource && d.hazard == Hazard::read_after_write;
    });
    ASSERT_NE(found, plan.dependencies.end());
    EXPECT_EQ(found->dst_stages, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT);
}

TEST(Compile, OwnershipIsTransferredOnceAndDiscardsTransferNothing) {
    const DeclaredGraph declared = fog_frame();
    const Plan plan = compiled(declared.desc, two_queues());
    const std::uint32_t accumulated = 8;
    ASSERT_EQ(declared.desc.resources[accumulated].name, "accumulated");
    std::uint32_t transfers = 0;
    for (const Dependency& d : plan.dependencies) {
        if (d.transfers_ownership) {
            ++transfers;
            EXPECT_EQ(d.resource, accumulated) << describe(declared.desc, d);
            EXPECT_EQ(d.src_family, 1U);
            EXPECT_EQ(d.dst_family, 0U);
        }
    }
    EXPECT_EQ(transfers, 1U); // the cascades are read by both families at once: concurrent
    EXPECT_TRUE(plan.placements[1].concurrent);
    std::uint32_t releases = 0;
    for (const Batch& batch : plan.batches) {
        for (const std::uint32_t d : batch.releases) {
            releases += plan.dependencies[d].transfers_ownership ? 1 : 0;
        }
    }
    EXPECT_EQ(releases, 1U);
    const Plan same_family = compiled(declared.desc, two_queues_one_family());
    for (const Dependency& d : same_family.dependencies) {
        EXPECT_FALSE(d.transfers_ownership);
    }
}

TEST(Compile, AttachmentsStoreOnlyWhatIsReadLater) {
    GraphBuilder graph;
    Image depth = graph.create_image("depth", {.format = VK_FORMAT_D32_SFLOAT, .extent = {64, 64, 1}});
    Image color = graph.import_image("color", color_image(), left_for_host());
    graph.add_pass("draw", PassKind::graphics)
        .writes(depth, Access::depth_attachment, {.clear = clear_depth(0.0F)})
        .writes(color, Access::color_attachment);
    graph.add_pass("draw more", PassKind::graphics).modifies(color, Access::color_attachment);
    const DeclaredGraph declared = graph.finish();
    const Plan plan = compiled(declared.desc, one_queue());
    ASSERT_EQ(plan.attachments.size(), 3U);
    EXPECT_EQ(plan.attachments[0].load, VK_ATTACHMENT_LOAD_OP_CLEAR);
    EXPECT_EQ(plan.attachments[0].store, VK_ATTACHMENT_STORE_OP_DONT_CARE);
    EXPECT_EQ(plan.attachments[1].load, VK_ATTACHMENT_LOAD_OP_DONT_CARE);
    EXPECT_EQ(plan.attachments[1].store, VK_ATTACHMENT_STORE_OP_STORE);
    EXPECT_EQ(plan.attachments[2].load, VK_ATTACHMENT_LOAD_OP_LOAD);
    EXPECT_EQ(plan.attachments[2].store, VK_ATTACHMENT_STORE_OP_STORE);
}

TEST(Compile, SubresourcesAreTrackedApart) {
    // Each mip is made from the one above: one dependency a step, on that mip alone.
    GraphBuilder graph;
    Image chain = graph.create_image("chain", {.format = VK_FORMAT_R32_SFLOAT, .extent = {64, 64, 1}, .mips = 4});
    Buffer out = graph.import_buffer("out", {.size_bytes = 64}, {.has_final = true});
    graph.add_pass("mip 0", PassKind::compute).writes(chain, Access::storage_compute, {.range = {.mip_count = 1}});
    for (std::uint32_t mip = 1; mip < 4; ++mip) {
        const Image source = chain;
        graph.add_pass("mip " + std::to_string(mip), PassKind::compute)
            .reads(source, Access::sampled_compute, {.base_mip = mip - 1, .mip_count = 1})
            .writes(chain, Access::storage_compute, {.range = {.base_mip = mip, .mip_count = 1}});
    }
    graph.add_pass("use", PassKind::compute).reads(chain, Access::sampled_compute).writes(out, Access::storage_compute);
    const DeclaredGraph declared = graph.finish();
    const Plan plan = compiled(declared.desc, one_queue());
    for (std::uint32_t mip = 1; mip < 4; ++mip) {
        const PlannedPass& pass = plan.passes[place_of(declared.desc, plan, "mip " + std::to_string(mip))];
        std::uint32_t after_write = 0;
        for (std::uint32_t d = pass.first_barrier; d < pass.first_barrier + pass.barrier_count; ++d) {
            if (plan.dependencies[d].hazard == Hazard::read_after_write) {
                ++after_write;
                EXPECT_EQ(plan.dependencies[d].image_range.base_mip, mip - 1);
                EXPECT_EQ(plan.dependencies[d].image_range.mip_count, 1U);
            }
        }
        EXPECT_EQ(after_write, 1U);
    }
    // Mips 0 to 2 were already made readable; only the last one is left for the final reader.
    const PlannedPass& use = plan.passes[place_of(declared.desc, plan, "use")];
    ASSERT_EQ(use.barrier_count, 1U) << to_text(declared.desc, plan);
    EXPECT_EQ(plan.dependencies[use.first_barrier].image_range.base_mip, 3U);
}

TEST(Compile, BufferRangesThatDoNotMeetNeedNothing) {
    GraphBuilder graph;
    Buffer data = graph.create_buffer("data", {.size_bytes = 128});
    Buffer out = graph.import_buffer("out", {.size_bytes = 64}, {.has_final = true});
    graph.add_pass("low", PassKind::compute).writes(data, Access::storage_compute, {0, 64});
    graph.add_pass("high", PassKind::compute).writes(data, Access::storage_compute, {64, 64});
    graph.add_pass("use low", PassKind::compute)
        .reads(data, Access::storage_compute, {0, 64})
        .writes(out, Access::storage_compute);
    graph.add_pass("use high", PassKind::compute)
        .reads(data, Access::storage_compute, {64, 64})
        .modifies(out, Access::storage_compute);
    const DeclaredGraph declared = graph.finish();
    const Plan plan = compiled(declared.desc, one_queue());
    const PlannedPass& high = plan.passes[place_of(declared.desc, plan, "high")];
    EXPECT_EQ(high.barrier_count, 0U);
    const PlannedPass& use_low = plan.passes[place_of(declared.desc, plan, "use low")];
    ASSERT_EQ(use_low.barrier_count, 1U);
    EXPECT_EQ(plan.dependencies[use_low.first_barrier].buffer_range, (BufferRange{0, 64}));
}

TEST(Compile, TheSameInputGivesTheSamePlan) {
    const DeclaredGraph first = fog_frame();
    const DeclaredGraph second = fog_frame();
    EXPECT_EQ(to_text(first.desc, compiled(first.desc, two_queues())),
              to_text(second.desc, compiled(second.desc, two_queues())));
}

TEST(Compile, AFrameOfNothingIsAPlanOfNothing) {
    GraphBuilder graph;
    const DeclaredGraph declared = graph.finish();
    const Plan plan = compiled(declared.desc, two_queues());
    EXPECT_TRUE(plan.passes.empty());
    EXPECT_TRUE(plan.batches.empty());
}

} // namespace
} // namespace tyndall::rg::test
