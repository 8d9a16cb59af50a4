#include "samples/hall/scene.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tyndall::hall {
namespace {

/// Rotation that takes -Z, where cameras and lights of glTF look, to `direction`.
glm::quat looking_along(glm::vec3 direction) {
    const glm::vec3 unit = glm::normalize(direction);
    const glm::vec3 up = std::abs(unit.y) > 0.99F ? glm::vec3{0.0F, 0.0F, 1.0F} : glm::vec3{0.0F, 1.0F, 0.0F};
    return glm::quatLookAt(unit, up);
}

} // namespace

Geometry& Mesh::part(std::size_t material) {
    const auto found = std::find_if(parts.begin(), parts.end(), [&](const Part& p) { return p.material == material; });
    if (found != parts.end()) {
        return found->geometry;
    }
    parts.push_back({material, {}});
    return parts.back().geometry;
}

std::size_t Scene::add_texture(std::string file_name, Image image) {
    textures.push_back({std::move(file_name), std::move(image)});
    return textures.size() - 1;
}

std::size_t Scene::add_material(Material material) {
    materials.push_back(std::move(material));
    return materials.size() - 1;
}

std::size_t Scene::add_mesh(Mesh mesh) {
    meshes.push_back(std::move(mesh));
    return meshes.size() - 1;
}

void Scene::place(std::size_t mesh, glm::vec3 position, float turn_rad, float scale) {
    nodes.push_back({.name = meshes[mesh].name,
                     .translation = position,
                     .rotation = glm::angleAxis(turn_rad, glm::vec3{0.0F, 1.0F, 0.0F}),
                     .scale = scale,
                     .mesh = mesh});
}

void Scene::add_light(Light light, glm::vec3 position, glm::vec3 direction) {
    nodes.push_back(
        {.name = light.name,
         .translation = position,
         .rotation = light.kind == LightKind::point ? glm::quat{1.0F, 0.0F, 0.0F, 0.0F} : looking_along(direction),
         .light = lights.size()});
    lights.push_back(std::move(light));
}

void Scene::add_camera(Camera camera, glm::vec3 eye, glm::vec3 target) {
    nodes.push_back(
        {.name = camera.name, .translation = eye, .rotation = looking_along(target - eye), .camera = cameras.size()});
    cameras.push_back(std::move(camera));
}

} // namespace tyndall::hall
