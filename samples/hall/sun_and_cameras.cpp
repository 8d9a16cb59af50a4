#include <cmath>
#include <numbers>

#include "samples/hall/layout.hpp"

namespace tyndall::hall {
namespace {

constexpr float degree = std::numbers::pi_v<float> / 180.0F;

} // namespace

void add_sun_and_cameras(Scene& scene) {
    // A low evening sun in haze. It stands on the window side and toward -z, so that a camera looking down the hall has
    // it ahead and a little to the right: light scattered forward in the fog reaches the camera.
    constexpr float elevation = 30.0F * degree;
    constexpr float azimuth = 40.0F * degree; // from the normal of the window wall
    const glm::vec3 travel{-std::cos(elevation) * std::cos(azimuth), -std::sin(elevation),
                           std::cos(elevation) * std::sin(azimuth)};
    scene.add_light(
        {.name = "sun", .kind = LightKind::directional, .color = {1.0F, 0.76F, 0.48F}, .intensity = 4500.0F},
        {30.0F, 25.0F, -25.0F}, travel);

    const auto spot = [&](const char* name, glm::vec3 color, float intensity, glm::vec3 from, glm::vec3 at) {
        scene.add_light({.name = name,
                         .kind = LightKind::spot,
                         .color = color,
                         .intensity = intensity,
                         .range_m = 12.0F,
                         .inner_cone_rad = 9.0F * degree,
                         .outer_cone_rad = 17.0F * degree},
                        from, at - from);
    };
    // Stage lamps that point toward the camera: their cones show because fog scatters mostly forward.
    spot("cobalt_spot", {0.14F, 0.32F, 1.0F}, 42000.0F, {-2.5F, 8.1F, -8.5F}, {-1.5F, 0.0F, -2.2F});
    spot("rose_spot", {1.0F, 0.14F, 0.36F}, 26000.0F, {2.5F, 8.1F, -13.5F}, {0.9F, 0.4F, -7.5F});
    spot("violet_spot", {0.50F, 0.18F, 1.0F}, 16000.0F, {0.0F, 10.6F, -12.0F}, {0.0F, 3.4F, -17.2F});
    spot("emerald_spot", {0.10F, 0.95F, 0.50F}, 16000.0F, {-5.5F, 8.0F, -4.0F}, {-5.6F, 0.0F, 1.0F});

    scene.add_camera({.name = "hero", .vertical_field_of_view_rad = 54.0F * degree}, {-2.0F, 1.65F, 12.4F},
                     {2.0F, 3.25F, -2.0F});
    scene.add_camera({.name = "overview", .vertical_field_of_view_rad = 60.0F * degree}, {-2.2F, 5.6F, 16.6F},
                     {1.2F, 3.2F, 0.0F});
    scene.add_camera({.name = "lantern_and_glass", .vertical_field_of_view_rad = 50.0F * degree}, {-1.9F, 2.1F, 6.3F},
                     {-0.55F, 2.2F, 0.0F});
}

} // namespace tyndall::hall
