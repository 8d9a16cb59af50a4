// The sun's cascades: one pass a layer, left out where the layer still holds what it should.
#include <array>
#include <string>

#include "engine/renderer.hpp"

namespace tyndall::engine {
namespace {

/// Who may sample the cascades: forward shading, particles, features.
constexpr VkPipelineStageFlags2 sampling_stages = VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT |
                                                  VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT |
                                                  VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
constexpr VkImageLayout resting_layout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL;

} // namespace

bool Renderer::is_held(std::uint32_t cascade) const {
    return cascade_cache_ && cascades_held_[cascade] &&
           same_texels(*cascades_held_[cascade], *frame_.cascades, cascade);
}

tl::expected<Renderer::ShadowCache, Error> Renderer::make_shadow_cache(std::uint32_t side, std::uint32_t layers) const {
    auto image = DeviceImage::create(*device_,
                                     {.format = depth_format,
                                      .extent = {side, side, 1},
                                      .layers = layers,
                                      .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                                      .shared_between_queues = true});
    if (!image) {
        return tl::unexpected(image.error());
    }
    return ShadowCache{.image = std::move(*image), .layers = layers};
}

rg::Image Renderer::shadow_image(rg::GraphBuilder& graph, const char* name, std::optional<ShadowCache>& cache,
                                 std::uint32_t side, std::uint32_t layers, bool drawn) {
    rg::ImageDesc desc{.format = depth_format, .extent = {side, side, 1}, .layers = layers};
    if (!cache) {
        return graph.create_image(name, desc);
    }
    desc.layers = cache->layers;
    // No stages on the way in: the last use was in an earlier frame, after which the executor orders this one whole.
    rg::ImportDesc import{.read_only = !drawn};
    import.initial_layout = cache->has_layout ? resting_layout : VK_IMAGE_LAYOUT_UNDEFINED;
    if (drawn) {
        import.has_final = true;
        import.final_layout = resting_layout;
        import.final_stages = sampling_stages;
        import.final_access = VK_ACCESS_2_SHADER_SAMPLED_READ_BIT;
    }
    cache->has_layout = true;
    const rg::Image image = graph.import_image(name, desc, import);
    graph.share_between_queues(image);
    bindings_.push_back({.resource = image.resource, .image = cache->image.handle()});
    return image;
}

tl::expected<void, Error> Renderer::declare_shadows(rg::GraphBuilder& graph, rg::Blackboard& blackboard) {
    if (!lights_.sun || casters_.bounds.empty()) {
        omit("sun cascades",
             lights_.sun ? "nothing in the scene casts a shadow" : "the scene has no directional light");
        return {};
    }
    const std::uint32_t side = settings_.cascades.resolution;
    if (settings_.cache_cascades && !cascade_cache_) {
        auto cache = make_shadow_cache(side, settings_.cascades.count);
        if (!cache) {
            return tl::unexpected(cache.error());
        }
        cascade_cache_ = std::move(*cache);
    }
    frame_.cascades = fit_cascades(frame_.view, casters_.bounds, lights_.sun->direction, settings_.cascades);
    const std::uint32_t slot_index = frame_.view.frame_slot;
    const gpu::SunCascades values =
        make_sun_cascades(*frame_.cascades, frame_.view.origin_m, lights_.sun->illuminance_lux);
    frame_data_.write_sun(slot_index, values);
    const rg::Buffer parameters = import(graph, "sun parameters", frame_data_.slot(slot_index).sun);

    std::array<bool, most_cascades> stale{};
    bool any_stale = false;
    for (std::uint32_t i = 0; i < frame_.cascades->count; ++i) {
        stale[i] = !is_held(i);
        any_stale = any_stale || stale[i];
    }
    rg::Image image = shadow_image(graph, "sun cascades", cascade_cache_, side, frame_.cascades->count, any_stale);
    for (std::uint32_t i = 0; i < frame_.cascades->count; ++i) {
        const std::string name = "sun cascade " + std::to_string(i);
        if (!stale[i]) {
            omit(name, "it holds the same as in an earlier frame");
            continue;
        }
        auto draws =
            depth_draws(DepthTarget::cascade,
                        casters_.where([&](const Box& box) { return may_cast_into(*frame_.cascades, i, box); }));
        auto program = pipelines_->depth(DepthTarget::cascade, false, 0);
        if (!draws || !program) {
            return tl::unexpected(draws ? program.error() : draws.error());
        }
        rg::PassBuilder pass = graph.add_pass(name, rg::PassKind::graphics);
        pass.writes(image, rg::Access::depth_attachment,
                    {.range = {.base_layer = i, .layer_count = 1}, .clear = rg::clear_depth(1.0F)})
            .reads(parameters, rg::Access::uniform_graphics)
            .reads(frame_.instances, rg::Access::storage_graphics);
        declare_geometry(pass, frame_.geometry, true);
        pass.executes([draws = std::move(*draws), program = *program, geometry = frame_.geometry, parameters,
                       instances = frame_.instances, i](rg::PassContext& ctx) {
            const std::array<rg::Binding, 2> bindings = {ctx.uniform(0, parameters), ctx.storage(1, instances)};
            ctx.push(VK_PIPELINE_BIND_POINT_GRAPHICS, program.layout, 0, bindings, *program.bindings);
            ctx.vk().CmdPushConstants(ctx.cmd(), program.layout, VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof i, &i);
            DrawRecorder recorder(ctx, program.layout, geometry, true);
            for (const Draw& draw : draws) {
                recorder.draw(draw);
            }
        });
        if (cascade_cache_) {
            cascades_held_[i] = *frame_.cascades;
        }
    }
    blackboard.put(SunShadow{image, parameters, values});
    return {};
}

} // namespace tyndall::engine
