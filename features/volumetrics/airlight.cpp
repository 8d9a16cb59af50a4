#include "features/volumetrics/airlight.hpp"

#include <algorithm>
#include <cmath>

#include "features/volumetrics/parameters.hpp"

namespace tyndall::volumetrics {
namespace {

/// Distance in widths of a froxel at which bilinear interpolation of 1 / distance is 1.6 % off.
constexpr double fine_widths = 4.0;
/// A chosen light stays until it is farther by this, and counts as brighter by this.
constexpr double hysteresis = 1.5;
/// Lights dimmer than this part of the brightest are not worth a pixel's time.
constexpr double dim_part = 1e-2;

/// Of the optical depth between two points.
bool has_closed_form(const FrameInputs& frame) {
    const Medium& medium = frame.medium;
    return medium.noise.amplitude == 0.0F && medium.volumes.empty() && !medium.map.texels &&
           extinction_bound(frame.fog_particles) == 0.0F;
}

struct Candidate {
    std::uint32_t light = 0;
    double brightness = 0.0;
    bool was_chosen = false;
};

/// By place where there are as many as before, else by where they stand and shine: dark lights keep all else.
bool was_chosen(const FrameInputs& frame, const std::optional<FrameMemory>& before, std::uint32_t index) {
    if (!before) {
        return false;
    }
    if (before->lights.size() == frame.lights.size()) {
        return std::binary_search(before->airlights.begin(), before->airlights.end(), index);
    }
    const gpu::GpuLight& light = frame.lights[index];
    const glm::dvec3 world_m = glm::dvec3(light.position_range) + frame.camera.origin_m;
    return std::any_of(before->airlights.begin(), before->airlights.end(), [&](std::uint32_t i) {
        const gpu::GpuLight& old = before->lights[i];
        const glm::dvec3 old_world_m = glm::dvec3(old.position_range) + before->camera.origin_m;
        return old.position_range.w == light.position_range.w &&
               glm::distance(old_world_m, world_m) <= 1e-6 * (1.0 + glm::length(glm::dvec3(light.position_range)));
    });
}

/// How far a point lies outside the view at least, m; 0 inside. `position_m` in view space.
double outside_view_m(const gpu::ScatteringVolume& volume, const glm::dvec3& position_m) {
    const double depth_m = -position_m.z;
    double outside_m = std::max(0.0, -depth_m);
    for (int axis = 0; axis < 2; ++axis) {
        for (const double uv : {0.0, 1.0}) {
            const double slope =
                uv * static_cast<double>(volume.slope[axis]) + static_cast<double>(volume.slope[axis + 2]);
            const double edge_m = slope * depth_m + uv * static_cast<double>(volume.origin[axis]) +
                                  static_cast<double>(volume.origin[axis + 2]);
            // Which side is outside depends on which way uv runs.
            const double right = volume.slope[axis] + volume.origin[axis] > 0.0F ? 1.0 : -1.0;
            const double side = uv > 0.5 ? right : -right;
            outside_m = std::max(outside_m, side * (position_m[axis] - edge_m) / std::hypot(1.0, slope));
        }
    }
    return outside_m;
}

double froxel_width_m(const gpu::ScatteringVolume& volume, double depth_m) {
    double width_m = 0.0;
    for (int axis = 0; axis < 2; ++axis) {
        const double span_m = std::abs(static_cast<double>(volume.slope[axis])) * depth_m +
                              std::abs(static_cast<double>(volume.origin[axis]));
        width_m = std::max(width_m, span_m / (static_cast<double>(volume.grid[axis]) - 1.0));
    }
    return width_m;
}

/// Of the cone's half angle; 1 for one of 45 degrees or more.
double tangent_of_cone(const gpu::GpuLight& light) {
    if (light.intensity_type.w < 0.5F || light.cone.x <= 0.0F) {
        return 1.0;
    }
    const double cosine = std::clamp(-static_cast<double>(light.cone.y) / static_cast<double>(light.cone.x), 0.0, 1.0);
    return std::min(1.0, std::sqrt(1.0 - cosine * cosine) / std::max(cosine, 1e-6));
}

/// Of light from a point at this distance that fog in front of it scatters; of the eye's air where it thins out.
double transmittance_to(const FrameInputs& frame, const glm::dvec3& position_m) {
    const HeightFog& height = frame.medium.height;
    const double above_m = frame.camera.origin_m.y + 0.5 * position_m.y - static_cast<double>(height.base_height_m);
    const double height_per_m = static_cast<double>(height.extinction_per_m) *
                                std::exp(-static_cast<double>(height.falloff_per_m) * std::max(above_m, 0.0));
    return std::exp(-glm::length(position_m) *
                    (static_cast<double>(frame.medium.homogeneous.extinction_per_m) + height_per_m));
}

/// Half angle of the peak in the direction of `forward`, at most 4 rad, where nothing peaks.
double peak_width(const PhaseLobes& phase, bool forward) {
    double width = 4.0;
    for (const PhaseLobe& lobe : phase.all()) {
        const PhaseForm form = phase_form(lobe);
        if ((lobe.g >= 0.0F) == forward && form.chord > 0.0 && lobe.weight > 0.0F) {
            width = std::min(width, std::sqrt(form.spread / form.chord));
        }
    }
    return width;
}

} // namespace

AirlightChoice choose_airlights(const FrameInputs& frame, const std::optional<FrameMemory>& before) {
    const std::uint32_t most = frame.settings.airlight.max_lights;
    if (frame.lights.empty()) {
        return {};
    }
    if (most == 0) {
        return {{}, "airlight.max_lights is 0"};
    }
    if (!has_closed_form(frame)) {
        return {{}, "only froxels know noise, a density map, local volumes and particles"};
    }
    if (is_colored(frame.medium)) {
        return {{}, "only froxels know extinction of each channel"};
    }
    const gpu::ScatteringVolume volume = scattering_volume(frame.settings.grid, frame.camera, 1.0F);
    std::vector<Candidate> candidates;
    double brightest = 0.0;
    const std::size_t count = std::min<std::size_t>(frame.lights.size(), TYNDALL_AIRLIGHT_CANDIDATES);
    for (std::uint32_t i = 0; i < count; ++i) {
        const gpu::GpuLight& light = frame.lights[i];
        const glm::dvec3 position_m(frame.camera.view_from_render * glm::dvec4(glm::dvec3(light.position_range), 1.0));
        const double outside_m = outside_view_m(volume, position_m) * tangent_of_cone(light);
        const double width_m = froxel_width_m(volume, std::max(-position_m.z, 0.0) + outside_m);
        const double fine_m = fine_widths * width_m + 4.0 * static_cast<double>(light.direction_radius.w);
        const bool chosen_before = was_chosen(frame, before, i);
        if (outside_m > fine_m * (chosen_before ? hysteresis : 1.0) ||
            outside_m > static_cast<double>(light.position_range.w)) {
            continue;
        }
        const glm::vec4& candela = light.intensity_type;
        const double away_m = std::max(glm::length(position_m), 0.1);
        const double brightness = static_cast<double>(std::max({candela.x, candela.y, candela.z})) / away_m *
                                  transmittance_to(frame, position_m) * (chosen_before ? hysteresis : 1.0);
        if (brightness > 0.0) {
            candidates.push_back({i, brightness, chosen_before});
            brightest = std::max(brightest, brightness);
        }
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.brightness > b.brightness; });
    AirlightChoice choice;
    bool capped = false;
    for (const Candidate& candidate : candidates) {
        if (candidate.brightness < dim_part * brightest) {
            break;
        }
        if (choice.lights.size() == most) {
            capped = true;
            break;
        }
        choice.lights.push_back(candidate.light);
    }
    std::sort(choice.lights.begin(), choice.lights.end());
    if (capped) {
        choice.why_not = "airlight.max_lights is " + std::to_string(most);
    } else if (choice.lights.size() < frame.lights.size()) {
        choice.why_not = "froxels hold what they bring into the view, or it is too dim";
    }
    return choice;
}

