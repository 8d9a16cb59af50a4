// What a host tells the feature about one frame: plain values, no engine types.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "features/volumetrics/fog_particle.hpp"
#include "features/volumetrics/settings.hpp"
#include "shaders/common/lights.h"

#include <vulkan/vulkan_core.h>

namespace tyndall::volumetrics {

/// Matrices without jitter. Render space has world axes, metres and its origin at `origin_m`, which for a perspective
/// view is the eye. View space looks along -Z, +Y up.
struct Camera {
    glm::dmat4 view_from_render{1.0}; ///< rigid, without translation
    glm::dmat4 clip_from_view{1.0};   ///< the host's own clip space: any depth direction, Vulkan's framebuffer xy
    glm::dvec3 origin_m{0.0};         ///< world position of render space's origin
};

struct Sun {
    glm::vec3 direction{0.0F, -1.0F, 0.0F}; ///< unit, the direction in which it travels, world axes
    glm::vec3 illuminance_lux{0.0F};
    bool casts_shadows = false; ///< cascades will be given to declare_after_shadow_maps
};

/// View depths between which all visible surfaces lie.
struct DepthSpan {
    double nearest_m = 0.0; ///< 0 or more
    double farthest_m = 0.0;
};

struct FrameInputs {
    Medium medium;
    Settings settings;
    Camera camera;
    glm::uvec2 image_size{0}; ///< pixels, at least 1; another size than the frame before's begins anew
    /// Columns of the grid's images, no fewer than the grid's: a grid that changes its size keeps its images. 0: as
    /// many.
    glm::uvec2 allocated_columns{0};
    std::optional<DepthSpan> visible_depth_m; ///< for the depth law `scene`
    std::optional<Sun> sun;
    /// What the buffer given to declare_frame_begin holds, in the same order; intensities in [0, 1e12] cd.
    std::vector<gpu::GpuLight> lights;
    /// Added to the fog after the medium's volumes and before its noise, in any order.
    std::vector<FogParticle> fog_particles;
    /// Moves the noise with its wind, [-1e10, 1e10]: double precision then still holds a thousandth of a cell of noise
    /// that moves by 100 cells a second.
    double time_s = 0.0;
    bool cut = false;             ///< history and jitter start anew
    std::uint32_t view = 0;       ///< which of the host's views this is, less than Feature::most_views
    std::uint32_t frame_slot = 0; ///< in [0, frames_in_flight): Executor::next_slot
    VkFormat color_format = VK_FORMAT_R16G16B16A16_SFLOAT; ///< of the image given to declare_after_opaque
};

/// The first value outside its domain, medium and settings included. `slots`: the feature's frames in flight.
[[nodiscard]] tl::expected<void, Error> validate(const FrameInputs& inputs, std::uint32_t slots);

} // namespace tyndall::volumetrics
