// Depth pre-pass and opaque surfaces.
#include <algorithm>
#include <array>
#include <string>

#include "engine/forward_inputs.hpp"
#include "engine/renderer.hpp"

namespace tyndall::engine {

Draw Renderer::instance_draw(std::uint32_t instance) const {
    const Instance& placed = scene_.instances[instance];
    const Material& material = scene_.materials[scene_.primitives[placed.primitive].material];
    return {.material = scene_gpu_.materials.sets[scene_.primitives[placed.primitive].material],
            .instance = instance,
            .range = scene_gpu_.geometry.ranges[placed.primitive],
            .cull = material.double_sided ? VkCullModeFlags{VK_CULL_MODE_NONE} : VkCullModeFlags{VK_CULL_MODE_BACK_BIT},
            .front = placed.mirrored ? VK_FRONT_FACE_CLOCKWISE : VK_FRONT_FACE_COUNTER_CLOCKWISE};
}

tl::expected<std::vector<Draw>, Error> Renderer::depth_draws(DepthTarget target,
                                                             std::span<const std::uint32_t> instances) {
    std::vector<Draw> draws;
    for (const std::uint32_t instance : instances) {
        const std::uint32_t primitive = scene_.instances[instance].primitive;
        const bool mask = scene_.materials[scene_.primitives[primitive].material].alpha_mode == AlphaMode::mask;
        const auto program = pipelines_->depth(target, mask, scene_gpu_.features[primitive]);
        if (!program) {
            return tl::unexpected(program.error());
        }
        Draw draw = instance_draw(instance);
        draw.pipeline = program->pipeline;
        if (!mask) {
            draw.material = VK_NULL_HANDLE;
        }
        if (target != DepthTarget::view) {
            draw.cull = VK_CULL_MODE_NONE; // walls are often modelled from one side only, and still stop light
        }
        draws.push_back(draw);
    }
    return draws;
}

tl::expected<void, Error> Renderer::declare_depth(rg::GraphBuilder& graph, rg::Blackboard& blackboard) {
    auto draws = depth_draws(DepthTarget::view, frame_.lists.surfaces);
    auto program = pipelines_->depth(DepthTarget::view, false, 0);
    if (!draws || !program) {
        return tl::unexpected(draws ? program.error() : draws.error());
    }
    const VkExtent2D size = frame_.view.size;
    SceneImages images;
    images.depth = graph.create_image("scene depth", {.format = depth_format, .extent = {size.width, size.height, 1}});
    rg::PassBuilder pass = graph.add_pass("depth pre-pass", rg::PassKind::graphics);
    pass.writes(images.depth, rg::Access::depth_attachment, {.clear = rg::clear_depth(0.0F)})
        .reads(frame_.parameters, rg::Access::uniform_graphics)
        .reads(frame_.instances, rg::Access::storage_graphics);
    declare_geometry(pass, frame_.geometry, true);
    pass.executes([draws = std::move(*draws), program = *program, geometry = frame_.geometry,
                   parameters = frame_.parameters, instances = frame_.instances](rg::PassContext& ctx) {
        const std::array<rg::Binding, 2> bindings = {ctx.uniform(0, parameters), ctx.storage(1, instances)};
        ctx.push(VK_PIPELINE_BIND_POINT_GRAPHICS, program.layout, 0, bindings, *program.bindings);
        DrawRecorder recorder(ctx, program.layout, geometry, true);
        for (const Draw& draw : draws) {
            recorder.draw(draw);
        }
    });
    blackboard.put(images);
    return {};
}

tl::expected<void, Error> Renderer::declare_opaque(rg::GraphBuilder& graph, rg::Blackboard& blackboard) {
    ForwardInputs inputs{.parameters = frame_.parameters,
                         .instances = frame_.instances,
                         .linear_sampler = linear_sampler_.get(),
                         .nearest_sampler = nearest_sampler_.get()};
    inputs.find(blackboard, false);
    Program surfaces; // of each draw but for the pipeline
    std::vector<Draw> draws;
    for (const std::uint32_t instance : frame_.lists.surfaces) {
        const std::uint32_t primitive = scene_.instances[instance].primitive;
        const auto program = pipelines_->forward(inputs.variant(false), scene_gpu_.features[primitive]);
        if (!program) {
            return tl::unexpected(program.error());
        }
        Draw& draw = draws.emplace_back(instance_draw(instance));
        draw.pipeline = program->pipeline;
        surfaces = *program;
    }
    // Depth is already there, so the order is free: few changes of state. By material as it stands in the scene, for
    // the order of handles differs from run to run.
    const auto material_of = [&](const Draw& draw) {
        return scene_.primitives[scene_.instances[draw.instance].primitive].material;
    };
    std::stable_sort(draws.begin(), draws.end(),
                     [&](const Draw& a, const Draw& b) { return material_of(a) < material_of(b); });

    const Background background = settings_.background.value_or(default_background(lights_.sun));
    Program sky;
    if (background.is_even()) {
        omit("sky", "the background is the same everywhere: the colour is cleared to it");
    } else {
        const auto program = pipelines_->sky();
        if (!program) {
            return tl::unexpected(program.error());
        }
        sky = *program;
    }
    SceneImages& images = *blackboard.find<SceneImages>();
    const VkExtent2D size = frame_.view.size;
    images.color =
        graph.create_image("scene colour", {.format = settings_.color_format, .extent = {size.width, size.height, 1}});
    const glm::vec3 even = background.horizon;
    rg::PassBuilder pass = graph.add_pass("opaque", rg::PassKind::graphics);
    pass.writes(images.color, rg::Access::color_attachment, {.clear = rg::clear_color(even.r, even.g, even.b, 1.0F)})
        .reads(images.depth, rg::Access::depth_attachment);
    declare_geometry(pass, frame_.geometry, true);
    inputs.declare(pass);
    pass.executes([draws = std::move(draws), surfaces, sky, inputs, geometry = frame_.geometry](rg::PassContext& ctx) {
        if (!draws.empty()) {
            inputs.push(ctx, surfaces);
            DrawRecorder recorder(ctx, surfaces.layout, geometry, true);
            for (const Draw& draw : draws) {
                recorder.draw(draw);
            }
        }
        if (sky.pipeline != VK_NULL_HANDLE) {
            ctx.vk().CmdBindPipeline(ctx.cmd(), VK_PIPELINE_BIND_POINT_GRAPHICS, sky.pipeline);
            const rg::Binding parameters = ctx.uniform(0, inputs.parameters);
            ctx.push(VK_PIPELINE_BIND_POINT_GRAPHICS, sky.layout, 0, {&parameters, 1}, *sky.bindings);
            ctx.vk().CmdDraw(ctx.cmd(), 3, 1, 0, 0);
        }
    });
    return {};
}

} // namespace tyndall::engine
