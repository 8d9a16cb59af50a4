// The switch 'poison transients': what nobody wrote is seen, what somebody wrote is kept.
#include <cmath>
#include <cstring>

#include "tests/rendergraph/executor_fixture.hpp"

namespace tyndall::test {
namespace {

using namespace rg;

class Poison : public ExecutorTest {
protected:
    void SetUp() override {
        ExecutorTest::SetUp();
        ExecutorInfo info = executor_info();
        info.poison_transients = true;
        make_executor(std::move(info));
    }

    /// What a 4 x 4 image of 32-bit texels holds after a pass that declares to write it, and does nothing.
    [[nodiscard]] std::uint32_t texel_of_unwritten(VkFormat format, PassKind kind, Access access) {
        const HostBuffer result = read_back_buffer(16 * 4);
        GraphBuilder graph;
        Image image = graph.create_image("image", {.format = format, .extent = {4, 4, 1}});
        Buffer out = import_read_back(graph, "out", result);
        graph.add_pass("nothing", kind).writes(image, access).executes([](PassContext&) {});
        add_copy(graph, "copy", image, out, {4, 4}, 0, 0, format_aspects(format));
        run_bound(graph.finish());
        return result.as<std::uint32_t>()[5];
    }
};

TEST_F(Poison, HalfAnImageThatNobodyWroteIsNan) {
    constexpr VkExtent2D whole = {16, 32};
    constexpr VkExtent2D half = {16, 16};
    const HostBuffer result = read_back_buffer(whole.width * whole.height * sizeof(Texel));
    for (int frame = 0; frame < 3; ++frame) {
        GraphBuilder graph;
        Image first = graph.create_image("first", image_of(whole.width, whole.height));
        Image second = graph.create_image("second", image_of(whole.width, whole.height));
        Image third = graph.create_image("third", image_of(whole.width, whole.height)); // in the first one's memory
        Buffer out = import_read_back(graph, "out", result);
        add_pattern(graph, "whole", first, whole, {0.0F, 0.0F, 3.0F, 4.0F});
        add_accumulate(graph, "whole too", first, second, whole, 1.0F, false);
        add_accumulate(graph, "half", second, third, half, 1.0F, false);
        add_copy(graph, "copy", third, out, whole);
        run_bound(graph.finish());
        const std::span<Texel> texels = result.as<Texel>();
        for (std::uint32_t i = 0; i < texels.size(); ++i) {
            const std::uint32_t row = i / whole.width;
            if (row < half.height) {
                ASSERT_EQ(texels[i],
                          (Texel{static_cast<float>(i % 16) + 2.0F, static_cast<float>(row) + 2.0F, 5.0F, 6.0F}));
            } else {
                ASSERT_TRUE(std::isnan(texels[i][0]) && std::isnan(texels[i][3])) << "texel " << i;
            }
        }
    }
}

TEST_F(Poison, HalfABufferThatNobodyWroteIsNan) {
    constexpr std::uint32_t count = 256;
    const HostBuffer result = read_back_buffer(count * 4);
    GraphBuilder graph;
    Buffer a = graph.create_buffer("a", {.size_bytes = count * 4});
    Buffer b = graph.create_buffer("b", {.size_bytes = count * 4});
    Buffer out = import_read_back(graph, "out", result);
    add_fill(graph, "fill", a, 5);
    add_affine(graph, "half", a, b, 3, 1, count / 2);
    add_affine(graph, "copy", b, out, 1, 0, count);
    run_bound(graph.finish());
    for (std::uint32_t i = 0; i < count; ++i) {
        ASSERT_EQ(result.as<std::uint32_t>()[i], i < count / 2 ? 16U : 0xFFFFFFFFU) << i;
    }
}

// A second writer of a part must not lose what the first wrote elsewhere.
TEST_F(Poison, OnlyBytesAndLayersThatNobodyWroteYetAreFilled) {
    constexpr VkDeviceSize half_bytes = 64;
    constexpr VkExtent2D extent = {8, 8};
    const HostBuffer bytes = read_back_buffer(2 * half_bytes);
    const HostBuffer layer = read_back_buffer(extent.width * extent.height * sizeof(Texel));
    GraphBuilder graph;
    Buffer a = graph.create_buffer("a", {.size_bytes = 2 * half_bytes});
    ImageDesc layers = image_of(extent.width, extent.height);
    layers.layers = 2;
    Image image = graph.create_image("image", layers);
    Buffer out_bytes = import_read_back(graph, "out bytes", bytes);
    Buffer out_layer = import_read_back(graph, "out layer", layer);
    for (std::uint32_t part = 0; part < 2; ++part) {
        const VkDeviceSize offset = part * half_bytes;
        graph.add_pass("bytes " + std::to_string(part), PassKind::transfer)
            .writes(a, Access::transfer_destination, BufferRange{offset, half_bytes})
            .executes([=](PassContext& ctx) {
                // All of the first half, half of the second one.
                ctx.vk().CmdFillBuffer(ctx.cmd(), ctx.buffer(a), offset, half_bytes / (part + 1), part);
            });
        const VkClearColorValue color = {.float32 = {1.0F, 2.0F, 3.0F, static_cast<float>(part)}};
        graph.add_pass("layer " + std::to_string(part), PassKind::transfer)
            .writes(image, Access::transfer_destination, {.range = {0, 1, part, 1}})
            .executes([=](PassContext& ctx) {
                const VkImageSubresourceRange range = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, part, 1};
                ctx.vk().CmdClearColorImage(ctx.cmd(), ctx.image(image), ctx.layout(image), &color, 1, &range);
            });
    }
    add_affine(graph, "copy bytes", a, out_bytes, 1, 0, static_cast<std::uint32_t>(half_bytes / 2));
    add_copy(graph, "copy layer", image, out_layer, extent, 0, 0);
    run_bound(graph.finish());
    const std::span<std::uint32_t> numbers = bytes.as<std::uint32_t>();
    EXPECT_EQ(numbers[0], 0U);
    EXPECT_EQ(numbers[15], 0U);
    EXPECT_EQ(numbers[16], 1U);
    EXPECT_EQ(numbers[31], 0xFFFFFFFFU);
    EXPECT_EQ(layer.as<Texel>()[10], (Texel{1.0F, 2.0F, 3.0F, 0.0F}));
}

TEST_F(Poison, EveryKindOfFormatHasAPattern) {
    const auto as_float = [](std::uint32_t bits) {
        float value = 0.0F;
        std::memcpy(&value, &bits, sizeof value);
        return value;
    };
    EXPECT_EQ(texel_of_unwritten(VK_FORMAT_R8G8B8A8_UNORM, PassKind::compute, Access::storage_compute), 0xFFFF00FFU);
    EXPECT_EQ(texel_of_unwritten(VK_FORMAT_R8G8B8A8_UINT, PassKind::compute, Access::storage_compute), 0xFFFFFFFFU);
    EXPECT_EQ(texel_of_unwritten(VK_FORMAT_R32_SINT, PassKind::compute, Access::storage_compute), 0xFFFFFFFFU);
    EXPECT_EQ(texel_of_unwritten(VK_FORMAT_R16G16_UINT, PassKind::transfer, Access::transfer_destination), 0xFFFFFFFFU);
    EXPECT_EQ(texel_of_unwritten(VK_FORMAT_A2B10G10R10_UINT_PACK32, PassKind::transfer, Access::transfer_destination),
              0xFFFFFFFFU);
    EXPECT_EQ(texel_of_unwritten(VK_FORMAT_R32_UINT, PassKind::compute, Access::storage_compute), 0xFFFFFFFFU);
    EXPECT_TRUE(
        std::isnan(as_float(texel_of_unwritten(VK_FORMAT_R32_SFLOAT, PassKind::compute, Access::storage_compute))));
    const std::uint32_t halves =
        texel_of_unwritten(VK_FORMAT_R16G16_SFLOAT, PassKind::graphics, Access::color_attachment);
    EXPECT_EQ(halves & 0x7C007C00U, 0x7C007C00U);
    EXPECT_NE(halves & 0x03FFU, 0U);
    EXPECT_EQ(as_float(texel_of_unwritten(VK_FORMAT_D32_SFLOAT, PassKind::graphics, Access::depth_attachment)), 0.5F);
}

} // namespace
} // namespace tyndall::test
