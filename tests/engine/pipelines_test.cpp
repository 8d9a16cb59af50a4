// Compute and graphics pipelines do what their descriptions say, read back and compared with numbers.
#include <array>
#include <cstring>

#include <gmock/gmock.h>

#include "engine/pipelines.hpp"
#include "engine/read_back.hpp"
#include "spirv/test_affine.h"
#include "spirv/test_triangle.h"
#include "spirv/test_two_sources.h"
#include "tests/engine/device_fixture.hpp"

namespace tyndall::engine {
namespace {

constexpr std::uint32_t bits(float value) {
    return std::bit_cast<std::uint32_t>(value);
}

TEST_F(DeviceTest, ComputeMapsEachValue) {
    constexpr std::uint32_t count = 1000;
    const std::array bindings = {
        VkDescriptorSetLayoutBinding{0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr}};
    const auto set = create_set_layout(device(), bindings, true);
    ASSERT_TRUE(set.has_value());
    const std::array sets = {set->get()};
    const auto layout = create_pipeline_layout(device(), sets, 8, VK_SHADER_STAGE_COMPUTE_BIT);
    ASSERT_TRUE(layout.has_value());
    const std::array constants = {SpecializationConstant{0, 64}, SpecializationConstant{1, bits(3.0F)}};
    const auto pipeline = create_compute_pipeline(device(), VK_NULL_HANDLE, layout->get(), test_affine, constants);
    ASSERT_TRUE(pipeline.has_value()) << pipeline.error().message;

    const Buffer values = mapped_buffer(count * sizeof(float), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    for (std::uint32_t i = 0; i < count; ++i) {
        values.mapped_as<float>()[i] = static_cast<float>(i);
    }
    OneTimeCommands work = commands();
    vk().CmdBindPipeline(work.cmd(), VK_PIPELINE_BIND_POINT_COMPUTE, pipeline->get());
    const VkDescriptorBufferInfo buffer{values.handle(), 0, VK_WHOLE_SIZE};
    const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                     .dstBinding = 0,
                                     .descriptorCount = 1,
                                     .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                     .pBufferInfo = &buffer};
    vk().CmdPushDescriptorSetKHR(work.cmd(), VK_PIPELINE_BIND_POINT_COMPUTE, layout->get(), 0, 1, &write);
    const std::array<std::uint32_t, 2> push = {bits(0.5F), count - 1}; // the last one stays as it is
    vk().CmdPushConstants(work.cmd(), layout->get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, 8, push.data());
    vk().CmdDispatch(work.cmd(), (count + 63) / 64, 1, 1);
    ASSERT_TRUE(work.finish().has_value());
    for (std::uint32_t i = 0; i + 1 < count; ++i) {
        ASSERT_EQ(values.mapped_as<float>()[i], 3.0F * static_cast<float>(i) + 0.5F) << i;
    }
    EXPECT_EQ(values.mapped_as<float>()[count - 1], static_cast<float>(count - 1));
}

TEST_F(DeviceTest, WordsThatAreNoShaderAreRefusedBeforeTheDriverSeesThem) {
    const std::array<std::uint32_t, 5> words = {};
    const std::string said = "A shader module cannot be read: The words do not begin as a SPIR-V module of this "
                             "machine's byte order";
    const auto compute = create_compute_pipeline(device(), VK_NULL_HANDLE, VK_NULL_HANDLE, words);
    ASSERT_FALSE(compute.has_value());
    EXPECT_EQ(compute.error().message, said);
    const auto graphics =
        create_graphics_pipeline(device(), VK_NULL_HANDLE, {.vertex_spirv = test_triangle, .fragment_spirv = words});
    ASSERT_FALSE(graphics.has_value());
    EXPECT_EQ(graphics.error().message, said);
}

/// A 64 x 64 target with depth, and what is drawn into it.
class Triangle : public DeviceTest {
protected:
    static constexpr std::uint32_t side = 64;

    void SetUp() override {
        DeviceTest::SetUp();
        ASSERT_FALSE(HasFatalFailure());
        color_ = DeviceImage::create(device(),
                                     {.format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                      .extent = {side, side, 1},
                                      .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT})
                     .value();
        depth_ = DeviceImage::create(
                     device(), {.format = VK_FORMAT_D32_SFLOAT,
                                .extent = {side, side, 1},
                                .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT})
                     .value();
        layout_ = create_pipeline_layout(device(), {}, 4, VK_SHADER_STAGE_VERTEX_BIT).value();
        info_.layout = layout_.get();
        info_.vertex_spirv = test_triangle;
        info_.fragment_spirv = test_two_sources;
        info_.constants = constants_;
        info_.color_formats = formats_;
        info_.depth_format = VK_FORMAT_D32_SFLOAT;
    }
    void TearDown() override {
        color_ = {};
        depth_ = {};
        layout_ = {};
        DeviceTest::TearDown();
    }

