// Shadow maps of point and spot lights: one pass a map, left out where the map still holds what it should.
#include <array>
#include <string>

#include "engine/renderer.hpp"

namespace tyndall::engine {
namespace {

struct LocalShadowPush {
    std::uint32_t record = 0; ///< of the array of gpu::LocalShadow
    std::uint32_t side = 0;   ///< of its cube
};

rg::ImageUse cleared_layer(std::uint32_t layer) {
    return {.range = {.base_layer = layer, .layer_count = 1}, .clear = rg::clear_depth(0.0F)};
}

} // namespace

void Renderer::plan_local_shadows() {
    LocalShadowPlan plan = engine::plan_local_shadows(lights_.local, casters_.boxes, frame_.view.origin_m,
                                                      settings_.local_shadows, settings_.lights, shadowed_lights_);
    for (const std::string& sentence : plan.without) {
        omit("shadows of a local light", sentence);
    }
    if (plan.lights.empty()) {
        omit("shadow maps of local lights", plan.why_none);
    }
    shadowed_lights_ = plan.lights;
    frame_.local_shadows = std::move(plan);
}

tl::expected<void, Error> Renderer::declare_local_shadows(rg::GraphBuilder& graph, rg::Blackboard& blackboard) {
    const LocalShadowPlan& plan = frame_.local_shadows;
    if (plan.lights.empty()) {
        return {};
    }
    const std::uint32_t side = settings_.local_shadows.resolution;
    if (settings_.cache_cascades && !local_shadow_cache_) {
        auto cache = make_shadow_cache(side, plan.most_maps);
        if (!cache) {
            return tl::unexpected(cache.error());
        }
        local_shadow_cache_ = std::move(*cache);
        local_maps_held_.assign(plan.most_maps, std::nullopt);
    }
    std::vector<gpu::LocalShadow> values;
    for (const ShadowedLight& shadowed : plan.lights) {
        values.push_back(
            make_local_shadow(lights_.local[shadowed.light], shadowed, frame_.view.origin_m, settings_.local_shadows));
    }
    const std::uint32_t slot_index = frame_.view.frame_slot;
    frame_data_.write_local_shadows(slot_index, values);
    const rg::Buffer records = import(graph, "local shadow records", frame_data_.slot(slot_index).local_shadows);

    const std::vector<LocalMap> stale = stale_maps();
    if (stale.size() < plan.map_count) {
        omit(std::to_string(plan.map_count - stale.size()) + " shadow maps of local lights",
             "they hold the same as in an earlier frame");
    }
    // Readers see the whole array: what no light uses has been cleared once.
    std::vector<std::uint32_t> unused;
    for (std::uint32_t layer = plan.map_count; local_shadow_cache_ && layer < local_maps_held_.size(); ++layer) {
        if (!local_maps_held_[layer]) {
            unused.push_back(layer);
            local_maps_held_[layer] = HeldMap{};
        }
    }
    const bool drawn = !stale.empty() || !unused.empty();
    rg::Image maps = shadow_image(graph, "local shadow maps", local_shadow_cache_, side, plan.map_count, drawn);
    for (const LocalMap& map : stale) {
        if (auto declared = declare_local_map(graph, maps, records, map); !declared) {
            return declared;
        }
    }
    for (const std::uint32_t layer : unused) {
        rg::PassBuilder pass =
            graph.add_pass("unused local shadow map " + std::to_string(layer), rg::PassKind::graphics);
        pass.writes(maps, rg::Access::depth_attachment, cleared_layer(layer));
        pass.executes([](rg::PassContext&) {});
    }
    blackboard.put(LocalShadows{maps, records});
    return {};
}

std::vector<Renderer::LocalMap> Renderer::stale_maps() {
    std::vector<LocalMap> stale;
    const LocalShadowPlan& plan = frame_.local_shadows;
    for (std::uint32_t record = 0; record < plan.lights.size(); ++record) {
        const ShadowedLight& shadowed = plan.lights[record];
        for (std::uint32_t side = 0; side < shadowed.map_count; ++side) {
            const std::uint32_t layer = shadowed.first_layer + side;
            const HeldMap held{shadowed.light, side};
            if (local_shadow_cache_ && local_maps_held_[layer] == held) {
                continue;
            }
            if (local_shadow_cache_) {
                local_maps_held_[layer] = held;
            }
            stale.push_back({record, side, layer});
        }
    }
    return stale;
}

tl::expected<void, Error> Renderer::declare_local_map(rg::GraphBuilder& graph, rg::Image& maps, rg::Buffer records,
                                                      const LocalMap& map) {
    const ShadowedLight& shadowed = frame_.local_shadows.lights[map.record];
    const Light& light = lights_.local[shadowed.light];
    const double range_m = light_range_m(light, settings_.lights);
    auto draws =
        depth_draws(DepthTarget::local,
                    casters_.where([&](const Box& box) { return may_cast_into(light, map.side, range_m, box); }));
    auto program = pipelines_->depth(DepthTarget::local, false, 0);
    if (!draws || !program) {
        return tl::unexpected(draws ? program.error() : draws.error());
    }
    std::string name = "shadow map of local light " + std::to_string(shadowed.light);
    name += shadowed.map_count > 1 ? ", side " + std::to_string(map.side) : "";
    rg::PassBuilder pass = graph.add_pass(name, rg::PassKind::graphics);
    pass.writes(maps, rg::Access::depth_attachment, cleared_layer(map.layer))
        .reads(records, rg::Access::storage_graphics)
        .reads(frame_.instances, rg::Access::storage_graphics);
    declare_geometry(pass, frame_.geometry, true);
    pass.executes([draws = std::move(*draws), program = *program, geometry = frame_.geometry, records,
                   instances = frame_.instances, push = LocalShadowPush{map.record, map.side}](rg::PassContext& ctx) {
        const std::array<rg::Binding, 2> bindings = {ctx.storage(0, records), ctx.storage(1, instances)};
        ctx.push(VK_PIPELINE_BIND_POINT_GRAPHICS, program.layout, 0, bindings, *program.bindings);
        ctx.vk().CmdPushConstants(ctx.cmd(), program.layout, VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof push, &push);
        DrawRecorder recorder(ctx, program.layout, geometry, true);
        for (const Draw& draw : draws) {
            recorder.draw(draw);
        }
    });
    return {};
}

} // namespace tyndall::engine
