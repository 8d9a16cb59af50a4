// Which point and spot lights of a frame cast shadows, and where their shadow maps look. Pure functions.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "engine/lights.hpp"
#include "engine/scene.hpp"
#include "shaders/common/local_shadow.h"

namespace tyndall::engine {

struct LocalShadowSettings {
    bool spots = true;               ///< what a light's own Light::casts_shadow leaves open
    bool points = false;             ///< they often stand within the flame or the lantern that they light
    std::uint32_t resolution = 1024; ///< texels of a side of a map, [64, 8192]
    std::uint32_t most_maps = 16;    ///< in memory; a spot light needs one, a point light six; [0, 256]
    double spot_near_m = 0.05;       ///< what Light::shadow_near_m leaves open, m, > 0
    double point_near_m = 0.3;
};

/// Spot lights with a wider cone (half angle) are treated as point lights: one view across it would waste its texels at
/// the rim, and none holds a half sphere.
inline constexpr float widest_single_map_rad = 1.0F;
inline constexpr std::uint32_t cube_sides = 6;

/// Layers of the array that the light's shadow needs.
[[nodiscard]] std::uint32_t shadow_map_count(const Light& light);

/// A light with a shadow map.
struct ShadowedLight {
    std::uint32_t light = 0;       ///< index into LightRoles::local
    std::uint32_t first_layer = 0; ///< of the array of maps
    std::uint32_t map_count = 1;

    friend bool operator==(const ShadowedLight&, const ShadowedLight&) = default;
};

struct LocalShadowPlan {
    std::vector<ShadowedLight> lights; ///< in the order of their indices
    std::uint32_t map_count = 0;       ///< of `lights` together
    std::uint32_t most_maps = 0;       ///< that may come into use wherever the eye is
    std::vector<std::string> without;  ///< a sentence for each light that should cast shadows and gets no map
    std::string why_none;              ///< where `lights` is empty
};

/// Maps go to the lights that are brightest at the eye, as far as `most_maps` reaches; one of `before` keeps its map
/// until another is a quarter brighter. A light that no caster's bounds reach (`casters`: those of all) gets none.
[[nodiscard]] LocalShadowPlan plan_local_shadows(std::span<const Light> lights, std::span<const Box> casters,
                                                 const glm::dvec3& eye_m, const LocalShadowSettings& settings,
                                                 const LightSettings& light_settings,
                                                 std::span<const ShadowedLight> before);

/// See shaders/common/local_shadow.h.
[[nodiscard]] gpu::LocalShadow make_local_shadow(const Light& light, const ShadowedLight& shadowed,
                                                 const glm::dvec3& origin_m, const LocalShadowSettings& settings);

/// False only if what is inside `box` (world space) throws no shadow into the map. `range_m`: the light's.
[[nodiscard]] bool may_cast_into(const Light& light, std::uint32_t side, double range_m, const Box& box);

} // namespace tyndall::engine
