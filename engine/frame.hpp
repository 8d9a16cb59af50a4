// What the renderer puts on the blackboard of a frame, and what it takes from it. Features find these by type.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <vulkan/vulkan_core.h>

#include "rendergraph/executor.hpp"
#include "shaders/common/light_medium.h"
#include "shaders/common/lights.h"
#include "shaders/common/sun_shadow.h"

namespace tyndall::engine {

/// View depths between which all surfaces in view lie, as far as their bounds tell.
struct DepthSpan {
    double nearest_m = 0.0; ///< 0 or more
    double farthest_m = 0.0;
};

/// The view of a frame. Render space has world axes, metres and its origin at `origin_m`, the camera's place; view
/// space looks along -Z with +Y up; "depth" is positive view depth -z.
struct FrameView {
    glm::dmat4 view_from_render{1.0}; ///< rotation only
    glm::dmat4 clip_from_view{1.0}; ///< y down, z in [0, 1] reversed: 1 at the near plane, 0 at the far one or infinity
    glm::dvec3 origin_m{0.0};       ///< world
    VkExtent2D size = {1, 1};
    double time_s = 0.0;
    std::uint64_t frame_index = 0;
    std::uint32_t frame_slot = 0;             ///< in [0, frames in flight): Executor::next_slot
    bool cut = false;                         ///< nothing of the frames before may show in this one
    std::optional<DepthSpan> visible_depth_m; ///< empty where no surface is in view
};

/// From the point `frame_begin` on.
struct FrameSun {
    glm::vec3 direction{0.0F, -1.0F, 0.0F}; ///< unit, in which it travels, world axes; any when there is no sun
    glm::vec3 illuminance_lux{0.0F};        ///< zero: no sun
    bool casts_shadows = false;             ///< SunShadow will be there at `after_shadow_maps`
};

/// From the point `frame_begin` on. Without lights `lights` is not valid.
struct SceneLights {
    rg::Buffer lights;                      ///< gpu::GpuLight[], render space
    std::span<const gpu::GpuLight> records; ///< what it holds; valid while the frame is declared
};

/// From the point `after_shadow_maps` on, when the sun casts shadows: see shaders/common/sun_shadow.h.
struct SunShadow {
    rg::Image cascades;    ///< D32 2D array, one layer a cascade
    rg::Buffer parameters; ///< uniform, a gpu::SunCascades
    gpu::SunCascades values;
};

/// From the point `after_shadow_maps` on, when a point or spot light casts shadows: see shaders/common/local_shadow.h.
struct LocalShadows {
    rg::Image maps;     ///< D32 2D array
    rg::Buffer records; ///< gpu::LocalShadow[], storage
};

/// `depth` from `after_depth` on, `color` from `after_opaque` on. Who changes an image puts the new version here.
struct SceneImages {
    rg::Image color; ///< linear radiance, cd/m^2
    rg::Image depth; ///< D32, reverse-Z
};

/// Optional, put by a feature at `frame_begin`: what fills the space between lights and surfaces, and weakens light on
/// its way (shaders/common/light_march.glsl).
struct Air {
    gpu::LightMedium medium{}; ///< in the render space of the frame's view
    // What the march is specialised to:
    bool volumes = false;
    std::uint32_t noise_octaves = 0;
    bool colored = false; ///< its COLORED_EXTINCTION
};

/// The finished picture, from the point `frame_end` on: R8G8B8A8_UNORM holding sRGB-encoded values.
struct FrameOutput {
    rg::Image picture;
};

/// Optional, put by a feature before the forward passes are declared: see shaders/common/light_clusters.h.
struct LightClusters {
    rg::Buffer masks;
    rg::Buffer parameters; ///< uniform, a gpu::LightClusters
};

/// Optional, put by a feature before the transparent pass is declared: see shaders/common/scattering_volume.glsl.
struct ScatteringVolumeImages {
    rg::Image accumulated;
    rg::Image in_scattered;
    rg::Buffer parameters;               ///< uniform, begins with a gpu::ScatteringVolume and gpu::Airlights
    std::uint32_t airlight_features = 0; ///< see shaders/common/airlight.h
    bool colored = false;                ///< its COLORED_EXTINCTION
};

/// Optional, put by a feature whose passes use imports of its own: bound along with the renderer's.
struct FeatureImports {
    std::vector<rg::ImportBinding> bindings;
};

} // namespace tyndall::engine
