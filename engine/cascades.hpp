// Where the sun's shadow cascades lie: four squares across the light's direction that follow the view in whole texels.
// Pure functions.
//
// Each cascade holds a sphere around its slice of the view, so that its size depends on the lens alone and turning the
// camera changes nothing (Valient, Stable Rendering of Cascaded Shadow Maps, ShaderX6, 2008). Its middle moves in whole
// texels of a grid that is fixed in the world, so that a resting caster always falls on the same texels. Depth spans
// all casters of the scene, the same for every cascade.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/frame.hpp"
#include "engine/scene.hpp"
#include "shaders/common/sun_shadow.h"

namespace tyndall::engine {

inline constexpr std::uint32_t most_cascades = 4;

struct CascadeSettings {
    std::uint32_t count = 4;         ///< 1 to 4
    std::uint32_t resolution = 2048; ///< texels of a side, [64, 8192]
    std::optional<double> range_m;   ///< view depth up to which there are shadows; absent: as far as the scene reaches
    double log_share = 0.5;          ///< 0: slices of equal length; 1: of equal ratio
};

/// One cascade in light space: x and y across the light's direction, z along it, origin at the world's.
struct CascadeFit {
    glm::dvec2 center_m{0.0}; ///< a whole number of texels
    double texel_m = 1.0;
    double start_depth_m = 0.0; ///< view depths of the slice that it holds
    double end_depth_m = 0.0;
    double farthest_m = 0.0; ///< z behind which no caster shadows the slice

    friend bool operator==(const CascadeFit&, const CascadeFit&) = default;
};

struct CascadesFit {
    glm::dmat3 light_from_world{1.0}; ///< rotation; z is the direction in which light travels
    std::array<CascadeFit, most_cascades> cascades{};
    std::uint32_t count = 0;
    std::uint32_t resolution = 0;
    double near_m = 0.0;  ///< light space z where stored depth is 0
    double range_m = 1.0; ///< metres that stored depth 1 spans
};

/// `casters` is not empty; `direction` is of unit length, world axes, the way that light travels.
[[nodiscard]] CascadesFit fit_cascades(const FrameView& view, const Box& casters, const glm::dvec3& direction,
                                       const CascadeSettings& settings);

/// A cascade's texels hold the same as before: its image need not be drawn again as long as the scene is the same.
[[nodiscard]] bool same_texels(const CascadesFit& a, const CascadesFit& b, std::uint32_t cascade);

/// uv and depth in [0, 1] from render space.
[[nodiscard]] glm::dmat4 shadow_from_render(const CascadesFit& fit, std::uint32_t cascade, const glm::dvec3& origin_m);

[[nodiscard]] gpu::SunCascades make_sun_cascades(const CascadesFit& fit, const glm::dvec3& origin_m,
                                                 const glm::vec3& illuminance_lux);

/// False only if what is inside `box` (world space) throws no shadow into the cascade.
[[nodiscard]] bool may_cast_into(const CascadesFit& fit, std::uint32_t cascade, const Box& box);

} // namespace tyndall::engine
