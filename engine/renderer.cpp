#include "engine/renderer.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace tyndall::engine {
namespace {

/// Host-written before the frame is submitted, or uploaded before the first frame: visible to all of it.
constexpr rg::ImportDesc never_written{.read_only = true};

/// Largest radiance that the format holds, with room for rounding.
float largest_radiance(VkFormat format) {
    return format == VK_FORMAT_R16G16B16A16_SFLOAT ? 65000.0F : 1e30F;
}

tl::expected<DeviceSampler, Error> make_sampler(const Device& device, VkFilter filter) {
    return create_sampler(device, {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                   .magFilter = filter,
                                   .minFilter = filter,
                                   .mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST,
                                   .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                   .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                   .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE});
}

} // namespace

std::vector<std::string> Renderer::injection_points() {
    return {"frame_begin", "after_shadow_maps", "after_depth", "after_opaque",
            "transparent", "after_transparent", "post",        "frame_end"};
}

Renderer::Renderer(const Device& device, Scene scene, RendererSettings settings)
    : device_(&device), scene_(std::move(scene)), settings_(settings), lights_(assign_lights(scene_)),
      casters_(shadow_casters(scene_)) {}

Renderer::~Renderer() = default;

tl::expected<std::unique_ptr<Renderer>, Error> Renderer::create(const Device& device, VkPipelineCache cache,
                                                                Scene scene, RendererSettings settings,
                                                                std::uint32_t frames_in_flight) {
    std::unique_ptr<Renderer> renderer(new Renderer(device, std::move(scene), settings));
    if (auto made = renderer->make(cache, frames_in_flight); !made) {
        return tl::unexpected(made.error());
    }
    return renderer;
}

tl::expected<void, Error> Renderer::make(VkPipelineCache cache, std::uint32_t frames_in_flight) {
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
        const std::string owner = "Material " + std::to_string(i) + " \"" + scene_.materials[i].name + "\"";
        if (auto fits = check_blend(owner, scene_.materials[i].blend, device_->info().dual_source_blending); !fits) {
            return fits;
        }
    }
    const float anisotropy = std::clamp(settings_.texture_anisotropy, 1.0F, device_->info().max_anisotropy);
    auto scene_gpu = upload_scene(*device_, scene_, anisotropy);
    if (!scene_gpu) {
        return tl::unexpected(scene_gpu.error());
    }
    scene_gpu_ = std::move(*scene_gpu);
    pipelines_.emplace(*device_, cache, scene_gpu_.materials.layout.get(), settings_.color_format,
                       static_cast<std::uint32_t>(lights_.local.size()));
    auto frame_data = FrameData::create(*device_, frames_in_flight, scene_.instances.size(), lights_.local.size());
    if (!frame_data) {
        return tl::unexpected(frame_data.error());
    }
    frame_data_ = std::move(*frame_data);
    auto linear = make_sampler(*device_, VK_FILTER_LINEAR);
    auto nearest = make_sampler(*device_, VK_FILTER_NEAREST);
    for (const auto* sampler : {&linear, &nearest}) {
        if (!*sampler) {
            return tl::unexpected(sampler->error());
        }
    }
    linear_sampler_ = std::move(*linear);
    nearest_sampler_ = std::move(*nearest);
    return {};
}

rg::Buffer Renderer::import(rg::GraphBuilder& graph, const char* name, const Buffer& buffer) {
    const rg::Buffer handle = graph.import_buffer(name, {.size_bytes = buffer.size_bytes()}, never_written);
    graph.share_between_queues(handle);
    bindings_.push_back({.resource = handle.resource, .buffer = buffer.handle()});
    return handle;
}

