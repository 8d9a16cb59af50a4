// Which of a scene's lights do what in a frame. Pure functions.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/scene.hpp"
#include "shaders/common/lights.h"

namespace tyndall::engine {

/// Directional lights beside the sun that are computed; they cast no shadows.
inline constexpr std::size_t most_fill_lights = 3;

struct LightSettings {
    /// A point or spot light without a range of its own ends where its illuminance falls below this.
    double threshold_lux = 0.05;
    /// Of every point and spot light. Inside it the light grows no brighter.
    double source_radius_m = 0.02;
};

struct DirectionalLight {
    glm::dvec3 direction{0.0, -1.0, 0.0}; ///< unit, world, the way that light travels
    glm::vec3 illuminance_lux{0.0F};
};

/// A scene's lights by what they need.
struct LightRoles {
    std::optional<DirectionalLight> sun; ///< the brightest directional light
    std::vector<DirectionalLight> fills; ///< the next brightest, most_fill_lights at most
    std::vector<Light> local;            ///< point and spot, in the scene's order; dark ones left out
    std::vector<std::string> notes;      ///< a sentence for each thing left out
};
[[nodiscard]] LightRoles assign_lights(const Scene& scene);

/// Where a point or spot light ends, m.
[[nodiscard]] double light_range_m(const Light& light, const LightSettings& settings);

/// `light` is a point or spot light. Without a shadow.
[[nodiscard]] gpu::GpuLight make_gpu_light(const Light& light, const glm::dvec3& origin_m,
                                           const LightSettings& settings);

/// Relative luminance of a linear Rec. 709 colour.
[[nodiscard]] float luminance(const glm::vec3& color);

} // namespace tyndall::engine
