#include "samples/precision/scene.hpp"

#include <array>
#include <span>
#include <utility>

#include <glm/geometric.hpp>

namespace tyndall::samples {
namespace {

glm::dvec3 corner(const glm::dvec3& low, const glm::dvec3& high, unsigned index) {
    return {(index & 1U) != 0 ? high.x : low.x, (index & 2U) != 0 ? high.y : low.y, (index & 4U) != 0 ? high.z : low.z};
}

engine::Primitive make_primitive(const Surface& surface, std::uint32_t material) {
    engine::Primitive primitive;
    primitive.name = "surface " + std::to_string(material);
    primitive.material = material;
    for (const auto& quad : surface.quads) {
        const glm::vec3 normal(glm::normalize(glm::cross(quad[1] - quad[0], quad[2] - quad[0])));
        const glm::vec3 tangent(glm::normalize(quad[1] - quad[0]));
        const auto first = static_cast<std::uint32_t>(primitive.positions.size());
        for (const glm::dvec3& position : quad) {
            primitive.positions.emplace_back(position);
            primitive.normals.push_back(normal);
            primitive.tangents.emplace_back(tangent, 1.0F);
            primitive.uv0.emplace_back(0.0F);
            primitive.uv1.emplace_back(0.0F);
            primitive.colors.emplace_back(1.0F);
        }
        primitive.indices.insert(primitive.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
    }
    return primitive;
}

engine::Material make_material(const Surface& surface) {
    engine::Material material;
    material.name = "Lambertian";
    material.base_color_factor = glm::vec4(glm::vec3(surface.albedo), 1.0F);
    material.metallic_factor = 0.0F;
    material.specular_factor = 0.0F;
    material.double_sided = true;
    return material;
}

engine::Light make_light(const reference::Light& light) {
    engine::Light out;
    out.name = "light";
    out.type = light.cone ? engine::LightType::spot : engine::LightType::point;
    out.intensity = glm::vec3(light.intensity_cd);
    out.position = light.position;
    out.range_m = light.range_m;
    if (light.cone) {
        out.direction = light.cone->direction;
        out.inner_cone_rad = static_cast<float>(light.cone->inner_rad);
        out.outer_cone_rad = static_cast<float>(light.cone->outer_rad);
    }
    return out;
}

std::vector<reference::Triangle> triangles_of(std::span<const Surface> surfaces) {
    std::vector<reference::Triangle> triangles;
    for (const Surface& surface : surfaces) {
        for (const auto& quad : surface.quads) {
            triangles.push_back({{quad[0], quad[1], quad[2]}, surface.albedo, glm::dvec3(0.0)});
            triangles.push_back({{quad[0], quad[2], quad[3]}, surface.albedo, glm::dvec3(0.0)});
        }
    }
    return triangles;
}

/// Where they are; their colours stand in textures.
std::vector<reference::Triangle> triangles_of(const engine::Scene& scene) {
    std::vector<reference::Triangle> triangles;
    for (const engine::Instance& instance : scene.instances) {
        const engine::Primitive& primitive = scene.primitives[instance.primitive];
        const auto corner_at = [&](std::size_t i) {
            const glm::dvec4 local(glm::dvec3(primitive.positions[primitive.indices[i]]), 1.0);
            return glm::dvec3(instance.world_from_object * local);
        };
        for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
            triangles.push_back({{corner_at(i), corner_at(i + 1), corner_at(i + 2)}, glm::dvec3(0.0), glm::dvec3(0.0)});
        }
    }
    return triangles;
}

} // namespace

Surface make_box(const glm::dvec3& low, const glm::dvec3& high, const glm::dvec3& albedo) {
    // Corner i has the high x, y, z of its bits 0, 1, 2.
    constexpr std::array<std::array<unsigned, 4>, 6> faces{
        {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
    Surface surface{{}, albedo};
    for (const auto& face : faces) {
        surface.quads.push_back({corner(low, high, face[0]), corner(low, high, face[1]), corner(low, high, face[2]),
                                 corner(low, high, face[3])});
    }
    return surface;
}

Surface make_room(const glm::dvec3& low, const glm::dvec3& high, const glm::dvec3& albedo) {
    Surface room = make_box(low, high, albedo);
    for (auto& quad : room.quads) {
        std::swap(quad[1], quad[3]);
    }
    return room;
}

reference::Scene reference_scene(const PrecisionScene& scene, const Physics& physics) {
    reference::Scene truth;
    truth.geometry = reference::Geometry(scene.drawn ? triangles_of(*scene.drawn) : triangles_of(scene.surfaces));
    truth.medium = scene.fog.medium;
    truth.time_s = scene.time_s;
    truth.sun = scene.sun;
    truth.fills = scene.fills;
    truth.lights = scene.lights;
    for (reference::Light& light : truth.lights) {
        light.casts_shadows = light.casts_shadows && physics.local_shadows;
    }
    truth.surroundings = scene.surroundings;
    truth.attenuates_light = physics.light_paths;
    return truth;
}

engine::Scene engine_scene(const PrecisionScene& scene) {
    if (scene.drawn) {
        return *scene.drawn;
    }
    engine::Scene out;
    for (const Surface& surface : scene.surfaces) {
        const auto index = static_cast<std::uint32_t>(out.primitives.size());
        out.primitives.push_back(make_primitive(surface, index));
        out.materials.push_back(make_material(surface));
        engine::Instance instance;
        instance.primitive = index;
        for (const glm::vec3& position : out.primitives.back().positions) {
            instance.box.grow(glm::dvec3(position));
        }
        instance.sphere = {instance.box.center(), 0.5 * glm::length(instance.box.extent())};
        out.bounds.grow(instance.box);
        out.instances.push_back(instance);
    }
    engine::Camera camera;
    camera.name = "camera";
    camera.world_from_camera = scene.camera.world_from_camera;
    camera.perspective.fov_y_rad = scene.camera.fov_y_rad;
    out.cameras.push_back(std::move(camera));
    if (scene.sun) {
        engine::Light sun;
        sun.name = "sun";
        sun.type = engine::LightType::directional;
        sun.intensity = glm::vec3(scene.sun->illuminance_lux);
        sun.direction = scene.sun->direction;
        out.lights.push_back(std::move(sun));
    }
    for (const reference::Light& light : scene.lights) {
        out.lights.push_back(make_light(light));
    }
    return out;
}

engine::RendererSettings renderer_settings(const PrecisionScene& scene) {
    engine::RendererSettings settings;
    settings.color_format = VK_FORMAT_R32G32B32A32_SFLOAT;
    const reference::Surroundings& around = scene.surroundings;
    settings.ambient = engine::Ambient{glm::vec3(around.ambient_up), glm::vec3(around.ambient_down)};
    settings.background =
        engine::Background{glm::vec3(around.zenith), glm::vec3(around.horizon), glm::vec3(around.ground)};
    return settings;
}

} // namespace tyndall::samples