std::vector<gpu::GpuLight> froxel_lights(const FrameInputs& frame, const AirlightChoice& choice) {
    std::vector<gpu::GpuLight> lights = frame.lights;
    for (const std::uint32_t i : choice.lights) {
        lights[i].intensity_type = glm::vec4(glm::vec3(0.0F), lights[i].intensity_type.w);
    }
    return lights;
}

gpu::Airlights airlights(const FrameInputs& frame, const AirlightChoice& choice) {
    const PhaseLobes phase = phase_of(frame.medium);
    gpu::Airlights made{};
    made.shape = glm::vec4(peak_width(phase, true), peak_width(phase, false),
                           weakens_light(frame.medium, frame.settings) ? 1.0 : 0.0, 0.0);
    const glm::dmat3 view_from_render(frame.camera.view_from_render);
    for (std::size_t i = 0; i < choice.lights.size(); ++i) {
        gpu::GpuLight light = frame.lights[choice.lights[i]];
        light.position_range =
            glm::vec4(frame.camera.view_from_render * glm::dvec4(glm::dvec3(light.position_range), 1.0));
        light.position_range.w = frame.lights[choice.lights[i]].position_range.w;
        light.direction_radius =
            glm::vec4(view_from_render * glm::dvec3(light.direction_radius), light.direction_radius.w);
        made.lights[i] = light;
    }
    return made;
}

void write_kept_lights(const AirlightChoice& choice, gpu::VolumetricParameters& u) {
    for (glm::uvec4& words : u.kept_lights) {
        words = glm::uvec4(~0U);
    }
    for (const std::uint32_t i : choice.lights) {
        u.kept_lights[i / 128][static_cast<int>(i / 32 % 4)] &= ~(1U << i % 32);
    }
}

std::uint32_t airlight_features(const FrameInputs& frame, const AirlightChoice& choice) {
    if (choice.lights.empty()) {
        return 0;
    }
    const bool spot = std::any_of(choice.lights.begin(), choice.lights.end(),
                                  [&](std::uint32_t i) { return frame.lights[i].intensity_type.w > 0.5F; });
    return static_cast<std::uint32_t>(choice.lights.size()) |
           (frame.medium.height.extinction_per_m > 0.0F ? TYNDALL_AIRLIGHT_HEIGHT_BIT : 0U) |
           (spot ? TYNDALL_AIRLIGHT_SPOT_BIT : 0U) | (phase_of(frame.medium).count << TYNDALL_AIRLIGHT_LOBES_SHIFT);
}

} // namespace tyndall::volumetrics
