// What stored radiance is multiplied by, so that it fits half precision.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <glm/geometric.hpp>

#include "features/volumetrics/parameters.hpp"

namespace tyndall::volumetrics {
namespace {

/// Of the brightest channel, cd.
double brightest_cd(const gpu::GpuLight& light) {
    const glm::vec4& candela = light.intensity_type;
    return static_cast<double>(std::max({candela.x, candela.y, candela.z}));
}

/// Lights beside which `local_radiance` looks for the brightest place.
constexpr std::size_t most_places = 64;

/// All of the lights, or most_places at equal steps of the sum of intensities in the host's order: a bright crowd has
/// some of them.
std::vector<std::size_t> places_to_look(const std::vector<gpu::GpuLight>& lights) {
    double total_cd = 0.0;
    for (const gpu::GpuLight& light : lights) {
        total_cd += brightest_cd(light);
    }
    std::vector<std::size_t> places;
    double sum_cd = 0.0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const double step_before = std::floor(sum_cd / total_cd * most_places + 0.5);
        sum_cd += brightest_cd(lights[i]);
        const double step = std::floor(sum_cd / total_cd * most_places + 0.5);
        if (lights.size() <= most_places || step > step_before) {
            places.push_back(i);
        }
    }
    return places;
}

/// Radiance that all local lights together in-scatter beside one of them, the largest found: a decimetre and more from
/// each light in the grid, at the grid's nearest place to one outside. `longest_m` holds the grid around the eye.
///
/// At any place a decimetre or more from all lights it is at most four times that beside the light nearest to there,
/// since every other light is at least half as far from the place as from that light. Up to most_places lights the
/// search is complete; of more it is a sample, so that its cost stays linear, and a bound of each light alone.
double local_radiance(const FrameInputs& frame, double longest_m) {
    const auto received = [](const gpu::GpuLight& light, double distance_m) {
        const double nearest_m = std::max({distance_m, static_cast<double>(light.direction_radius.w), 0.1});
        return distance_m < static_cast<double>(light.position_range.w) ? brightest_cd(light) / (nearest_m * nearest_m)
                                                                        : 0.0;
    };
    double largest = 0.0;
    for (const gpu::GpuLight& light : frame.lights) {
        largest = std::max(largest, received(light, glm::length(glm::dvec3(light.position_range)) - longest_m));
    }
    for (const std::size_t i : places_to_look(frame.lights)) {
        const glm::dvec3 position_m(frame.lights[i].position_range);
        const glm::dvec3 place_m = position_m * std::min(1.0, longest_m / std::max(glm::length(position_m), 1e-30));
        double sum = 0.0;
        for (const gpu::GpuLight& light : frame.lights) {
            sum += received(light, glm::distance(glm::dvec3(light.position_range), place_m));
        }
        largest = std::max(largest, sum);
    }
    return largest * peak(phase_of(frame.medium));
}

} // namespace

float radiance_scale_for(const FrameInputs& frame, const std::optional<FrameMemory>& before) {
    if (frame.settings.storage == StorageFormat::fp32) {
        return 1.0F;
    }
    const glm::vec3 directed = ambient_length(frame.medium);
    const glm::vec3 ambient = frame.medium.ambient_radiance + static_cast<float>(sh_1_constant) * directed;
    double brightest = std::max({ambient.x, ambient.y, ambient.z});
    if (frame.sun) {
        const glm::vec3& sun = frame.sun->illuminance_lux;
        brightest += peak(phase_of(frame.medium)) * static_cast<double>(std::max({sun.x, sun.y, sun.z}));
    }
    // The longest ray of the grid is the one along an edge of it.
    const gpu::ScatteringVolume volume = scattering_volume(frame.settings.grid, frame.camera, 1.0F);
    const glm::dvec4 slope(volume.slope);
    const double slope_x = std::max(std::abs(slope.z), std::abs(slope.x + slope.z));
    const double slope_y = std::max(std::abs(slope.w), std::abs(slope.y + slope.w));
    const double longest_m = static_cast<double>(frame.settings.grid.range_m) * std::hypot(1.0, slope_x, slope_y);
    brightest += noise_bound(frame.medium.noise) * emitted_radiance_bound(frame.medium, longest_m);
    const double local = local_radiance(frame, longest_m);
    brightest += local;
    const double largest = 32768.0; // half of fp16's, which leaves room right beside local lights
    // Radiance of fog a ten-millionth as bright still has all of fp16's digits; of light that falls off from a lamp,
    // more.
    const double smallest = local > 0.5 * brightest ? 16384.0 : 512.0;
    if (before && before->storage == StorageFormat::fp16) {
        const auto kept = static_cast<double>(before->volume.scale.x);
        if (brightest * kept <= largest && brightest * kept >= smallest / 16.0) {
            return before->volume.scale.x;
        }
    }
    double scale = 1.0;
    if (brightest > largest) {
        scale = std::exp2(-std::min(std::ceil(std::log2(brightest / largest)), 100.0));
    } else if (brightest > 0.0 && brightest < smallest) {
        scale = std::exp2(std::min(std::floor(std::log2(smallest / brightest)), 100.0));
    }
    return static_cast<float>(scale);
}

} // namespace tyndall::volumetrics
