#include "features/volumetrics/change.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "features/volumetrics/parameters.hpp"

namespace tyndall::volumetrics {
namespace {

/// Froxels at the edge of a shadow change by as much per radian that the sun turns: a caster stands some two hundred
/// times the size of a froxel away.
constexpr double shadow_edge_per_rad = 200.0;

/// Whatever the number of its map is.
bool casts_shadow(const gpu::GpuLight& light) {
    return light.cone.z > 0.5F;
}

bool is_same_light(const gpu::GpuLight& a, const gpu::GpuLight& b) {
    const glm::dvec3 p(a.position_range);
    const glm::dvec3 q(b.position_range);
    return glm::distance(p, q) <= 2e-7 * (glm::length(p) + glm::length(q)) &&
           a.position_range.w == b.position_range.w && a.intensity_type == b.intensity_type &&
           a.direction_radius == b.direction_radius && glm::vec2(a.cone) == glm::vec2(b.cone) &&
           casts_shadow(a) == casts_shadow(b);
}

gpu::GpuLight dark(gpu::GpuLight light) {
    light.intensity_type = glm::vec4(glm::vec3(0.0F), light.intensity_type.w);
    return light;
}

bool is_dark(const gpu::GpuLight& light) {
    return glm::vec3(light.intensity_type) == glm::vec3(0.0F);
}

/// What is left of both lists without what they have in common: at the same places where they are of one length, else
/// at their beginnings and ends.
void remove_common(std::vector<gpu::GpuLight>& a, std::vector<gpu::GpuLight>& b) {
    if (a.size() != b.size()) {
        const auto first = std::mismatch(a.begin(), a.end(), b.begin(), b.end(), is_same_light);
        a.erase(a.begin(), first.first);
        b.erase(b.begin(), first.second);
        const auto last = std::mismatch(a.rbegin(), a.rend(), b.rbegin(), b.rend(), is_same_light);
        a.erase(last.first.base(), a.end());
        b.erase(last.second.base(), b.end());
        return;
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!is_same_light(a[i], b[i])) {
            a[kept] = a[i];
            b[kept++] = b[i];
        }
    }
    a.resize(kept);
    b.resize(kept);
}

/// A light that goes out and whose sphere holds those of `changes`.
LightChange stand_in(std::span<const LightChange> changes) {
    glm::vec3 low(changes[0].now.position_range);
    glm::vec3 high = low;
    const auto each = [&](const auto& use) {
        for (const LightChange& change : changes) {
            use(change.before.position_range);
            use(change.now.position_range);
        }
    };
    each([&](const glm::vec4& sphere) {
        low = glm::min(low, glm::vec3(sphere) - sphere.w);
        high = glm::max(high, glm::vec3(sphere) + sphere.w);
    });
    const glm::vec3 center = 0.5F * (low + high);
    float radius_m = 0.0F;
    each([&](const glm::vec4& sphere) {
        radius_m = std::max(radius_m, glm::distance(center, glm::vec3(sphere)) + sphere.w);
    });
    const gpu::GpuLight light{.position_range = glm::vec4(center, radius_m),
                              .intensity_type = {1.0F, 1.0F, 1.0F, 0.0F},
                              .direction_radius = {0.0F, -1.0F, 0.0F, 0.0F},
                              .cone = {0.0F, 1.0F, 0.0F, 0.0F}};
    return {light, dark(light)};
}

double relative_difference(const glm::vec3& a, const glm::vec3& b) {
    double largest = 0.0;
    for (int i = 0; i < 3; ++i) {
        const double brighter = std::max(std::abs(static_cast<double>(a[i])), std::abs(static_cast<double>(b[i])));
        const double difference = std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i]));
        largest = std::max(largest, brighter > 0.0 ? difference / brighter : 0.0);
    }
    return std::min(largest, 1.0);
}

bool is_same_phase(const PhaseLobes& a, const PhaseLobes& b) {
    return std::equal(a.all().begin(), a.all().end(), b.all().begin(), b.all().end(),
                      [](const PhaseLobe& x, const PhaseLobe& y) {
                          return x.function == y.function && x.g == y.g && x.weight == y.weight;
                      });
}

