#include "engine/scene_defaults.hpp"

#include <algorithm>
#include <cmath>

#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace tyndall::engine {
namespace {

const glm::dvec3 up(0.0, 1.0, 0.0);

} // namespace

Camera make_framing_camera(const Box& bounds) {
    Camera camera;
    camera.name = "framing";
    if (bounds.empty()) {
        camera.world_from_camera = glm::translate(glm::dmat4(1.0), glm::dvec3(0.0, 0.0, 5.0));
        return camera;
    }
    const double radius_m = std::max(0.5 * glm::length(bounds.extent()), 1e-3);
    const double distance_m = 1.02 * radius_m / std::sin(0.5 * camera.perspective.fov_y_rad);
    const glm::dvec3 toward_camera = glm::normalize(glm::dvec3(0.75, 0.5, 1.0));
    const glm::dvec3 eye = bounds.center() + distance_m * toward_camera;
    camera.world_from_camera = glm::inverse(glm::lookAt(eye, bounds.center(), up));
    camera.perspective.near_m = 0.02 * radius_m;
    return camera;
}

Light make_sun(const Camera& camera) {
    constexpr float illuminance_lux = 20000.0F;
    constexpr double altitude_rad = 40.0 / 180.0 * glm::pi<double>();
    constexpr double turn_rad = 50.0 / 180.0 * glm::pi<double>();
    // The camera's heading in the ground plane; one that looks straight up or down has its upper edge as heading.
    glm::dvec3 heading = -glm::dvec3(camera.world_from_camera[2]);
    if (std::hypot(heading.x, heading.z) < 1e-3) {
        heading = glm::dvec3(camera.world_from_camera[1]) * (heading.y > 0.0 ? -1.0 : 1.0);
    }
    const double azimuth = std::atan2(heading.x, -heading.z) + turn_rad;
    Light sun;
    sun.name = "sun";
    sun.type = LightType::directional;
    sun.intensity = illuminance_lux * glm::vec3(1.0F, 0.96F, 0.9F);
    sun.direction = glm::dvec3(std::sin(azimuth) * std::cos(altitude_rad), -std::sin(altitude_rad),
                               -std::cos(azimuth) * std::cos(altitude_rad));
    return sun;
}

void complete_scene(Scene& scene) {
    if (scene.cameras.empty()) {
        scene.cameras.push_back(make_framing_camera(scene.bounds));
        scene.notes.push_back("The scene has no camera: one that frames it from the front, right and above is used.");
    }
    if (scene.lights.empty()) {
        scene.lights.push_back(make_sun(scene.cameras.front()));
        scene.notes.push_back("The scene has no light: a sun of 20,000 lux from behind the camera's left is used.");
    }
}

} // namespace tyndall::engine
