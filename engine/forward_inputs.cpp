#include "engine/forward_inputs.hpp"

#include <array>

namespace tyndall::engine {
namespace {

template <typename T>
std::optional<T> on(rg::Blackboard& blackboard) {
    const T* found = blackboard.find<T>();
    return found == nullptr ? std::nullopt : std::optional<T>(*found);
}

} // namespace

void ForwardInputs::find(rg::Blackboard& blackboard, bool transparent) {
    sun = on<SunShadow>(blackboard);
    lights = on<SceneLights>(blackboard);
    if (lights && lights->records.empty()) {
        lights.reset();
    }
    if (lights) {
        clusters = on<LightClusters>(blackboard);
        local_shadows = on<LocalShadows>(blackboard);
    }
    if (const Air* found = blackboard.find<Air>()) {
        air = LightMarch{found->volumes, found->noise_octaves, found->colored};
    }
    if (transparent) {
        scattering = on<ScatteringVolumeImages>(blackboard);
    }
}

ForwardVariant ForwardInputs::variant(bool transparent) const {
    return {.sun_shadow = sun.has_value(),
            .lights = !lights    ? LocalLights::none
                      : clusters ? LocalLights::of_cluster
                                 : LocalLights::all,
            .local_shadow = local_shadows.has_value(),
            .transparent = transparent,
            .scattering = scattering.has_value(),
            .air = air,
            .airlight_features = scattering ? scattering->airlight_features : 0,
            .colored_scattering = scattering && scattering->colored};
}

void ForwardInputs::declare(rg::PassBuilder& pass) const {
    pass.reads(parameters, rg::Access::uniform_graphics).reads(instances, rg::Access::storage_graphics);
    if (sun) {
        pass.reads(sun->parameters, rg::Access::uniform_graphics).reads(sun->cascades, rg::Access::sampled_graphics);
    }
    if (lights) {
        pass.reads(lights->lights, rg::Access::storage_graphics);
    }
    if (local_shadows) {
        pass.reads(local_shadows->maps, rg::Access::sampled_graphics)
            .reads(local_shadows->records, rg::Access::storage_graphics);
    }
    if (clusters) {
        pass.reads(clusters->parameters, rg::Access::uniform_graphics)
            .reads(clusters->masks, rg::Access::storage_graphics);
    }
    if (scattering) {
        pass.reads(scattering->parameters, rg::Access::uniform_graphics)
            .reads(scattering->accumulated, rg::Access::sampled_graphics);
    }
}

void ForwardInputs::push(rg::PassContext& ctx, const Program& program) const {
    std::array<rg::Binding, 11> bindings;
    std::size_t count = 0;
    const auto bind = [&](const rg::Binding& binding) { bindings[count++] = binding; };
    bind(ctx.uniform(0, parameters));
    bind(ctx.storage(1, instances));
    if (sun) {
        bind(ctx.uniform(2, sun->parameters));
        bind(ctx.sampled(3, sun->cascades, nearest_sampler, {.type = VK_IMAGE_VIEW_TYPE_2D_ARRAY}));
    }
    if (lights) {
        bind(ctx.storage(4, lights->lights));
    }
    if (clusters) {
        bind(ctx.uniform(5, clusters->parameters));
        bind(ctx.storage(6, clusters->masks));
    }
    if (scattering) {
        bind(ctx.uniform(7, scattering->parameters));
        bind(ctx.sampled(8, scattering->accumulated, linear_sampler, {.type = VK_IMAGE_VIEW_TYPE_2D_ARRAY}));
    }
    if (local_shadows) {
        bind(ctx.sampled(9, local_shadows->maps, nearest_sampler, {.type = VK_IMAGE_VIEW_TYPE_2D_ARRAY}));
        bind(ctx.storage(10, local_shadows->records));
    }
    ctx.push(VK_PIPELINE_BIND_POINT_GRAPHICS, program.layout, 0, std::span(bindings).first(count), *program.bindings);
}

} // namespace tyndall::engine
