#include "engine/lights.hpp"

#include <algorithm>
#include <cmath>

namespace tyndall::engine {

float luminance(const glm::vec3& color) {
    return 0.2126F * color.r + 0.7152F * color.g + 0.0722F * color.b; // ITU-R BT.709
}

LightRoles assign_lights(const Scene& scene) {
    LightRoles roles;
    std::vector<DirectionalLight> directional;
    for (const Light& light : scene.lights) {
        if (luminance(light.intensity) <= 0.0F) {
            roles.notes.push_back("Light '" + light.name + "' is dark and was left out.");
        } else if (light.type == LightType::directional) {
            directional.push_back({light.direction, light.intensity});
        } else {
            roles.local.push_back(light);
        }
    }
    std::stable_sort(directional.begin(), directional.end(), [](const DirectionalLight& a, const DirectionalLight& b) {
        return luminance(a.illuminance_lux) > luminance(b.illuminance_lux);
    });
    if (directional.empty()) {
        return roles;
    }
    roles.sun = directional.front();
    const std::size_t fills = std::min(directional.size() - 1, most_fill_lights);
    roles.fills.assign(directional.begin() + 1, directional.begin() + 1 + static_cast<std::ptrdiff_t>(fills));
    if (fills > 0) {
        roles.notes.push_back("The brightest directional light is the sun; " + std::to_string(fills) +
                              " more light surfaces only and cast no shadows.");
    }
    if (directional.size() - 1 > fills) {
        roles.notes.push_back(std::to_string(directional.size() - 1 - fills) +
                              " directional lights were left out: the sun and " + std::to_string(most_fill_lights) +
                              " more are computed.");
    }
    return roles;
}

double light_range_m(const Light& light, const LightSettings& settings) {
    const float brightest = std::max({light.intensity.r, light.intensity.g, light.intensity.b});
    return std::max(light.range_m.value_or(std::sqrt(static_cast<double>(brightest) / settings.threshold_lux)), 1e-4);
}

gpu::GpuLight make_gpu_light(const Light& light, const glm::dvec3& origin_m, const LightSettings& settings) {
    gpu::GpuLight out{};
    out.position_range =
        glm::vec4(glm::vec3(light.position - origin_m), static_cast<float>(light_range_m(light, settings)));
    const bool spot = light.type == LightType::spot;
    out.intensity_type = glm::vec4(light.intensity, spot ? 1.0F : 0.0F);
    out.direction_radius = glm::vec4(glm::vec3(light.direction), static_cast<float>(settings.source_radius_m));
    out.cone = glm::vec4(0.0F, 1.0F, 0.0F, 0.0F);
    if (spot) {
        // KHR_lights_punctual, "Inner and Outer Cone Angles".
        const float cos_outer = std::cos(light.outer_cone_rad);
        const float scale = 1.0F / std::max(0.001F, std::cos(light.inner_cone_rad) - cos_outer);
        out.cone = glm::vec4(scale, -cos_outer * scale, 0.0F, 0.0F);
    }
    return out;
}

} // namespace tyndall::engine