void Renderer::begin_frame(rg::GraphBuilder& graph, rg::Blackboard& blackboard, const FrameRequest& request) {
    bindings_.clear();
    omissions_.clear();
    frame_ = {};
    frame_.view = make_view(request.camera, request.size);
    frame_.view.time_s = request.time_s;
    frame_.view.frame_index = request.frame_index;
    frame_.view.frame_slot = request.frame_slot;
    frame_.view.cut = request.cut;
    frame_.lists = visible_instances(scene_, frame_.view);
    frame_.view.visible_depth_m = frame_.lists.depth_m;

    const auto light_count = static_cast<std::uint32_t>(lights_.local.size());
    plan_local_shadows();
    frame_data_.write_places(request.frame_slot, frame_.view.origin_m, scene_.instances, lights_.local,
                             settings_.lights, frame_.local_shadows.lights);
    const FrameData::Slot& slot = frame_data_.slot(request.frame_slot);
    frame_.parameters = import(graph, "frame parameters", slot.parameters);
    frame_.instances = import(graph, "instances", slot.instances);
    frame_.geometry = {import(graph, "vertex positions", scene_gpu_.geometry.positions),
                       import(graph, "vertex attributes", scene_gpu_.geometry.attributes),
                       import(graph, "vertex indices", scene_gpu_.geometry.indices)};

    blackboard.put(frame_.view);
    FrameSun sun;
    if (lights_.sun) {
        sun = {.direction = glm::vec3(lights_.sun->direction),
               .illuminance_lux = lights_.sun->illuminance_lux,
               .casts_shadows = !casters_.bounds.empty()};
    }
    blackboard.put(sun);
    SceneLights lights{.lights = {}, .records = slot.light_records};
    if (light_count > 0) {
        lights.lights = import(graph, "lights", slot.lights);
    } else {
        omit("local lights", "the scene has no point or spot light");
    }
    blackboard.put(lights);
}

/// After the features have begun the frame: they know what light comes through.
void Renderer::write_parameters(rg::Blackboard& blackboard) {
    FrameLook look{.ambient = settings_.ambient.value_or(default_ambient(lights_.sun)),
                   .background = settings_.background.value_or(default_background(lights_.sun)),
                   .largest_radiance = largest_radiance(settings_.color_format),
                   .local_light_count = static_cast<std::uint32_t>(lights_.local.size())};
    if (const Air* air = blackboard.find<Air>()) {
        look.medium = air->medium;
    }
    frame_data_.write_parameters(frame_.view.frame_slot, make_frame_parameters(frame_.view, lights_, look));
}

tl::expected<void, Error> Renderer::declare(rg::GraphBuilder& graph, rg::Blackboard& blackboard,
                                            const rg::InjectionPoints& points, const FrameRequest& request,
                                            const Declare& at_end) {
    points.begin_frame(graph);
    begin_frame(graph, blackboard, request);
    using Step = tl::expected<void, Error> (Renderer::*)(rg::GraphBuilder&, rg::Blackboard&);
    const auto run = [&](Step step) {
        return [this, step](rg::GraphBuilder& g, rg::Blackboard& b) {
            if (auto done = (this->*step)(g, b); !done && !frame_.error) {
                frame_.error = done.error();
            }
        };
    };
    points.visit("frame_begin", graph, blackboard, run(&Renderer::declare_particles));
    write_parameters(blackboard);
    run (&Renderer::declare_shadows)(graph, blackboard);
    run (&Renderer::declare_local_shadows)(graph, blackboard);
    points.visit("after_shadow_maps", graph, blackboard);
    run (&Renderer::declare_depth)(graph, blackboard);
    points.visit("after_depth", graph, blackboard);
    run (&Renderer::declare_opaque)(graph, blackboard);
    points.visit("after_opaque", graph, blackboard);
    points.visit("transparent", graph, blackboard, run(&Renderer::declare_transparents));
    points.visit("after_transparent", graph, blackboard);
    points.visit("post", graph, blackboard, run(&Renderer::declare_post));
    points.visit("frame_end", graph, blackboard, at_end);
    if (frame_.error) {
        return tl::unexpected(*frame_.error);
    }
    if (const FeatureImports* imports = blackboard.find<FeatureImports>()) {
        bindings_.insert(bindings_.end(), imports->bindings.begin(), imports->bindings.end());
    }
    return {};
}

void Renderer::forget_cached_frames() {
    for (std::optional<ShadowCache>* cache : {&cascade_cache_, &local_shadow_cache_}) {
        if (*cache) {
            (*cache)->has_layout = false;
        }
    }
    cascades_held_ = {};
    std::fill(local_maps_held_.begin(), local_maps_held_.end(), std::nullopt);
}

} // namespace tyndall::engine
