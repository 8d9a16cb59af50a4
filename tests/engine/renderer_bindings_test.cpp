// What the renderer's programs say of their shaders, by which the executor compares a pass with them.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/materials_gpu.hpp"
#include "engine/renderer_pipelines.hpp"
#include "rendergraph/compile.hpp"
#include "rendergraph/executor.hpp"
#include "tests/engine/device_fixture.hpp"

namespace tyndall::engine {
namespace {

class RendererBindings : public DeviceTest {
protected:
    void SetUp() override {
        DeviceTest::SetUp();
        ASSERT_FALSE(HasFatalFailure());
        // As shaders/engine/material.glsl has it: the parameters and seven textures.
        std::vector<VkDescriptorSetLayoutBinding> bindings = {
            {0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr}};
        for (std::uint32_t i = 1; i <= 7; ++i) {
            bindings.push_back(
                {i, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr});
        }
        materials_ = create_set_layout(device(), bindings, false).value();
        pipelines_.emplace(device(), VK_NULL_HANDLE, materials_.get(), VK_FORMAT_R16G16B16A16_SFLOAT, 1);
    }
    void TearDown() override {
        pipelines_.reset();
        materials_ = {};
        DeviceTest::TearDown();
    }

    /// The numbers of the bindings of set 0, an asterisk at what may be written.
    static std::string pushed(const tl::expected<Program, Error>& program) {
        if (!program) {
            return program.error().message;
        }
        std::string text;
        for (const rg::ReflectedBinding& binding : *program->bindings) {
            if (binding.set == 0) {
                text += (text.empty() ? "" : " ") + std::to_string(binding.binding) + (binding.may_write ? "*" : "");
            }
        }
        return text;
    }

    DescriptorSetLayout materials_;
    std::optional<RendererPipelines> pipelines_;
};

TEST_F(RendererBindings, AreWhatEachPassPushes) {
    for (const DepthTarget target : {DepthTarget::view, DepthTarget::cascade, DepthTarget::local}) {
        EXPECT_EQ(pushed(pipelines_->depth(target, false, 0)), "0 1");
        EXPECT_EQ(pushed(pipelines_->depth(target, true, feature_base_color_texture)), "0 1");
    }
    EXPECT_EQ(pushed(pipelines_->forward({}, 0)), "0 1");
    EXPECT_EQ(pushed(pipelines_->forward({.sun_shadow = true}, 0)), "0 1 2 3");
    EXPECT_EQ(pushed(pipelines_->forward({.lights = LocalLights::all}, 0)), "0 1 4");
    EXPECT_EQ(pushed(pipelines_->forward({.lights = LocalLights::of_cluster}, 0)), "0 1 4 5 6");
    EXPECT_EQ(pushed(pipelines_->forward({.lights = LocalLights::all, .local_shadow = true}, 0)), "0 1 4 9 10");
    EXPECT_EQ(pushed(pipelines_->sky()), "0");
    EXPECT_EQ(pushed(pipelines_->luminance_sums()), "0 1*");
    EXPECT_EQ(pushed(pipelines_->exposure()), "0 1*");
    EXPECT_EQ(pushed(pipelines_->tone_mapping(false)), "0");
    EXPECT_EQ(pushed(pipelines_->tone_mapping(true)), "0 1");
}

/// Surfaces with and without Blend::multiply are drawn with what is pushed once.
TEST_F(RendererBindings, AreOfAllShadersThatShareALayout) {
    if (!device().info().dual_source_blending) {
        GTEST_SKIP() << "the device has no dual-source blending";
    }
    const ForwardVariant glass{.sun_shadow = true, .transparent = true, .scattering = true};
    const auto filter = pipelines_->forward(glass, feature_filter);
    EXPECT_EQ(pushed(filter), "0 1 7 8");
    const auto plain = pipelines_->forward(glass, 0);
    EXPECT_EQ(pushed(plain), "0 1 2 3 7 8");
    EXPECT_EQ(pushed(filter), "0 1 2 3 7 8");
}

TEST_F(RendererBindings, TellAWrongDeclaration) {
    const auto program = pipelines_->exposure();
    ASSERT_TRUE(program.has_value()) << program.error().message;
    rg::GraphBuilder graph;
    rg::Buffer sums = graph.create_buffer("sums", {.size_bytes = 64});
    rg::Buffer exposure = graph.create_buffer("exposure", {.size_bytes = 16});
    graph.add_pass("fill", rg::PassKind::transfer)
        .writes(sums, rg::Access::transfer_destination)
        .writes(exposure, rg::Access::transfer_destination)
        .executes([=](rg::PassContext& ctx) {
            ctx.vk().CmdFillBuffer(ctx.cmd(), ctx.buffer(sums), 0, VK_WHOLE_SIZE, 0);
            ctx.vk().CmdFillBuffer(ctx.cmd(), ctx.buffer(exposure), 0, VK_WHOLE_SIZE, 0);
        });
    graph.add_pass("odd", rg::PassKind::compute)
        .reads(sums, rg::Access::storage_compute)
        .reads(exposure, rg::Access::storage_compute)
        .has_side_effect("is looked at")
        .executes([=](rg::PassContext& ctx) {
            const std::array<rg::Binding, 2> bindings = {ctx.storage(0, sums), ctx.storage(1, exposure)};
            ctx.push(VK_PIPELINE_BIND_POINT_COMPUTE, program->layout, 0, bindings, *program->bindings);
        });
    const rg::DeclaredGraph declared = graph.finish();
    rg::ExecutorInfo info = device().executor_info(false);
    info.check_bindings = true;
    auto executor = rg::Executor::create(std::move(info));
    ASSERT_TRUE(executor.has_value()) << executor.error().message;
    const auto plan = rg::compile(declared.desc, executor->topology(), executor->memory_requirements(declared.desc));
    ASSERT_TRUE(plan.has_value()) << rg::to_text(plan.error());
    const auto frame = executor->submit(declared.desc, *plan, declared.callbacks, {});
    ASSERT_FALSE(frame.has_value());
    EXPECT_EQ(frame.error().kind, rg::ExecuteError::Kind::undeclared_access);
    EXPECT_EQ(frame.error().message, "Pass 'odd' uses 'exposure' at binding 1 of set 0 in a shader that may write it, "
                                     "but declared that it only reads it");
}

} // namespace
} // namespace tyndall::engine
