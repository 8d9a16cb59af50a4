// The executor on a driver: numbers and pixels that only come out right when barriers, layouts, memory and roles are.
#include <cstring>

#include "tests/rendergraph/executor_fixture.hpp"

namespace tyndall::test {
namespace {

using namespace rg;

TEST_F(ExecutorTest, ComputeChainThroughTransientBuffersGivesTheNumbers) {
    constexpr std::uint32_t count = 1000;
    const HostBuffer result = read_back_buffer(count * 4);
    GraphBuilder graph;
    Buffer a = graph.create_buffer("a", {.size_bytes = count * 4});
    Buffer b = graph.create_buffer("b", {.size_bytes = count * 4});
    Buffer out = import_read_back(graph, "out", result);
    add_fill(graph, "fill", a, 5);
    add_affine(graph, "times 3 plus 1", a, b, 3, 1, count);
    add_affine(graph, "times 2 plus 7", b, out, 2, 7, count);
    run_bound(graph.finish());
    for (const std::uint32_t value : result.as<std::uint32_t>()) {
        ASSERT_EQ(value, (5U * 3U + 1U) * 2U + 7U);
    }
}

TEST_F(ExecutorTest, ImageGoesFromStorageToSampledToAttachmentToCopy) {
    constexpr VkExtent2D extent = {37, 21};
    const HostBuffer result = read_back_buffer(extent.width * extent.height * sizeof(Texel));
    GraphBuilder graph;
    Image pattern = graph.create_image("pattern", image_of(extent.width, extent.height));
    Image target = graph.create_image("target", image_of(extent.width, extent.height));
    Buffer out = import_read_back(graph, "out", result);
    add_pattern(graph, "pattern", pattern, extent, {0.0F, 0.0F, 0.25F, -3.0F});
    add_double(graph, "double", pattern, target);
    add_copy(graph, "copy", target, out, extent);
    run_bound(graph.finish());
    const std::span<Texel> texels = result.as<Texel>();
    for (std::uint32_t y = 0; y < extent.height; ++y) {
        for (std::uint32_t x = 0; x < extent.width; ++x) {
            const Texel expected = {2.0F * static_cast<float>(x), 2.0F * static_cast<float>(y), 0.5F, -6.0F};
            ASSERT_EQ(texels[y * extent.width + x], expected) << "at " << x << ", " << y;
        }
    }
}

TEST_F(ExecutorTest, TransientsThatShareMemoryKeepTheirContent) {
    constexpr VkExtent2D extent = {64, 64};
    const HostBuffer result = read_back_buffer(extent.width * extent.height * sizeof(Texel));
    GraphBuilder graph;
    std::array<Image, 5> chain;
    for (std::size_t i = 0; i < chain.size(); ++i) {
        chain[i] = graph.create_image("link " + std::to_string(i), image_of(extent.width, extent.height));
    }
    Buffer out = import_read_back(graph, "out", result);
    add_pattern(graph, "pattern", chain[0], extent, {0.0F, 0.0F, 1.0F, 2.0F});
    for (std::size_t i = 1; i < chain.size(); ++i) {
        add_accumulate(graph, "add " + std::to_string(i), chain[i - 1], chain[i], extent, 1.0F, false);
    }
    add_copy(graph, "copy", chain.back(), out, extent);
    const DeclaredGraph declared = graph.finish();
    const Plan plan = compile(declared.desc);
    EXPECT_LT(plan.statistics.transient_bytes, plan.statistics.transient_bytes_unaliased);
    for (int frame = 0; frame < 3; ++frame) {
        const auto error = execute(declared, plan, bindings_);
        ASSERT_FALSE(error.has_value()) << error->message;
        const std::span<Texel> texels = result.as<Texel>();
        for (std::uint32_t i = 0; i < texels.size(); ++i) {
            const std::uint32_t row = i / 64;
            const Texel expected = {static_cast<float>(i % 64) + 4.0F, static_cast<float>(row) + 4.0F, 5.0F, 6.0F};
            ASSERT_EQ(texels[i], expected) << "texel " << i << ", frame " << frame;
        }
    }
}

TEST_F(ExecutorTest, HistoryHoldsWhatTheFrameBeforeWrote) {
    constexpr VkExtent2D extent = {16, 16};
    const HostBuffer result = read_back_buffer(extent.width * extent.height * sizeof(Texel));
    const auto frame = [&](float increment) {
        GraphBuilder graph;
        Image sum = graph.create_image("sum", image_of(extent.width, extent.height));
        const Image before = graph.history_of(sum);
        Buffer out = import_read_back(graph, "out", result);
        add_accumulate(graph, "accumulate", before, sum, extent, increment, true);
        add_copy(graph, "copy", sum, out, extent);
        run_bound(graph.finish());
        return result.as<Texel>()[extent.width + 3][0];
    };
    EXPECT_EQ(frame(1.0F), 1.0F) << "the first frame has no history";
    EXPECT_EQ(frame(2.0F), 3.0F);
    EXPECT_EQ(frame(4.0F), 7.0F);
    EXPECT_EQ(frame(8.0F), 15.0F);
    EXPECT_EQ(frame(16.0F), 31.0F);
    executor().invalidate_history();
    EXPECT_EQ(frame(32.0F), 32.0F) << "the host said that history is lost";
    EXPECT_EQ(frame(64.0F), 96.0F);
}

TEST_F(ExecutorTest, HistoryIsInvalidAfterAChangeOfTheResourceOrAFrameWithoutIt) {
    const HostBuffer result = read_back_buffer(64 * 64 * sizeof(Texel));
    const auto frame = [&](std::uint32_t size) {
        GraphBuilder graph;
        Image sum = graph.create_image("sum", image_of(size, size));
        const Image before = graph.history_of(sum);
        Buffer out = import_read_back(graph, "out", result);
        add_accumulate(graph, "accumulate", before, sum, {size, size}, 1.0F, true);
        add_copy(graph, "copy", sum, out, {size, size});
        run_bound(graph.finish());
        return result.as<Texel>()[0][0];
    };
    EXPECT_EQ(frame(16), 1.0F);
    EXPECT_EQ(frame(16), 2.0F);
    EXPECT_EQ(frame(32), 1.0F) << "another size";
    EXPECT_EQ(frame(32), 2.0F);
    GraphBuilder other;
    Buffer out = import_read_back(other, "out", result);
    add_fill(other, "fill", out, 0);
    run_bound(other.finish());
    EXPECT_EQ(frame(32), 1.0F) << "a frame lay between";
}

TEST_F(ExecutorTest, ImportedImageIsLeftInTheLayoutThatTheHostWants) {
    constexpr VkExtent2D extent = {16, 16};
    const ImageDesc desc = image_of(extent.width, extent.height);
    const HostImage image =
        host_image(desc, VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_SAMPLED_BIT);
    const HostBuffer result = read_back_buffer(extent.width * extent.height * sizeof(Texel));
    {
        GraphBuilder graph;
        Image target = graph.import_image("target", desc,
                                          {.has_final = true,
                                           .final_layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                           .final_stages = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                           .final_access = VK_ACCESS_2_TRANSFER_READ_BIT});
        bindings_.push_back({.resource = target.resource, .image = image.image});
        add_pattern(graph, "pattern", target, extent, {1.0F, 2.0F, 3.0F, 4.0F});
        run_bound(graph.finish());
    }
    GraphBuilder graph;
    const Image source = graph.import_image("source", desc,
                                            {.initial_layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                             .initial_stages = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                             .read_only = true});
    bindings_.push_back({.resource = source.resource, .image = image.image});
    Buffer out = import_read_back(graph, "out", result);
    add_copy(graph, "copy", source, out, extent);
    run_bound(graph.finish());
    EXPECT_EQ(result.as<Texel>()[0], (Texel{1.0F, 2.0F, 3.0F, 4.0F}));
    EXPECT_EQ(result.as<Texel>()[extent.width * 3 + 5], (Texel{6.0F, 5.0F, 3.0F, 4.0F}));
    executor().release_import(image.image);
}

TEST_F(ExecutorTest, LayersAreClearedAndDrawnSeparately) {
    constexpr std::uint32_t layers = 4;
    constexpr VkExtent2D extent = {8, 8};
    const VkDeviceSize bytes = extent.width * extent.height * sizeof(Texel);
    std::vector<HostBuffer> results;
    GraphBuilder graph;
    ImageDesc desc = image_of(extent.width, extent.height);
    desc.layers = layers;
    Image array = graph.create_image("array", desc);
    for (std::uint32_t layer = 0; layer < layers; ++layer) {
        const float value = static_cast<float>(layer + 1);
        graph.add_pass("clear " + std::to_string(layer), PassKind::graphics)
            .writes(array, Access::color_attachment,
                    {.range = {0, 1, layer, 1}, .clear = clear_color(value, 0.0F, 0.5F, 1.0F)});
    }
    for (std::uint32_t layer = 0; layer < layers; ++layer) {
        results.push_back(read_back_buffer(bytes));
        Buffer out = import_read_back(graph, "out " + std::to_string(layer), results.back());
        add_copy(graph, "copy " + std::to_string(layer), array, out, extent, 0, layer);
    }
    run_bound(graph.finish());
    for (std::uint32_t layer = 0; layer < layers; ++layer) {
        for (const Texel& texel : results[layer].as<Texel>()) {
            ASSERT_EQ(texel, (Texel{static_cast<float>(layer + 1), 0.0F, 0.5F, 1.0F})) << "layer " << layer;
        }
    }
}

TEST_F(ExecutorTest, EachMipIsMadeFromTheOneAbove) {
    constexpr std::uint32_t mips = 4;
    constexpr std::uint32_t size = 32;
    const HostBuffer result = read_back_buffer((size >> (mips - 1)) * (size >> (mips - 1)) * sizeof(Texel));
    GraphBuilder graph;
    ImageDesc desc = image_of(size, size);
    desc.mips = mips;
    Image chain = graph.create_image("chain", desc);
    graph.add_pass("top", PassKind::graphics)
        .writes(chain, Access::color_attachment, {.range = {0, 1}, .clear = clear_color(1.0F, 2.0F, 3.0F, 4.0F)});
    for (std::uint32_t mip = 1; mip < mips; ++mip) {
        const Image above = chain;
        add_accumulate(graph, "mip " + std::to_string(mip), above, chain, {size >> mip, size >> mip}, 10.0F, false,
                       {mip - 1, 1}, {.range = {mip, 1}});
    }
    Buffer out = import_read_back(graph, "out", result);
    add_copy(graph, "copy", chain, out, {size >> (mips - 1), size >> (mips - 1)}, mips - 1);
    run_bound(graph.finish());
    for (const Texel& texel : result.as<Texel>()) {
        ASSERT_EQ(texel, (Texel{31.0F, 32.0F, 33.0F, 34.0F}));
    }
}

TEST_F(ExecutorTest, DepthAndResolveAttachmentsAreRendered) {
    constexpr VkExtent2D extent = {16, 16};
    const HostBuffer result = read_back_buffer(extent.width * extent.height * sizeof(Texel));
    GraphBuilder graph;
    ImageDesc multisampled = image_of(extent.width, extent.height);
    multisampled.samples = VK_SAMPLE_COUNT_4_BIT;
    ImageDesc depth_desc = multisampled;
    depth_desc.format = VK_FORMAT_D32_SFLOAT;
    Image color = graph.create_image("color", multisampled);
    Image depth = graph.create_image("depth", depth_desc);
    Image resolved = graph.create_image("resolved", image_of(extent.width, extent.height));
    Buffer out = import_read_back(graph, "out", result);
    graph.add_pass("draw", PassKind::graphics)
        .writes(color, Access::color_attachment, {.clear = clear_color(0.25F, 0.5F, 0.75F, 1.0F)})
        .writes(depth, Access::depth_attachment, {.clear = clear_depth(0.0F)})
        .writes(resolved, Access::resolve_attachment);
    add_copy(graph, "copy", resolved, out, extent);
    run_bound(graph.finish());
    for (const Texel& texel : result.as<Texel>()) {
        ASSERT_EQ(texel, (Texel{0.25F, 0.5F, 0.75F, 1.0F}));
    }
}

TEST_F(ExecutorTest, TwoQueuePlanGivesTheSameNumbersFrameAfterFrame) {
    constexpr std::uint32_t count = 4096;
    const HostBuffer result = read_back_buffer(count * 4);
    // One side of a fork asks for async compute: with two logical queues the data crosses over and back.
    GraphBuilder graph;
    Buffer start = graph.create_buffer("start", {.size_bytes = count * 4});
    Buffer left = graph.create_buffer("left", {.size_bytes = count * 4});
    Buffer right = graph.create_buffer("right", {.size_bytes = count * 4});
    Buffer far_right = graph.create_buffer("far right", {.size_bytes = count * 4});
    Buffer out = import_read_back(graph, "out", result);
    add_fill(graph, "fill", start, 4);
    add_affine(graph, "left", start, left, 2, 1, count);
    add_affine(graph, "right", start, right, 3, 1, count).on_queue(QueueWish::async_compute);
    add_affine(graph, "far right", right, far_right, 5, 1, count).on_queue(QueueWish::async_compute);
    add_affine(graph, "join", far_right, out, 7, 1, count).reads(left, Access::storage_compute);
    const DeclaredGraph declared = graph.finish();
    const Plan plan = compile(declared.desc);
    const bool two_queues = mode() == Mode::folded || mode() == Mode::semaphores;
    EXPECT_EQ(plan.batches.size() > 1, two_queues);
    for (int frame = 0; frame < 4; ++frame) {
        const auto error = execute(declared, plan, bindings_);
        ASSERT_FALSE(error.has_value()) << error->message;
        for (const std::uint32_t value : result.as<std::uint32_t>()) {
            ASSERT_EQ(value, ((4U * 3U + 1U) * 5U + 1U) * 7U + 1U);
        }
        std::memset(result.mapped, 0, result.size_bytes);
    }
}

TEST_F(ExecutorTest, AsyncImageWorkCrossesQueuesWithItsLayouts) {
    constexpr VkExtent2D extent = {32, 32};
    const HostBuffer result = read_back_buffer(extent.width * extent.height * sizeof(Texel));
    const auto declare = [&] {
        GraphBuilder graph;
        Image pattern = graph.create_image("pattern", image_of(extent.width, extent.height));
        Image fog = graph.create_image("fog", image_of(extent.width, extent.height));
        const Image fog_before = graph.history_of(fog);
        Image target = graph.create_image("target", image_of(extent.width, extent.height));
        Buffer out = import_read_back(graph, "out", result);
        add_pattern(graph, "pattern", pattern, extent, {0.0F, 0.0F, 1.0F, 1.0F});
        static_cast<void>(pattern);
        add_accumulate(graph, "fog", fog_before, fog, extent, 1.0F, true).on_queue(QueueWish::async_compute);
        add_double(graph, "apply", fog, target);
        add_copy(graph, "copy", target, out, extent);
        return graph.finish();
    };
    for (int frame = 1; frame <= 4; ++frame) {
        run_bound(declare());
        ASSERT_EQ(result.as<Texel>()[77][2], 2.0F * static_cast<float>(frame));
    }
}

TEST_F(ExecutorTest, FullBarriersAndNoAliasingGiveTheSameNumbers) {
    constexpr std::uint32_t count = 512;
    const HostBuffer result = read_back_buffer(count * 4);
    GraphBuilder graph;
    Buffer a = graph.create_buffer("a", {.size_bytes = count * 4});
    Buffer b = graph.create_buffer("b", {.size_bytes = count * 4});
    Buffer out = import_read_back(graph, "out", result);
    add_fill(graph, "fill", a, 9);
    add_affine(graph, "first", a, b, 3, 1, count).on_queue(QueueWish::async_compute);
    add_affine(graph, "second", b, out, 2, 7, count);
    const DeclaredGraph declared = graph.finish();
    const Plan plan = compile(declared.desc, {.aliasing = false, .full_barriers = true});
    const auto error = execute(declared, plan, bindings_);
    ASSERT_FALSE(error.has_value()) << error->message;
    EXPECT_EQ(result.as<std::uint32_t>()[count - 1], 63U);
}

} // namespace
} // namespace tyndall::test