    /// Draws at depth 0.5 over (0.25, 0.25, 0.25, 0.25) and the given depth; returns the colours, row by row.
    std::vector<std::array<float, 4>> draw(float depth_there, VkCullModeFlags dynamic_cull = VK_CULL_MODE_NONE) {
        const auto pipeline = create_graphics_pipeline(device(), VK_NULL_HANDLE, info_);
        EXPECT_TRUE(pipeline.has_value());
        OneTimeCommands work = commands();
        transition(work.cmd(), color_.handle(), VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
        transition(work.cmd(), depth_.handle(), VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
        const VkRenderingAttachmentInfo color{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                              .imageView = color_.view(),
                                              .imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                                              .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                              .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                              .clearValue = {.color = {{0.25F, 0.25F, 0.25F, 0.25F}}}};
        VkRenderingAttachmentInfo depth = color;
        depth.imageView = depth_.view();
        depth.imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;
        depth.clearValue = {.depthStencil = {depth_there, 0}};
        const VkRenderingInfo rendering{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                                        .renderArea = {{0, 0}, {side, side}},
                                        .layerCount = 1,
                                        .colorAttachmentCount = 1,
                                        .pColorAttachments = &color,
                                        .pDepthAttachment = &depth};
        vk().CmdBeginRendering(work.cmd(), &rendering);
        const VkViewport viewport{0.0F, 0.0F, side, side, 0.0F, 1.0F};
        const VkRect2D scissor{{0, 0}, {side, side}};
        vk().CmdSetViewport(work.cmd(), 0, 1, &viewport);
        vk().CmdSetScissor(work.cmd(), 0, 1, &scissor);
        if (info_.dynamic_culling) {
            vk().CmdSetCullMode(work.cmd(), dynamic_cull);
            vk().CmdSetFrontFace(work.cmd(), VK_FRONT_FACE_COUNTER_CLOCKWISE);
        }
        vk().CmdBindPipeline(work.cmd(), VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline->get());
        const float at = 0.5F;
        vk().CmdPushConstants(work.cmd(), layout_.get(), VK_SHADER_STAGE_VERTEX_BIT, 0, 4, &at);
        vk().CmdDraw(work.cmd(), 3, 1, 0, 0);
        vk().CmdEndRendering(work.cmd());
        EXPECT_TRUE(work.finish().has_value());
        const auto bytes = read_image(device(), color_.handle(),
                                      {.format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                       .extent = {side, side, 1},
                                       .layout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL});
        std::vector<std::array<float, 4>> pixels(side * side);
        EXPECT_TRUE(bytes.has_value());
        std::memcpy(pixels.data(), bytes->data(), bytes->size());
        return pixels;
    }
    static std::size_t covered(const std::vector<std::array<float, 4>>& pixels) {
        const std::array<float, 4> background = {0.25F, 0.25F, 0.25F, 0.25F};
        return static_cast<std::size_t>(
            std::count_if(pixels.begin(), pixels.end(), [&](const auto& pixel) { return pixel != background; }));
    }

    std::array<SpecializationConstant, 3> constants_ = {SpecializationConstant{0, bits(0.5F)},
                                                        SpecializationConstant{1, bits(2.0F)},
                                                        SpecializationConstant{2, bits(0.5F)}};
    std::array<VkFormat, 1> formats_ = {VK_FORMAT_R32G32B32A32_SFLOAT};
    DeviceImage color_;
    DeviceImage depth_;
    PipelineLayout layout_;
    GraphicsPipelineInfo info_;
};

// Pixel centres above the diagonal: 63 + 62 + ... = 2016; the 64 centres on it may fall to either side, whole.
constexpr std::size_t half_without_diagonal = 2016;
constexpr std::size_t half_with_diagonal = 2016 + 64;

TEST_F(Triangle, CoversItsHalfWithItsColour) {
    const auto pixels = draw(0.0F);
    EXPECT_THAT(covered(pixels), testing::AnyOf(half_without_diagonal, half_with_diagonal));
    EXPECT_EQ(pixels.front(), (std::array{0.5F, 2.0F, 0.0F, 1.0F})) << "top left, and nothing clamped";
    EXPECT_EQ(pixels.back(), (std::array{0.25F, 0.25F, 0.25F, 0.25F}));
}

TEST_F(Triangle, DepthTestIsReverse) {
    info_.depth_test = info_.depth_write = true;
    EXPECT_GE(covered(draw(0.4F)), half_without_diagonal) << "nearer than what is there";
    const auto depth = read_image(device(), depth_.handle(),
                                  {.format = VK_FORMAT_D32_SFLOAT,
                                   .extent = {side, side, 1},
                                   .layout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL});
    ASSERT_TRUE(depth.has_value());
    float written = 0.0F;
    std::memcpy(&written, depth->data(), sizeof(written));
    EXPECT_EQ(written, 0.5F);
    EXPECT_EQ(covered(draw(0.6F)), 0U) << "behind what is there";
}

TEST_F(Triangle, CullModeIsFixedOrDynamic) {
    // In framebuffer coordinates (y down) the corners run top left, bottom left, top right: counter-clockwise.
    info_.cull = VK_CULL_MODE_BACK_BIT;
    EXPECT_GE(covered(draw(0.0F)), half_without_diagonal);
    info_.cull = VK_CULL_MODE_FRONT_BIT;
    EXPECT_EQ(covered(draw(0.0F)), 0U);
    info_.dynamic_culling = true;
    EXPECT_GE(covered(draw(0.0F, VK_CULL_MODE_BACK_BIT)), half_without_diagonal);
    EXPECT_EQ(covered(draw(0.0F, VK_CULL_MODE_FRONT_BIT)), 0U);
}

TEST_F(Triangle, DualSourceBlendingWeighsWhatIsThere) {
    if (!device().info().dual_source_blending) {
        GTEST_SKIP() << "the device has no dual-source blending";
    }
    constexpr VkColorComponentFlags rgba = 15;
    const std::array blends = {
        VkPipelineColorBlendAttachmentState{VK_TRUE, VK_BLEND_FACTOR_ONE, VK_BLEND_FACTOR_SRC1_COLOR, VK_BLEND_OP_ADD,
                                            VK_BLEND_FACTOR_ZERO, VK_BLEND_FACTOR_ONE, VK_BLEND_OP_ADD, rgba}};
    info_.blends = blends;
    const auto pixels = draw(0.0F);
    // colour + weight * what was there: 0.5 + 0.5 * 0.25, 2 + 0.5 * 0.25, 0.5 * 0.25; alpha kept
    EXPECT_EQ(pixels.front(), (std::array{0.625F, 2.125F, 0.125F, 0.25F}));
}

TEST_F(Triangle, WithoutFragmentShaderOnlyDepthIsWritten) {
    info_.fragment_spirv = {};
    info_.depth_test = info_.depth_write = true;
    EXPECT_EQ(info_.color_formats.size(), 1U);
    const std::array<VkPipelineColorBlendAttachmentState, 1> untouched = {};
    info_.blends = untouched; // write mask 0
    EXPECT_EQ(covered(draw(0.0F)), 0U);
    const auto depth = read_image(device(), depth_.handle(),
                                  {.format = VK_FORMAT_D32_SFLOAT,
                                   .extent = {side, side, 1},
                                   .layout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL});
    ASSERT_TRUE(depth.has_value());
    float written = 0.0F;
    std::memcpy(&written, depth->data(), sizeof(written));
    EXPECT_EQ(written, 0.5F);
}

TEST_F(DeviceTest, MorePushDescriptorsThanTheDeviceHasAreAnError) {
    const std::array bindings = {VkDescriptorSetLayoutBinding{
        0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, device().info().max_push_descriptors + 1, VK_SHADER_STAGE_ALL, nullptr}};
    const auto set = create_set_layout(device(), bindings, true);
    ASSERT_FALSE(set.has_value());
    EXPECT_THAT(set.error().message, testing::HasSubstr(std::to_string(device().info().max_push_descriptors)));
    const auto layout = create_pipeline_layout(device(), {}, device().properties().limits.maxPushConstantsSize + 4,
                                               VK_SHADER_STAGE_ALL);
    EXPECT_FALSE(layout.has_value());
}

} // namespace
} // namespace tyndall::engine
