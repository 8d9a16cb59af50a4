#pragma once

#include <array>

#include <glm/glm.hpp>

#include "samples/hall/materials.hpp"
#include "samples/hall/scene.hpp"

namespace tyndall::hall {

// The plan of the hall, metres. The long axis is z, the floor y = 0; the windows and the sun are on the +x side.
constexpr float half_width_m = 7.0F;
constexpr float half_length_m = 17.5F;
constexpr float wall_thickness_m = 0.6F;
constexpr float bay_m = 5.0F;
constexpr int bay_count = 7;
constexpr float arcade_x_m = 3.6F; // axis of each row of pillars
constexpr float arcade_half_thickness_m = 0.4F;
constexpr float capital_top_m = 5.2F;
constexpr float aisle_ceiling_m = 8.4F;
constexpr float roof_low_m = 12.7F;
constexpr float roof_high_m = 13.3F;
constexpr float dais_height_m = 0.66F;
constexpr float dais_front_z_m = -11.2F;
constexpr std::array<float, 6> pillar_z_m{-12.5F, -7.5F, -2.5F, 2.5F, 7.5F, 12.5F};

/// Where the braziers stand: the smoke rises from their bowls.
constexpr std::array<glm::vec3, 3> brazier_positions_m{
    glm::vec3{-2.0F, dais_height_m, -13.6F}, glm::vec3{2.0F, dais_height_m, -13.6F}, glm::vec3{1.0F, 0.0F, 0.4F}};
constexpr float brazier_bowl_m = 1.0F; // height of the coals above the foot

// The outer edge of the window openings; inside they are wider, so that slanting light passes.
constexpr float window_half_width_m = 1.10F;
constexpr float window_sill_m = 2.1F;
constexpr float window_spring_m = 5.6F;
constexpr float window_pointedness = 1.4F;

/// Middle of a bay along z; bay 0 is the one at the dais.
[[nodiscard]] constexpr float bay_center_m(int bay) {
    return bay_m * (static_cast<float>(bay) - 0.5F * static_cast<float>(bay_count - 1));
}

/// Floor, walls with windows, pillars, arcades, vault, roof and dais.
void add_architecture(Scene& scene, const Materials& materials);

/// Lanterns, chandeliers and braziers, with the point lights that burn in them.
void add_lamps(Scene& scene, const Materials& materials);

/// Benches, crates, barrels, urns and banners.
void add_furniture(Scene& scene, const Materials& materials);

/// Iron grilles, leaded windows and hanging panes of coloured glass.
void add_glasswork(Scene& scene, const Materials& materials);

/// The sun, the coloured spots and the cameras.
void add_sun_and_cameras(Scene& scene);

} // namespace tyndall::hall
