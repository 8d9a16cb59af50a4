#include "samples/precision/file_scene.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "engine/file_io.hpp"
#include "engine/gltf.hpp"
#include "engine/lights.hpp"
#include "samples/precision/fog_file.hpp"
#include "samples/precision/hash.hpp"

namespace tyndall::samples {
namespace {

constexpr double wind_time_s = 4.0; ///< as in `tyndall render`
constexpr std::size_t judged_pixels = 600;

void make_lambertian(engine::Material& material) {
    material.metallic_factor = 0.0F;
    material.specular_factor = 0.0F;
    material.metallic_roughness.reset();
    material.occlusion.reset();
    material.specular.reset();
    material.specular_color.reset();
    material.unlit = false;
}

void keep_opaque(engine::Scene& scene) {
    std::erase_if(scene.instances, [&](const engine::Instance& instance) {
        const std::uint32_t material = scene.primitives[instance.primitive].material;
        return scene.materials[material].alpha_mode != engine::AlphaMode::opaque;
    });
    scene.bounds = {};
    for (const engine::Instance& instance : scene.instances) {
        scene.bounds.grow(instance.box);
    }
}

reference::DirectionalLight to_reference(const engine::DirectionalLight& light, bool casts_shadows) {
    return {light.direction, glm::dvec3(light.illuminance_lux), casts_shadows};
}

reference::Light to_reference(const engine::Light& light) {
    const engine::LightSettings settings;
    const auto brightest = static_cast<double>(std::max({light.intensity.r, light.intensity.g, light.intensity.b}));
    reference::Light out{.position = light.position,
                         .intensity_cd = glm::dvec3(light.intensity),
                         .radius_m = settings.source_radius_m,
                         .range_m = light.range_m.value_or(std::sqrt(brightest / settings.threshold_lux)),
                         .cone = {},
                         .casts_shadows = light.type == engine::LightType::spot};
    if (light.type == engine::LightType::spot) {
        out.cone = reference::Cone{light.direction, light.inner_cone_rad, light.outer_cone_rad};
    }
    return out;
}

reference::Surroundings to_surroundings(const std::optional<engine::DirectionalLight>& sun) {
    const engine::Ambient ambient = engine::default_ambient(sun);
    const engine::Background background = engine::default_background(sun);
    return {.ambient_up = glm::dvec3(ambient.up),
            .ambient_down = glm::dvec3(ambient.down),
            .zenith = glm::dvec3(background.zenith),
            .horizon = glm::dvec3(background.horizon),
            .ground = glm::dvec3(background.ground)};
}

std::string identity_of(const engine::Scene& scene, std::span<const std::byte> fog_json,
                        const volumetrics::Medium& medium) {
    Hash hash;
    hash.add(fog_json);
    std::vector<std::shared_ptr<const volumetrics::DensityTexels>> densities = volumetrics::grids_of(medium);
    densities.push_back(medium.map.texels);
    for (const auto& texels : densities) {
        hash.add(std::as_bytes(texels ? std::span(texels->values()) : std::span<const std::uint8_t>()));
    }
    for (const engine::Primitive& primitive : scene.primitives) {
        hash.add(std::as_bytes(std::span(primitive.positions)));
        hash.add(std::as_bytes(std::span(primitive.indices)));
    }
    for (const engine::Instance& instance : scene.instances) {
        hash.add(instance.primitive);
        hash.add(std::as_bytes(std::span(&instance.world_from_object, 1)));
    }
    for (const engine::Light& light : scene.lights) {
        hash.add(std::as_bytes(std::span(&light.intensity, 1)));
        hash.add(std::as_bytes(std::span(&light.position, 1)));
        hash.add(std::as_bytes(std::span(&light.direction, 1)));
        hash.add(light.range_m.value_or(0.0));
        hash.add(light.inner_cone_rad);
        hash.add(light.outer_cone_rad);
    }
    hash.add(std::as_bytes(std::span(&scene.cameras.front().world_from_camera, 1)));
    return hash.text();
}

} // namespace

tl::expected<PrecisionScene, std::string> load_precision_scene(const std::filesystem::path& path) {
    auto loaded = engine::load_gltf(path);
    if (!loaded) {
        return tl::unexpected(loaded.error().message);
    }
    std::filesystem::path fog_path = path;
    const auto fog_text = engine::read_file(fog_path.replace_extension(".fog.json"));
    if (!fog_text) {
        return tl::unexpected(fog_text.error().message);
    }
    auto fog = load_fog_file(fog_path);
    if (!fog) {
        return tl::unexpected(fog.error());
    }
    if (loaded->cameras.front().orthographic) {
        return tl::unexpected(path.string() + ": the first camera must be a perspective one");
    }
    PrecisionScene scene;
    scene.name = path.stem().string();
    scene.about = "opaque surfaces of '" + path.filename().string() + "', Lambertian";
    scene.fog = std::move(*fog);
    scene.time_s = wind_time_s;
    scene.pixels = judged_pixels;
    scene.tolerance = 1e-5; // noise and many lights are dear
    keep_opaque(*loaded);
    std::for_each(loaded->materials.begin(), loaded->materials.end(), make_lambertian);
    scene.camera = {loaded->cameras.front().world_from_camera, loaded->cameras.front().perspective.fov_y_rad,
                    std::nullopt};
    const engine::LightRoles roles = engine::assign_lights(*loaded);
    if (roles.sun) {
        scene.sun = to_reference(*roles.sun, true);
    }
    for (const engine::DirectionalLight& fill : roles.fills) {
        scene.fills.push_back(to_reference(fill, false));
    }
    for (const engine::Light& light : roles.local) {
        scene.lights.push_back(to_reference(light));
    }
    scene.surroundings = to_surroundings(roles.sun);
    scene.identity = identity_of(*loaded, *fog_text, scene.fog.medium);
    scene.drawn = std::move(*loaded);
    return scene;
}

} // namespace tyndall::samples