double sun_change(const std::optional<Sun>& sun, const std::optional<Sun>& before, double steepness) {
    const glm::vec3 lux = sun ? sun->illuminance_lux : glm::vec3(0.0F);
    const glm::vec3 lux_before = before ? before->illuminance_lux : glm::vec3(0.0F);
    const double change = relative_difference(lux, lux_before);
    if (!sun || !before) {
        return change;
    }
    if (sun->casts_shadows != before->casts_shadows) {
        return 1.0;
    }
    const double turned_rad = glm::distance(glm::dvec3(sun->direction), glm::dvec3(before->direction));
    return change + turned_rad * (steepness + (sun->casts_shadows ? shadow_edge_per_rad : 0.0));
}

/// What of light's way no closed form knows: noise, and the volumes that are not what they were, each by no more than
/// it takes of light that passes it.
double march_change(const FrameInputs& frame, const FrameMemory& before) {
    const LightMarch march = light_march(frame.medium, frame.settings);
    if (march != before.march || (march.octaves > 0 && frame.medium.noise != before.medium.noise)) {
        return 1.0;
    }
    const auto part_taken = [](const LocalVolume& volume) {
        const bool knows_its_own = volume.blend == VolumeBlend::add || volume.blend == VolumeBlend::max;
        const double length_m = 2.0 * glm::length(glm::dvec3(volume.half_size_m));
        return knows_its_own ? -std::expm1(-length_m * static_cast<double>(volume.extinction_per_m)) : 1.0;
    };
    const std::vector<LocalVolume>& is = frame.medium.volumes;
    const std::vector<LocalVolume>& was = before.medium.volumes;
    double change = 0.0;
    for (std::size_t i = 0; march.volumes && i < std::max(is.size(), was.size()); ++i) {
        if (i >= is.size() || i >= was.size() || is[i] != was[i]) {
            change += (i < is.size() ? part_taken(is[i]) : 0.0) + (i < was.size() ? part_taken(was[i]) : 0.0);
        }
    }
    return change;
}

} // namespace

std::vector<LightChange> light_changes(const FrameInputs& frame, const FrameMemory& before) {
    std::vector<gpu::GpuLight> was = before.lights;
    const glm::dvec3 moved_m = before.camera.origin_m - frame.camera.origin_m;
    for (gpu::GpuLight& light : was) {
        light.position_range = glm::vec4(glm::vec3(glm::dvec3(light.position_range) + moved_m), light.position_range.w);
    }
    std::vector<gpu::GpuLight> is = frame.lights;
    remove_common(was, is);
    std::vector<LightChange> changes;
    for (std::size_t i = 0; i < std::max(was.size(), is.size()); ++i) {
        const gpu::GpuLight old = i < was.size() ? was[i] : dark(is[i]);
        // A light that begins or ceases to cast shadows lights other places: as if it went out.
        const bool stays = i < is.size() && casts_shadow(is[i]) == casts_shadow(old);
        const gpu::GpuLight now = stays ? is[i] : dark(old);
        if (!is_dark(old) || !is_dark(now)) {
            changes.push_back({old, now});
        }
    }
    constexpr std::size_t most = TYNDALL_LIGHT_CHANGE_COUNT;
    if (changes.size() > most) {
        changes[most - 1] = stand_in(std::span(changes).subspan(most - 1));
        changes.resize(most);
    }
    return changes;
}

float change_everywhere(const FrameInputs& frame, const FrameMemory& before) {
    const PhaseLobes phase = phase_of(frame.medium);
    if (!is_same_phase(phase, phase_of(before.medium))) {
        return 1.0F;
    }
    double change = relative_difference(frame.medium.ambient_radiance, before.medium.ambient_radiance);
    for (std::size_t i = 0; i < frame.medium.ambient_sh_1.size(); ++i) {
        change += relative_difference(frame.medium.ambient_sh_1[i], before.medium.ambient_sh_1[i]);
    }
    change += sun_change(frame.sun, before.sun, steepness(phase));
    const glm::vec4 air = air_of(frame);
    change += relative_difference(glm::vec3(air), glm::vec3(before.air)) + (air.w != before.air.w ? 1.0 : 0.0);
    if (air != glm::vec4(0.0F)) {
        change +=
            relative_difference(frame.medium.homogeneous.extinction_color, before.medium.homogeneous.extinction_color) +
            relative_difference(frame.medium.height.extinction_color, before.medium.height.extinction_color) +
            (heights_of_map(frame.medium) != heights_of_map(before.medium) ? 1.0 : 0.0);
    }
    change += march_change(frame, before);
    return static_cast<float>(std::min(change, 1.0));
}

} // namespace tyndall::volumetrics
