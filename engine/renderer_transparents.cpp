// Transparent surfaces, back to front, and the particles between them.
#include <string>

#include "engine/forward_inputs.hpp"
#include "engine/renderer.hpp"

namespace tyndall::engine {
namespace {

/// The draws of one transparent instance: of a double-sided one first the faces that look away.
struct TransparentDraw {
    std::array<Draw, 2> draws;
    std::size_t count = 1;
};

} // namespace

tl::expected<void, Error> Renderer::declare_particles(rg::GraphBuilder& graph, rg::Blackboard&) {
    if (particles_ == nullptr) {
        omit("particle simulation, sort, split", "the scene has no particles");
        return {};
    }
    const Ambient ambient = settings_.ambient.value_or(default_ambient(lights_.sun));
    const ParticleLight light{.ambient_radiance = 0.5F * (ambient.up + ambient.down),
                              .sun_illuminance_lux = lights_.sun ? lights_.sun->illuminance_lux : glm::vec3(0.0F),
                              .light_count = static_cast<std::uint32_t>(lights_.local.size())};
    auto draws = particles_->declare(graph, frame_.view, light, frame_.lists.transparent_depths_m);
    if (!draws) {
        return tl::unexpected(draws.error());
    }
    bindings_.insert(bindings_.end(), draws->imports.begin(), draws->imports.end());
    frame_.particles = *draws;
    return {};
}

tl::expected<void, Error> Renderer::declare_transparents(rg::GraphBuilder& graph, rg::Blackboard& blackboard) {
    if (frame_.lists.transparents.empty() && !frame_.particles) {
        omit("transparents", "no transparent surface is in view and there are no particles");
        return {};
    }
    ForwardInputs inputs{.parameters = frame_.parameters,
                         .instances = frame_.instances,
                         .linear_sampler = linear_sampler_.get(),
                         .nearest_sampler = nearest_sampler_.get()};
    inputs.find(blackboard, true);
    Program surfaces; // of each draw but for the pipeline
    std::vector<TransparentDraw> transparents;
    for (const std::uint32_t instance : frame_.lists.transparents) {
        const std::uint32_t primitive = scene_.instances[instance].primitive;
        const auto program = pipelines_->forward(inputs.variant(true), scene_gpu_.features[primitive]);
        if (!program) {
            return tl::unexpected(program.error());
        }
        surfaces = *program;
        Draw draw = instance_draw(instance);
        draw.pipeline = program->pipeline;
        TransparentDraw& transparent = transparents.emplace_back();
        transparent.draws = {draw, draw};
        if (draw.cull == VK_CULL_MODE_NONE) {
            transparent.count = 2;
            transparent.draws[0].cull = VK_CULL_MODE_FRONT_BIT;
            transparent.draws[1].cull = VK_CULL_MODE_BACK_BIT;
        }
    }
    SceneImages& images = *blackboard.find<SceneImages>();
    const ParticleSurroundings surroundings{.scene_depth = images.depth,
                                            .scattering = inputs.scattering,
                                            .sun_shadow = inputs.sun,
                                            .lights = inputs.lights,
                                            .local_shadows = inputs.local_shadows};
    rg::PassBuilder pass = graph.add_pass("transparents", rg::PassKind::graphics);
    pass.modifies(images.color, rg::Access::color_attachment).reads(images.depth, rg::Access::depth_attachment);
    if (!transparents.empty()) {
        declare_geometry(pass, frame_.geometry, true);
        inputs.declare(pass);
    }
    if (frame_.particles) {
        if (auto added = particles_->add_reads(pass, *frame_.particles, surroundings); !added) {
            return added;
        }
    }
    pass.executes([transparents = std::move(transparents), surfaces, inputs, geometry = frame_.geometry,
                   particles = frame_.particles, system = particles_, surroundings](rg::PassContext& ctx) {
        DrawRecorder recorder(ctx, surfaces.layout, geometry, true);
        bool inputs_bound = false;
        const auto draw_particles = [&](std::size_t interval) {
            if (particles) {
                system->draw(ctx, *particles, surroundings, static_cast<std::uint32_t>(interval));
                recorder.forget();
                inputs_bound = false;
            }
        };
        for (std::size_t i = 0; i < transparents.size(); ++i) {
            draw_particles(i);
            if (!inputs_bound) {
                inputs.push(ctx, surfaces);
                inputs_bound = true;
            }
            for (std::size_t side = 0; side < transparents[i].count; ++side) {
                recorder.draw(transparents[i].draws[side]);
            }
        }
        draw_particles(transparents.size());
    });
    return {};
}

} // namespace tyndall::engine
