#include "engine/local_shadows.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace tyndall::engine {
namespace {

/// Texels at each side of a map beyond what the light reaches through it, for filters.
constexpr double border_texels = 2.0;

bool wants_shadow(const Light& light, const LocalShadowSettings& settings) {
    return light.casts_shadow.value_or(light.type == LightType::spot ? settings.spots : settings.points);
}

bool is_cube(const Light& light) {
    return shadow_map_count(light) > 1;
}

/// Rows across and along the light's direction; the world's axes for a cube.
glm::dmat3 light_from_world(const Light& light) {
    if (is_cube(light)) {
        return glm::dmat3(1.0);
    }
    const glm::dvec3 z = light.direction;
    const glm::dvec3 helper = std::abs(z.y) < 0.9 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(0.0, 0.0, 1.0);
    const glm::dvec3 x = glm::normalize(glm::cross(helper, z));
    return glm::transpose(glm::dmat3(x, glm::cross(z, x), z));
}

double half_angle_tan(const Light& light) {
    return is_cube(light) ? 1.0 : std::tan(static_cast<double>(light.outer_cone_rad));
}

double distance_m(const Box& box, const glm::dvec3& point) {
    return glm::length(glm::max(glm::max(box.min - point, point - box.max), glm::dvec3(0.0)));
}

std::string label(std::span<const Light> lights, std::size_t index) {
    const std::string& name = lights[index].name;
    return "local light " + std::to_string(index) + (name.empty() ? "" : " '" + name + "'");
}

} // namespace

std::uint32_t shadow_map_count(const Light& light) {
    return light.type == LightType::spot && light.outer_cone_rad <= widest_single_map_rad ? 1 : cube_sides;
}

LocalShadowPlan plan_local_shadows(std::span<const Light> lights, std::span<const Box> casters, const glm::dvec3& eye_m,
                                   const LocalShadowSettings& settings, const LightSettings& light_settings,
                                   std::span<const ShadowedLight> before) {
    struct Candidate {
        std::uint32_t light;
        double score;
    };
    LocalShadowPlan plan;
    std::vector<Candidate> candidates;
    bool any_wants = false;
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        const Light& light = lights[i];
        if (!wants_shadow(light, settings)) {
            continue;
        }
        any_wants = true;
        const double range_m = light_range_m(light, light_settings);
        const bool reached = std::any_of(casters.begin(), casters.end(), [&](const Box& box) {
            return distance_m(box, light.position) < range_m &&
                   (is_cube(light) || may_cast_into(light, 0, range_m, box));
        });
        if (!reached) {
            plan.without.push_back(label(lights, i) + ": it shines on nothing that casts a shadow");
            continue;
        }
        plan.most_maps = std::min(plan.most_maps + shadow_map_count(light), settings.most_maps);
        const glm::dvec3 away = light.position - eye_m;
        const bool held =
            std::any_of(before.begin(), before.end(), [&](const ShadowedLight& s) { return s.light == i; });
        candidates.push_back({i, static_cast<double>(luminance(light.intensity)) / std::max(glm::dot(away, away), 1.0) *
                                     (held ? 1.25 : 1.0)});
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
    for (const Candidate& candidate : candidates) {
        const std::uint32_t count = shadow_map_count(lights[candidate.light]);
        if (plan.map_count + count > settings.most_maps) {
            plan.without.push_back(label(lights, candidate.light) + ": the " + std::to_string(settings.most_maps) +
                                   " maps that there may be went to lights that are brighter at the eye");
            continue;
        }
        plan.map_count += count;
        plan.lights.push_back({candidate.light, 0, count});
    }
    std::sort(plan.lights.begin(), plan.lights.end(),
              [](const ShadowedLight& a, const ShadowedLight& b) { return a.light < b.light; });
    std::uint32_t layer = 0;
    for (ShadowedLight& light : plan.lights) {
        light.first_layer = layer;
        layer += light.map_count;
    }
    if (plan.lights.empty()) {
        plan.why_none = lights.empty()       ? "the scene has no point or spot light"
                        : !any_wants         ? "no point or spot light is to cast any"
                        : candidates.empty() ? "no caster stands in the light of one"
                                             : "the settings allow too few maps";
    }
    return plan;
}

gpu::LocalShadow make_local_shadow(const Light& light, const ShadowedLight& shadowed, const glm::dvec3& origin_m,
                                   const LocalShadowSettings& settings) {
    const glm::dmat3 rows = light_from_world(light);
    const glm::dvec3 moved = rows * (origin_m - light.position);
    const auto row = [&](int i) { return glm::vec4(glm::dvec4(rows[0][i], rows[1][i], rows[2][i], moved[i])); };
    const double side = settings.resolution;
    const double scale = 0.5 * (1.0 - 2.0 * border_texels / side) / half_angle_tan(light);
    const double near_m =
        light.shadow_near_m.value_or(light.type == LightType::spot ? settings.spot_near_m : settings.point_near_m);
    gpu::LocalShadow out{};
    out.row_x = row(0);
    out.row_y = row(1);
    out.row_z = row(2);
    out.lens = glm::vec4(scale, near_m, shadowed.first_layer, shadowed.map_count > 1 ? 1.0F : 0.0F);
    out.texel = glm::vec4(1.0 / (side * scale), side, 1.0 / side, 0.0);
    return out;
}

bool may_cast_into(const Light& light, std::uint32_t side, double range_m, const Box& box) {
    if (distance_m(box, light.position) >= range_m) {
        return false;
    }
    glm::dmat3 rows = glm::transpose(light_from_world(light)); // columns: x, y, z of the light
    if (is_cube(light)) {
        const int axis = static_cast<int>(side / 2);
        const double sign = side % 2 == 1 ? -1.0 : 1.0;
        rows = glm::dmat3(rows[(axis + 1) % 3], rows[(axis + 2) % 3], sign * rows[axis]);
    }
    // The frustum's four sides: |x|, |y| <= tan z, a little widened for the border.
    const double tangent = 1.1 * half_angle_tan(light);
    const glm::dvec3 center = box.center() - light.position;
    const glm::dvec3 half = 0.5 * box.extent();
    for (const glm::dvec3& across : {rows[0], -rows[0], rows[1], -rows[1]}) {
        const glm::dvec3 inward = tangent * rows[2] + across;
        if (glm::dot(inward, center) + glm::dot(glm::abs(inward), half) < 0.0) {
            return false;
        }
    }
    return glm::dot(rows[2], center) + glm::dot(glm::abs(rows[2]), half) > 0.0;
}

} // namespace tyndall::engine
