// What the reference renders: plain values in double precision. Light in glTF's units (lux, candela), metres, +Y up.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "features/volumetrics/reference/geometry.hpp"
#include "features/volumetrics/settings.hpp"

namespace tyndall::volumetrics::reference {

struct DirectionalLight {
    glm::dvec3 direction{0.0, -1.0, 0.0}; ///< unit, in which it travels
    glm::dvec3 illuminance_lux{0.0};
    bool casts_shadows = true;
};

/// KHR_lights_punctual's spot: full intensity within `inner_rad` of the axis, none beyond `outer_rad`.
struct Cone {
    glm::dvec3 direction{0.0, -1.0, 0.0}; ///< unit, in which the light travels
    double inner_rad = 0.0;
    double outer_rad = 0.785398163397448;
};

/// A point light, or a spot light if it has a cone. Its irradiance is intensity / max(d^2, radius^2), times
/// 1 - (d / range)^4, which is 0 from the range on.
struct Light {
    glm::dvec3 position{0.0};
    glm::dvec3 intensity_cd{0.0};
    double radius_m = 0.02;
    double range_m = std::numeric_limits<double>::infinity();
    std::optional<Cone> cone;
    bool casts_shadows = true;
};

/// What surfaces receive besides lights, and what a ray sees that hits none; radiance, cd/m^2. A surface of normal n
/// gets the mean of `ambient_up` and `ambient_down` with the weight (1 + n.y) / 2 for up. The background lies between
/// horizon and zenith by 1 - (1 - y)^3 of the direction's y >= 0, and turns into ground over y in [-1/8, 0].
struct Surroundings {
    glm::dvec3 ambient_up{0.0};
    glm::dvec3 ambient_down{0.0};
    glm::dvec3 zenith{0.0};
    glm::dvec3 horizon{0.0};
    glm::dvec3 ground{0.0};
};

/// Looks along its own -Z with +Y up.
struct Camera {
    glm::dmat4 world_from_camera{1.0}; ///< rigid
    double fov_y_rad = 0.785398163397448;
    std::optional<double> orthographic_half_height_m; ///< present: parallel rays
};

/// Light that is scattered once. It loses what the medium takes on its way to a particle or a surface and from there to
/// the eye; ambient radiance is the same everywhere.
struct Scene {
    Geometry geometry;
    Medium medium;
    double time_s = 0.0; ///< moves the noise with its wind
    std::optional<DirectionalLight> sun;
    std::vector<DirectionalLight> fills; ///< light surfaces only, without shadows and without loss
    std::vector<Light> lights;
    Surroundings surroundings;
    bool attenuates_light =
        true; ///< false: a simpler physics, in which light reaches particles and surfaces unweakened
};

} // namespace tyndall::volumetrics::reference
