#include "features/volumetrics/depth_range.hpp"

#include <algorithm>
#include <cmath>

namespace tyndall::volumetrics {
namespace {

double view_depth_m(const Camera& camera, const glm::dvec3& render_position) {
    return -(camera.view_from_render * glm::dvec4(render_position, 1.0)).z;
}

double farthest_m(const FrameInputs& frame) {
    double farthest = frame.visible_depth_m->farthest_m;
    if (frame.sun && frame.sun->casts_shadows) {
        farthest *= 1.25; // shadows fall behind what throws them
    }
    for (const gpu::GpuLight& light : frame.lights) {
        // A light against the sky: nearly all that it scatters comes from a quarter of its reach.
        const double depth_m = view_depth_m(frame.camera, glm::dvec3(light.position_range));
        farthest = std::max(farthest, depth_m + 0.25 * static_cast<double>(light.position_range.w));
    }
    for (const LocalVolume& volume : frame.medium.volumes) {
        const double depth_m = view_depth_m(frame.camera, glm::dvec3(volume.center_m) - frame.camera.origin_m);
        farthest = std::max(farthest, depth_m + glm::length(glm::dvec3(volume.half_size_m)));
    }
    for (const FogParticle& particle : frame.fog_particles) {
        const double depth_m = view_depth_m(frame.camera, glm::dvec3(particle.position_m));
        farthest = std::max(farthest, depth_m + static_cast<double>(particle.radius_m));
    }
    return farthest;
}

} // namespace

FittedRange fitted_range(const FrameInputs& frame, const std::optional<FrameMemory>& before) {
    const GridSettings& grid = frame.settings.grid;
    const auto full_because = [&](const char* why) { return FittedRange{grid.range_m, grid.shape_m, why}; };
    if (!frame.visible_depth_m) {
        return full_because("the host gives no visible depths");
    }
    if (frame.medium.noise.amplitude > 0.0F) {
        return full_because("noise ends at the range");
    }
    if (frame.medium.map.texels) {
        return full_because("the density map ends at the range");
    }
    if (frame.medium.homogeneous.emission_per_m != glm::vec3(0.0F) ||
        frame.medium.height.emission_per_m != glm::vec3(0.0F)) {
        return full_because("emission ends at the range");
    }
    const double longest_m = grid.range_m;
    const double needed_m = std::clamp(1.05 * farthest_m(frame), longest_m / 64.0, longest_m);
    const double halves = std::floor(2.0 * std::log2(longest_m / needed_m) + 1e-9);
    double range_m = longest_m * std::exp2(-0.5 * halves);
    const double range_before_m = before ? static_cast<double>(before->volume.law.range_shape.x) : 0.0;
    // A little less than needed is still there: single precision holds the range.
    if (range_before_m >= 0.999999 * needed_m && range_before_m <= 2.000001 * range_m &&
        range_before_m <= 1.000001 * longest_m) {
        range_m = range_before_m;
    }
    const double proportion = static_cast<double>(grid.shape_m) / longest_m;
    double shape_m = std::clamp(static_cast<double>(frame.visible_depth_m->nearest_m), proportion * range_m,
                                std::max(proportion * range_m, range_m));
    const double shape_before_m = before ? static_cast<double>(before->volume.law.range_shape.y) : 0.0;
    if (range_m == range_before_m && shape_before_m > 0.5 * shape_m && shape_before_m < 2.0 * shape_m) {
        shape_m = shape_before_m;
    }
    return {static_cast<float>(range_m), static_cast<float>(shape_m),
            range_m < longest_m ? "nothing in the view is farther" : "the view reaches as far"};
}

} // namespace tyndall::volumetrics
