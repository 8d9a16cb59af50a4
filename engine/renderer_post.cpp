// Exposure and tone mapping.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/renderer.hpp"

namespace tyndall::engine {
namespace {

/// Sums of log luminance, and about how many pixels they are taken from.
constexpr std::uint32_t partial_sums = 1024;
constexpr double sampled_pixels = 57600.0;
constexpr std::uint32_t group_size = 64;

/// What the mean of the image is exposed to (Reinhard et al. 2002: the key of a scene neither light nor dark).
constexpr double middle_grey = 0.18;

} // namespace

tl::expected<rg::Buffer, Error> Renderer::declare_exposure(rg::GraphBuilder& graph, rg::Image color) {
    const auto sums_program = pipelines_->luminance_sums();
    const auto exposure_program = pipelines_->exposure();
    if (!sums_program || !exposure_program) {
        return tl::unexpected(sums_program ? exposure_program.error() : sums_program.error());
    }
    const VkExtent2D size = frame_.view.size;
    const double pixels = static_cast<double>(size.width) * size.height;
    const std::uint32_t step = std::max(1U, static_cast<std::uint32_t>(std::sqrt(pixels / sampled_pixels)));
    const RendererPipelines::LuminancePush sums_push{std::max(1U, size.width / step), std::max(1U, size.height / step),
                                                     step, partial_sums};
    const double key = middle_grey * std::exp2(settings_.exposure.compensation_ev);
    const RendererPipelines::ExposurePush exposure_push{partial_sums, static_cast<float>(key), 1.0F};

    rg::Buffer sums = graph.create_buffer("luminance sums", {.size_bytes = partial_sums * 2 * sizeof(float)});
    rg::Buffer exposure = graph.create_buffer("exposure", {.size_bytes = 4 * sizeof(float)});
    rg::PassBuilder first = graph.add_pass("luminance sums", rg::PassKind::compute);
    first.reads(color, rg::Access::sampled_compute).writes(sums, rg::Access::storage_compute);
    first.executes([=, program = *sums_program, sampler = nearest_sampler_.get()](rg::PassContext& ctx) {
        const std::array<rg::Binding, 2> bindings = {ctx.sampled(0, color, sampler), ctx.storage(1, sums)};
        ctx.vk().CmdBindPipeline(ctx.cmd(), VK_PIPELINE_BIND_POINT_COMPUTE, program.pipeline);
        ctx.push(VK_PIPELINE_BIND_POINT_COMPUTE, program.layout, 0, bindings, *program.bindings);
        ctx.vk().CmdPushConstants(ctx.cmd(), program.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof sums_push,
                                  &sums_push);
        ctx.vk().CmdDispatch(ctx.cmd(), partial_sums / group_size, 1, 1);
    });
    rg::PassBuilder second = graph.add_pass("exposure", rg::PassKind::compute);
    second.reads(sums, rg::Access::storage_compute).writes(exposure, rg::Access::storage_compute);
    second.executes([=, program = *exposure_program](rg::PassContext& ctx) {
        const std::array<rg::Binding, 2> bindings = {ctx.storage(0, sums), ctx.storage(1, exposure)};
        ctx.vk().CmdBindPipeline(ctx.cmd(), VK_PIPELINE_BIND_POINT_COMPUTE, program.pipeline);
        ctx.push(VK_PIPELINE_BIND_POINT_COMPUTE, program.layout, 0, bindings, *program.bindings);
        ctx.vk().CmdPushConstants(ctx.cmd(), program.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof exposure_push,
                                  &exposure_push);
        ctx.vk().CmdDispatch(ctx.cmd(), 1, 1, 1);
    });
    return exposure;
}

tl::expected<void, Error> Renderer::declare_post(rg::GraphBuilder& graph, rg::Blackboard& blackboard) {
    const rg::Image color = blackboard.find<SceneImages>()->color;
    const bool automatic = !settings_.exposure.ev100;
    const auto program = pipelines_->tone_mapping(automatic);
    if (!program) {
        return tl::unexpected(program.error());
    }
    rg::Buffer exposure;
    float fixed = 1.0F;
    if (automatic) {
        auto declared = declare_exposure(graph, color);
        if (!declared) {
            return tl::unexpected(declared.error());
        }
        exposure = *declared;
    } else {
        fixed = static_cast<float>(exposure_from_ev100(*settings_.exposure.ev100));
        omit("luminance sums, exposure", "the exposure is given");
    }
    const VkExtent2D size = frame_.view.size;
    rg::Image picture =
        graph.create_image("picture", {.format = picture_format, .extent = {size.width, size.height, 1}});
    rg::PassBuilder pass = graph.add_pass("tone mapping", rg::PassKind::graphics);
    pass.writes(picture, rg::Access::color_attachment).reads(color, rg::Access::sampled_fragment);
    if (automatic) {
        pass.reads(exposure, rg::Access::storage_fragment);
    }
    pass.executes([=, tone_mapping = *program, sampler = nearest_sampler_.get()](rg::PassContext& ctx) {
        ctx.vk().CmdBindPipeline(ctx.cmd(), VK_PIPELINE_BIND_POINT_GRAPHICS, tone_mapping.pipeline);
        std::array<rg::Binding, 2> bindings = {ctx.sampled(0, color, sampler)};
        if (automatic) {
            bindings[1] = ctx.storage(1, exposure);
        } else {
            ctx.vk().CmdPushConstants(ctx.cmd(), tone_mapping.layout, VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof fixed,
                                      &fixed);
        }
        ctx.push(VK_PIPELINE_BIND_POINT_GRAPHICS, tone_mapping.layout, 0, std::span(bindings).first(automatic ? 2 : 1),
                 *tone_mapping.bindings);
        ctx.vk().CmdDraw(ctx.cmd(), 3, 1, 0, 0);
    });
    blackboard.put(FrameOutput{picture});
    return {};
}

} // namespace tyndall::engine
