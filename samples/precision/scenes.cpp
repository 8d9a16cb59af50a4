// The scenes of the precision study. All are seen from the inside of something, so that every ray ends within the grid.
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "samples/precision/scene.hpp"

namespace tyndall::samples {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

reference::Camera look(const glm::dvec3& from, const glm::dvec3& at, double fov_y_degrees) {
    return {glm::inverse(glm::lookAt(from, at, glm::dvec3(0.0, 1.0, 0.0))), fov_y_degrees * degree, std::nullopt};
}

PrecisionScene slab() {
    PrecisionScene scene;
    scene.name = "slab";
    scene.about = "even fog before a wall, an unshadowed sun and ambient light";
    scene.surfaces = {{{{glm::dvec3(-80.0, -50.0, -30.0), glm::dvec3(80.0, -50.0, -30.0), glm::dvec3(80.0, 50.0, -30.0),
                         glm::dvec3(-80.0, 50.0, -30.0)}},
                       glm::dvec3(0.6, 0.5, 0.4)}};
    scene.fog.medium.homogeneous = {.extinction_per_m = 0.04F, .albedo = {0.9F, 0.95F, 1.0F}};
    scene.fog.medium.phase_g = 0.3F;
    scene.fog.medium.ambient_radiance = {0.1F, 0.12F, 0.15F};
    scene.camera = look({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}, 50.0);
    scene.sun = reference::DirectionalLight{glm::normalize(glm::dvec3(0.4, -1.0, -0.6)), glm::dvec3(10.0, 9.5, 9.0)};
    scene.surroundings.ambient_up = scene.surroundings.ambient_down = glm::dvec3(0.2);
    return scene;
}

PrecisionScene height_fog() {
    PrecisionScene scene;
    scene.name = "height_fog";
    scene.about = "a valley of fog that thins out above, under a slanting sun";
    scene.surfaces = {make_room({-60.0, -2.0, -55.0}, {60.0, 45.0, 5.0}, glm::dvec3(0.4))};
    scene.surfaces[0].quads.erase(scene.surfaces[0].quads.begin() + 3); // no ceiling
    scene.surfaces.push_back(make_box({-12.0, -2.0, -30.0}, {-8.0, 9.0, -26.0}, glm::dvec3(0.6, 0.3, 0.2)));
    scene.fog.medium.height = {
        .extinction_per_m = 0.08F, .albedo = glm::vec3(0.95F), .base_height_m = -1.0F, .falloff_per_m = 0.25F};
    scene.fog.medium.phase_g = 0.5F;
    scene.fog.medium.ambient_radiance = glm::vec3(0.1F);
    scene.camera = look({0.0, 3.0, 0.0}, {0.0, 3.5, -8.0}, 50.0);
    scene.sun = reference::DirectionalLight{glm::normalize(glm::dvec3(0.5, -0.9, 0.3)), glm::dvec3(20.0, 18.0, 15.0)};
    scene.surroundings = {.ambient_up = glm::dvec3(0.3), .ambient_down = glm::dvec3(0.1)};
    return scene;
}

PrecisionScene shafts() {
    PrecisionScene scene;
    scene.name = "shafts";
    scene.about = "shafts of sunlight through a slatted roof";
    scene.surfaces = {make_room({-12.0, 0.0, -38.0}, {12.0, 14.0, 2.0}, glm::dvec3(0.5))};
    scene.surfaces[0].quads.erase(scene.surfaces[0].quads.begin() + 3); // the slats are the ceiling
    for (int i = 0; i < 16; ++i) {
        const double z = -38.0 + 2.5 * i;
        scene.surfaces.push_back(make_box({-13.0, 14.0, z}, {13.0, 14.2, z + 1.6}, glm::dvec3(0.3)));
    }
    scene.fog.medium.homogeneous = {.extinction_per_m = 0.02F, .albedo = glm::vec3(1.0F)};
    scene.fog.medium.phase_g = 0.4F;
    scene.fog.medium.ambient_radiance = glm::vec3(0.05F);
    // No row of pixel centres lies within 7 mm of a shadow's edge on the floor, where the exact picture, a value at a
    // point, would hang on millimetres.
    scene.camera = look({0.0, 2.0, 0.0}, {0.0, 0.9, -8.0}, 50.0);
    scene.sun = reference::DirectionalLight{glm::normalize(glm::dvec3(0.15, -1.0, 0.45)), glm::dvec3(60.0, 55.0, 45.0)};
    scene.surroundings.ambient_up = scene.surroundings.ambient_down = glm::dvec3(0.1);
    return scene;
}

PrecisionScene point_light() {
    PrecisionScene scene;
    scene.name = "point_light";
    scene.about = "a point light in view, a few centimetres from some of the rays";
    scene.surfaces = {make_room({-6.0, -2.0, -14.0}, {6.0, 4.0, 2.0}, glm::dvec3(0.5, 0.45, 0.4))};
    scene.fog.medium.homogeneous = {.extinction_per_m = 0.05F, .albedo = glm::vec3(1.0F)};
    scene.fog.medium.phase_g = 0.3F;
    scene.camera = look({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}, 50.0);
    scene.lights = {
        reference::Light{.position = {0.7, 0.4, -6.0}, .intensity_cd = glm::dvec3(40.0, 36.0, 30.0), .range_m = 30.0}};
    scene.surroundings.ambient_up = scene.surroundings.ambient_down = glm::dvec3(0.02);
    return scene;
}

PrecisionScene spots() {
    PrecisionScene scene;
    scene.name = "spots";
    scene.about = "three spot lights among pillars, forward scattering of g = 0.7";
    scene.surfaces = {make_room({-8.0, 0.0, -24.0}, {8.0, 7.0, 2.0}, glm::dvec3(0.5))};
    for (int i = 0; i < 6; ++i) {
        const double x = i % 2 == 0 ? -3.0 : 3.0;
        const int pair = i / 2;
        const double z = -6.0 - 5.0 * pair;
        scene.surfaces.push_back(make_box({x - 0.4, 0.0, z - 0.4}, {x + 0.4, 7.0, z + 0.4}, glm::dvec3(0.7, 0.6, 0.5)));
    }
    scene.fog.medium.homogeneous = {.extinction_per_m = 0.06F, .albedo = glm::vec3(0.95F)};
    scene.fog.medium.phase_g = 0.7F;
    scene.camera = look({0.0, 2.0, 0.0}, {0.0, 2.2, -8.0}, 50.0);
    const auto spot = [&](const glm::dvec3& position, const glm::dvec3& at, const glm::dvec3& color) {
        scene.lights.push_back({.position = position,
                                .intensity_cd = 300.0 * color,
                                .range_m = 40.0,
                                .cone = reference::Cone{glm::normalize(at - position), 12.0 * degree, 22.0 * degree}});
    };
    spot({-6.5, 5.5, -9.0}, {3.0, 0.5, -11.5}, {1.0, 0.8, 0.6});
    spot({6.5, 5.5, -14.0}, {-3.0, 1.0, -12.0}, {0.6, 0.8, 1.0});
    spot({0.0, 6.0, -22.0}, {0.0, 0.5, -10.0}, {1.0, 1.0, 1.0});
    scene.surroundings.ambient_up = scene.surroundings.ambient_down = glm::dvec3(0.05);
    return scene;
}

PrecisionScene noise() {
    PrecisionScene scene;
    scene.name = "noise";
    scene.about = "drifting patches of fog under a sun and beside a point light";
    scene.surfaces = {make_room({-14.0, -1.0, -30.0}, {14.0, 20.0, 3.0}, glm::dvec3(0.4))};
    scene.surfaces[0].quads.erase(scene.surfaces[0].quads.begin() + 3); // no ceiling
    scene.fog.medium.height = {
        .extinction_per_m = 0.15F, .albedo = glm::vec3(1.0F), .base_height_m = 0.0F, .falloff_per_m = 0.3F};
    scene.fog.medium.noise = {.amplitude = 0.8F, .scale_m = 3.0F, .wind_m_s = {0.5F, 0.0F, 0.1F}};
    scene.fog.medium.phase_g = 0.3F;
    scene.fog.medium.ambient_radiance = glm::vec3(0.1F);
    scene.time_s = 4.0;
    scene.camera = look({0.0, 2.0, 0.0}, {0.0, 2.2, -8.0}, 50.0);
    scene.sun = reference::DirectionalLight{glm::normalize(glm::dvec3(0.3, -1.0, 0.2)), glm::dvec3(15.0)};
    scene.lights = {{.position = {-7.0, 3.0, -12.0}, .intensity_cd = glm::dvec3(60.0, 50.0, 40.0), .range_m = 20.0}};
    scene.surroundings.ambient_up = scene.surroundings.ambient_down = glm::dvec3(0.2);
    scene.pixels = 1500;
    return scene;
}

} // namespace

const std::vector<PrecisionScene>& precision_scenes() {
    static const std::vector<PrecisionScene> scenes{slab(), height_fog(), shafts(), point_light(), spots(), noise()};
    return scenes;
}

} // namespace tyndall::samples
