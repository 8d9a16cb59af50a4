#include "samples/tyndall/volumetrics_glue.hpp"

namespace tyndall::samples {

void add_imports(rg::Blackboard& blackboard, std::span<const rg::ImportBinding> bindings) {
    engine::FeatureImports* imports = blackboard.find<engine::FeatureImports>();
    if (imports == nullptr) {
        imports = &blackboard.put(engine::FeatureImports{});
    }
    imports->bindings.insert(imports->bindings.end(), bindings.begin(), bindings.end());
}

tl::expected<VolumetricsGlue, engine::Error>
VolumetricsGlue::create(const engine::Device& device, VkPipelineCache cache, std::uint32_t frames_in_flight,
                        VkFormat color_format, volumetrics::Fog fog, bool check_bindings) {
    tl::expected<volumetrics::Feature, volumetrics::Error> feature =
        volumetrics::Feature::create({.vk = &device.vk(),
                                      .device = device.handle(),
                                      .pipeline_cache = cache,
                                      .memory_properties = device.memory_properties(),
                                      .frames_in_flight = frames_in_flight,
                                      .dual_source_blending = device.info().dual_source_blending,
                                      .queue_families = device.queue_families(),
                                      .check_bindings = check_bindings});
    if (!feature) {
        return tl::unexpected(engine::Error{feature.error().message});
    }
    VolumetricsGlue glue;
    glue.feature_ = std::move(*feature);
    glue.fog_ = std::move(fog);
    glue.color_format_ = color_format;
    return glue;
}

tl::expected<void, engine::Error> VolumetricsGlue::attach(rg::InjectionPoints& points) {
    const auto at = [&](std::string_view point, void (VolumetricsGlue::*declare)(rg::GraphBuilder&, rg::Blackboard&)) {
        return points.add(point, 0, [this, declare](rg::GraphBuilder& graph, rg::Blackboard& blackboard) {
            if (enabled_) {
                (this->*declare)(graph, blackboard);
            }
        });
    };
    for (const auto& refused : {at("frame_begin", &VolumetricsGlue::frame_begin),
                                at("after_shadow_maps", &VolumetricsGlue::after_shadow_maps),
                                at("after_opaque", &VolumetricsGlue::after_opaque)}) {
        if (refused) {
            return tl::unexpected(engine::Error{refused->message});
        }
    }
    return {};
}

void VolumetricsGlue::keep_error(const tl::expected<void, volumetrics::Error>& result) {
    if (!result) {
        error_ = engine::Error{result.error().message};
    }
}

void VolumetricsGlue::frame_begin(rg::GraphBuilder& graph, rg::Blackboard& blackboard) {
    error_.reset();
    const engine::FrameView& view = *blackboard.find<engine::FrameView>();
    const engine::FrameSun& sun = *blackboard.find<engine::FrameSun>();
    const engine::SceneLights& lights = *blackboard.find<engine::SceneLights>();
    volumetrics::FrameInputs inputs;
    inputs.medium = fog_.medium;
    inputs.settings = fog_.settings;
    inputs.camera = {view.view_from_render, view.clip_from_view, view.origin_m};
    if (view.visible_depth_m) {
        inputs.visible_depth_m = {view.visible_depth_m->nearest_m, view.visible_depth_m->farthest_m};
    }
    inputs.image_size = {view.size.width, view.size.height};
    if (sun.illuminance_lux != glm::vec3(0.0F)) {
        inputs.sun = volumetrics::Sun{sun.direction, sun.illuminance_lux, sun.casts_shadows};
    }
    inputs.lights.assign(lights.records.begin(), lights.records.end());
    inputs.time_s = view.time_s;
    inputs.cut = view.cut;
    inputs.frame_slot = view.frame_slot;
    inputs.color_format = color_format_;
    keep_error(feature_->begin_frame(inputs));
    if (!error_) {
        keep_error(feature_->declare_frame_begin(graph, {.lights = lights.lights}));
    }
    if (const std::optional<volumetrics::LightWay> way = feature_->light_way()) {
        blackboard.put(engine::Air{way->medium, way->march.volumes, way->march.octaves, way->colored});
    }
    if (feature_->clusters()) {
        blackboard.put(engine::LightClusters{feature_->clusters()->masks, feature_->clusters()->parameters});
    }
}

void VolumetricsGlue::after_shadow_maps(rg::GraphBuilder& graph, rg::Blackboard& blackboard) {
    volumetrics::ShadowResources shadow;
    if (const engine::SunShadow* sun = blackboard.find<engine::SunShadow>()) {
        shadow = {.cascades = sun->cascades, .parameters = sun->parameters};
    }
    if (const engine::LocalShadows* local = blackboard.find<engine::LocalShadows>()) {
        shadow.local_maps = local->maps;
        shadow.local_records = local->records;
    }
    keep_error(feature_->declare_after_shadow_maps(graph, shadow));
    if (feature_->volume()) {
        const volumetrics::VolumeResources& volume = *feature_->volume();
        blackboard.put(engine::ScatteringVolumeImages{volume.accumulated, volume.in_scattered, volume.parameters,
                                                      volume.airlight_features, volume.colored});
    }
}

void VolumetricsGlue::after_opaque(rg::GraphBuilder& graph, rg::Blackboard& blackboard) {
    engine::SceneImages& images = *blackboard.find<engine::SceneImages>();
    feature_->declare_after_opaque(graph, {.color = images.color, .depth = images.depth});
    add_imports(blackboard, feature_->bindings());
}

} // namespace tyndall::samples
