#include "features/volumetrics/feature.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "features/volumetrics/airlight.hpp"
#include "features/volumetrics/depth_range.hpp"
#include "features/volumetrics/feature_state.hpp"
#include "features/volumetrics/range_check.hpp"

namespace tyndall::volumetrics {
namespace {

tl::expected<VkSampler, Error> make_sampler(const rg::DeviceTable& vk, VkDevice device, VkFilter filter,
                                            VkSamplerAddressMode address) {
    const VkSamplerCreateInfo info{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                   .magFilter = filter,
                                   .minFilter = filter,
                                   .mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST,
                                   .addressModeU = address,
                                   .addressModeV = address,
                                   .addressModeW = address};
    VkSampler sampler = VK_NULL_HANDLE;
    if (vk.CreateSampler(device, &info, nullptr, &sampler) != VK_SUCCESS) {
        return tl::unexpected(Error{"The device refused a sampler for the volumetrics."});
    }
    return sampler;
}

bool shines(const FrameInputs& inputs) {
    return inputs.sun && inputs.sun->illuminance_lux != glm::vec3(0.0F);
}

} // namespace

GroupShape row_group(std::uint32_t width, std::uint32_t longest) {
    const std::uint32_t groups = (width + longest - 1) / longest;
    return {((width + groups - 1) / groups + 7) / 8 * 8, 1, 1};
}

Feature::Shared::~Shared() {
    info.vk->DestroySampler(info.device, linear, nullptr);
    info.vk->DestroySampler(info.device, nearest, nullptr);
    info.vk->DestroySampler(info.device, repeating, nullptr);
}

rg::QueueWish Feature::State::wish() const {
    return frame->inputs.settings.async_compute ? rg::QueueWish::async_compute : rg::QueueWish::automatic;
}

void Feature::State::tell(const AirlightChoice& airlight, std::size_t light_count) {
    const auto lights = [](std::size_t count) {
        return std::to_string(count) + (count == 1 ? " local light" : " local lights");
    };
    const std::size_t chosen = airlight.lights.size();
    if (chosen > 0) {
        omit(lights(chosen) + " of " + std::to_string(light_count) + " in the froxels",
             "too fine for them near the view's rays: each pixel integrates what they bring");
    }
    if (chosen < light_count) {
        omit("integration along each pixel's ray of " + lights(light_count - chosen), airlight.why_not);
    }
}

tl::expected<void, Error> Feature::State::prepare_programs() {
    const GridSettings& grid = frame->inputs.settings.grid;
    const Medium& medium = frame->inputs.medium;
    const glm::vec3 none(0.0F);
    const bool baked = is_baked(medium.noise);
    const bool has_grids = !grids_of(medium).empty();
    const bool textures = baked || has_grids || medium.map.texels;
    if (auto made = make_textures(); !made) {
        return made;
    }
    if (auto made = baked ? shared.make_noise() : tl::expected<void, Error>(); !made) {
        return made;
    }
    const std::array<std::uint32_t, 10> media{
        medium.homogeneous.extinction_per_m > 0.0F || medium.homogeneous.emission_per_m != none,
        medium.height.extinction_per_m > 0.0F || medium.height.emission_per_m != none,
        medium.noise.amplitude > 0.0F && !baked ? medium.noise.octaves : 0,
        is_perspective(frame->inputs.camera),
        frame->parameters.frame.z > 0,
        frame->depth_curve,
        frame->colored,
        baked,
        medium.map.texels != nullptr,
        has_grids};
    auto density = pipelines.compute(
        density_injection_shader(frame->inputs.settings.storage, frame->emission, textures, !frame->particles.empty()),
        row_group(grid.width), std::span(media).first(textures ? 10 : 7));
    if (!density) {
        return tl::unexpected(density.error());
    }
    frame->density_injection = *density;
    if (!frame->particles.empty()) {
        if (auto made = make_particle_buffers(); !made) {
            return made;
        }
        auto clustering = pipelines.compute(fog_particle_clustering_shader(), {64, 1, 1});
        if (!clustering) {
            return tl::unexpected(clustering.error());
        }
        frame->particle_clustering = *clustering;
    }
    if (is_clustered(frame->lights)) {
        auto clustering = pipelines.compute(light_clustering_shader(), {64, 1, 1});
        if (!clustering) {
            return tl::unexpected(clustering.error());
        }
        frame->light_clustering = *clustering;
    }
    auto fog =
        pipelines.full_screen_blend(full_screen_shader(), fog_on_opaque_shader(frame->colored, frame->airlight_shadow),
                                    frame->inputs.color_format, frame->colored, std::array{frame->airlight_features});
    if (!fog) {
        return tl::unexpected(fog.error());
    }
    frame->fog_on_opaque = *fog;
    return {};
}

tl::expected<Feature, Error> Feature::create(const FeatureInfo& info) {
    if (info.vk == nullptr || info.device == VK_NULL_HANDLE || info.frames_in_flight == 0) {
        return tl::unexpected(
            Error{"FeatureInfo must name a device, its function table and at least one frame in flight."});
    }
    auto shared = std::make_unique<Shared>(info);
    const auto make = [&](VkSampler& place, VkFilter filter,
                          VkSamplerAddressMode address) -> tl::expected<void, Error> {
        return make_sampler(*info.vk, info.device, filter, address).map([&](VkSampler made) { place = made; });
    };
    for (const auto& made : {make(shared->linear, VK_FILTER_LINEAR, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE),
                             make(shared->nearest, VK_FILTER_NEAREST, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE),
                             make(shared->repeating, VK_FILTER_LINEAR, VK_SAMPLER_ADDRESS_MODE_REPEAT)}) {
        if (!made) {
            return tl::unexpected(made.error());
        }
    }
    return Feature(std::move(shared));
}

Feature::Feature(std::unique_ptr<Shared> shared) : shared_(std::move(shared)) {}
Feature::Feature(Feature&&) noexcept = default;
Feature& Feature::operator=(Feature&&) noexcept = default;
Feature::~Feature() = default;

tl::expected<void, Error> Feature::begin_frame(const FrameInputs& given) {
    if (given.view >= most_views) {
        return tl::unexpected(Error{"view must be less than " + std::to_string(most_views) + "."});
    }
    if (views_.size() <= given.view) {
        views_.resize(given.view + 1);
    }
    std::unique_ptr<State>& place = views_[given.view];
    if (!place) {
        const FeatureInfo& info = shared_->info;
        auto buffers = HostBuffers::create(
            *info.vk, info.device, info.memory_properties, info.frames_in_flight, info.queue_families,
            {.size_bytes = sizeof(gpu::VolumetricParameters), .usage = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT});
        if (!buffers) {
            return tl::unexpected(buffers.error());
        }
        place = std::make_unique<State>(*shared_, given.view, std::move(*buffers));
    }
    State& state = *place;
    state.frame.reset();
    state.import_bindings.clear();
    state.omissions.clear();
    if (auto valid = validate(given, state.host_buffers->slot_count()); !valid) {
        return valid;
    }
    if (is_empty(given.medium) && extinction_bound(given.fog_particles) <= 0.0F) {
        state.before.reset();
        state.omit("all volumetric passes", "the medium is empty");
        return {};
    }

    FrameInputs inputs = given;
    if (given.settings.grid.law == DepthLawKind::scene) {
        const FittedRange fitted = fitted_range(given, state.before);
        inputs.settings.grid.range_m = fitted.range_m;
        inputs.settings.grid.shape_m = fitted.shape_m;
        if (fitted.range_m < given.settings.grid.range_m) {
            state.omit("slices beyond " + text_of(fitted.range_m) + " m", fitted.why);
        } else {
            state.omit("a range fitted to the view", fitted.why);
        }
    }
    const bool colored = is_colored(inputs.medium);
    if (colored && !shared_->info.dual_source_blending) {
        return tl::unexpected(Error{"Extinction that differs between the channels needs a device with dualSrcBlend, "
                                    "enabled and told by FeatureInfo::dual_source_blending."});
    }
    const bool cold = starts_cold(inputs, state.before);
    if (cold) {
        state.before.reset();
    }
    const AirlightChoice airlight = choose_airlights(inputs, state.before);
    state.tell(airlight, inputs.lights.size());
    FrameState frame{.inputs = inputs, .cold = cold, .colored = colored};
    frame.inputs.lights = froxel_lights(inputs, airlight);
    frame.camera_stands = camera_stands(inputs, state.before);
    frame.parameters = volumetric_parameters(frame.inputs, state.before);
    frame.parameters.airlights = airlights(inputs, airlight);
    write_kept_lights(airlight, frame.parameters);
    frame.airlight_features = airlight_features(inputs, airlight);
    const auto light_count = static_cast<std::uint32_t>(inputs.lights.size());
    frame.cluster_parameters = light_clusters(inputs.settings.grid, light_count, frame.parameters.volume.law);
    frame.particles = gpu_fog_particles(inputs.fog_particles, frame.parameters.density_scale.x);
    frame.particle_clusters = light_clusters(inputs.settings.grid, static_cast<std::uint32_t>(frame.particles.size()),
                                             frame.parameters.volume.law);
    frame.depth_curve = inputs.settings.grid.law == DepthLawKind::curve;
    frame.emission = emission_bound(inputs.medium) > 0.0F;
    frame.sun_shadow = shines(inputs) && inputs.sun->casts_shadows;
    if (light_count > 0) {
        const bool cluster = inputs.settings.clusters && light_count > 1;
        const bool compact = light_count <= TYNDALL_COMPACT_LIGHT_COUNT;
        frame.lights = !cluster ? LocalLights::all : compact ? LocalLights::clustered_compact : LocalLights::clustered;
        const auto casts = [](const gpu::GpuLight& light) { return light.cone.z > 0.5F; };
        frame.local_shadow = std::any_of(inputs.lights.begin(), inputs.lights.end(), casts);
        frame.airlight_shadow = std::any_of(airlight.lights.begin(), airlight.lights.end(),
                                            [&](std::uint32_t i) { return casts(inputs.lights[i]); });
        frame.froxel_shadow =
            std::any_of(frame.inputs.lights.begin(), frame.inputs.lights.end(), [&](const gpu::GpuLight& light) {
                return casts(light) && glm::vec3(light.intensity_type) != glm::vec3(0.0F);
            });
    }
    frame.froxel_lights = airlight.lights.size() < light_count ? frame.lights : LocalLights::none;
    state.frame = frame;
    if (auto made = state.prepare_programs(); !made) {
        state.frame.reset();
        return made;
    }
    state.write_parameters();
    state.host_buffers->write(inputs.frame_slot, state.frame->cluster_parameters);
    if (!state.frame->particles.empty()) {
        state.particle_buffers->write(inputs.frame_slot, std::as_bytes(std::span(state.frame->particles)));
        state.particle_buffers->write(inputs.frame_slot, state.frame->particle_clusters);
    }
    state.before = memory_of(state.frame->inputs, state.frame->parameters);
    state.before->airlights = airlight.lights;
    return {};
}

tl::expected<void, Error> Feature::declare_frame_begin(rg::GraphBuilder& graph, const FrameBeginResources& resources,
                                                       std::uint32_t view) {
    State* const found = find_view(view);
    if (found == nullptr || !found->frame) {
        return {};
    }
    State& state = *found;
    FrameState& frame = *state.frame;
    if (frame.lights != LocalLights::none && !resources.lights.valid()) {
        return tl::unexpected(Error{"lights is not empty, so declare_frame_begin needs the light buffer."});
    }
    frame.light_buffer = resources.lights;
    const HostBuffers::Slot& slot = state.host_buffers->slot(frame.inputs.frame_slot);
    frame.parameter_buffer = graph.import_buffer(
        state.named("volumetric parameters"), {.size_bytes = sizeof(gpu::VolumetricParameters)}, {.read_only = true});
    graph.share_between_queues(frame.parameter_buffer);
    state.import_bindings.push_back({.resource = frame.parameter_buffer.resource, .buffer = slot.data});

    if (frame.inputs.medium.noise.amplitude <= 0.0F) {
        state.omit("density noise", "its amplitude is 0");
    }
    if (frame.parameters.frame.z == 0) {
        state.omit("local volumes", "there is none");
    }
    if (!frame.emission) {
        state.omit("fog emission", "no medium emits");
    }
    if (is_baked(frame.inputs.medium.noise)) {
        state.declare_noise(graph);
    }
    state.declare_textures(graph);
    if (!frame.colored) {
        state.omit("extinction of each channel", "every medium is grey");
    }
    state.declare_particles(graph);
    state.declare_density(graph);
    if (is_clustered(frame.lights)) {
        state.declare_clustering(graph);
    } else if (frame.lights == LocalLights::none) {
        state.omit("light clustering", "there is no local light");
    } else {
        state.omit("light clustering",
                   frame.inputs.lights.size() == 1 ? "there is one local light" : "it is switched off");
    }
    return {};
}

tl::expected<void, Error> Feature::declare_after_shadow_maps(rg::GraphBuilder& graph, const ShadowResources& resources,
                                                             std::uint32_t view) {
    State* const found = find_view(view);
    if (found == nullptr || !found->frame) {
        return {};
    }
    State& state = *found;
    FrameState& frame = *state.frame;
    if (frame.sun_shadow) {
        if (auto declared = state.declare_esm(graph, resources); !declared) {
            return declared;
        }
    } else {
        state.omit("sun shadows (ESM downsample and blur)",
                   shines(frame.inputs) ? "the sun casts no shadow" : "there is no sun");
    }
    if (frame.local_shadow && (!resources.local_maps.valid() || !resources.local_records.valid())) {
        return tl::unexpected(
            Error{"A local light casts shadows (GpuLight::cone.z), so declare_after_shadow_maps needs "
                  "local_maps and local_records."});
    }
    frame.shadow = resources;
    if (!frame.local_shadow) {
        state.omit("shadows of local lights",
                   frame.lights == LocalLights::none ? "there is no local light" : "no local light casts one");
    }
    const LightPath path = frame.inputs.settings.light_path;
    if (!weakens_light(frame.inputs.medium, frame.inputs.settings)) {
        state.omit("weakening of light on its way", path == LightPath::none ? "it is switched off"
                                                    : path == LightPath::march
                                                        ? "no medium takes light"
                                                        : "there is neither homogeneous nor height fog");
    } else if (!light_march(frame.inputs.medium, frame.inputs.settings).is_needed()) {
        state.omit("a march along light's way", path == LightPath::march
                                                    ? "closed forms hold without local volumes and noise of octaves"
                                                    : "it is switched off");
    }
    if (!frame.inputs.settings.temporal.enabled) {
        state.omit("temporal reprojection", "it is switched off");
    }
    if (auto declared = state.declare_lighting(graph, resources); !declared) {
        return declared;
    }
    return state.declare_accumulation(graph);
}

void Feature::declare_after_opaque(rg::GraphBuilder& graph, const OpaqueResources& resources, std::uint32_t view) {
    State* const found = find_view(view);
    if (found != nullptr && found->frame && found->frame->volume) {
        found->declare_fog(graph, resources);
    }
}

Feature::State* Feature::find_view(std::uint32_t view) const {
    return view < views_.size() ? views_[view].get() : nullptr;
}

std::optional<LightWay> Feature::light_way(std::uint32_t view) const {
    const State* const found = find_view(view);
    if (found == nullptr || !found->frame ||
        !weakens_light(found->frame->inputs.medium, found->frame->inputs.settings)) {
        return std::nullopt;
    }
    const gpu::VolumetricParameters& u = found->frame->parameters;
    LightWay way{.colored = found->frame->colored,
                 .march = light_march(found->frame->inputs.medium, found->frame->inputs.settings),
                 .medium = {.air = u.air,
                            .air_heights = u.air_heights,
                            .homogeneous_color = u.homogeneous_color,
                            .height_color = u.height_color,
                            .noise_origin = u.noise_origin,
                            .noise_cells = u.noise_cells,
                            .density_scale = u.density_scale,
                            .march = u.march}};
    std::copy(std::begin(u.volumes), std::end(u.volumes), std::begin(way.medium.volumes));
    return way;
}

const std::optional<ClusterResources>& Feature::clusters(std::uint32_t view) const {
    static const std::optional<ClusterResources> nothing;
    const State* const found = find_view(view);
    return found != nullptr && found->frame ? found->frame->clusters : nothing;
}

const std::optional<VolumeResources>& Feature::volume(std::uint32_t view) const {
    static const std::optional<VolumeResources> nothing;
    const State* const found = find_view(view);
    return found != nullptr && found->frame ? found->frame->volume : nothing;
}

const StageResources& Feature::stages(std::uint32_t view) const {
    static const StageResources nothing;
    const State* const found = find_view(view);
    return found != nullptr && found->frame ? found->frame->stages : nothing;
}

std::span<const rg::ImportBinding> Feature::bindings(std::uint32_t view) const {
    const State* const found = find_view(view);
    return found != nullptr ? std::span<const rg::ImportBinding>(found->import_bindings)
                            : std::span<const rg::ImportBinding>();
}
std::vector<VkImage> Feature::own_images() const {
    std::vector<VkImage> images;
    for (const auto& image : shared_->noise) {
        if (image) {
            images.push_back(image->handle());
        }
    }
    for (const auto& image : shared_->densities) {
        images.push_back(image->handle());
    }
    return images;
}

std::span<const Omission> Feature::omissions(std::uint32_t view) const {
    const State* const found = find_view(view);
    return found != nullptr ? std::span<const Omission>(found->omissions) : std::span<const Omission>();
}

} // namespace tyndall::volumetrics
