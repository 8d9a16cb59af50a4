#include "features/volumetrics/density_parameters.hpp"

#include <algorithm>
#include <cmath>

namespace tyndall::volumetrics {
namespace {

/// The camera in units of `scale_m`, modulo `period`, in double: far from the world's origin and late in time the
/// fractions must survive.
glm::vec3 noise_origin(const FrameInputs& frame, double scale_m, const glm::vec3& wind_m_s, double period) {
    glm::vec3 origin(0.0F);
    for (int i = 0; i < 3; ++i) {
        const double drift_m = static_cast<double>(wind_m_s[i]) * frame.time_s;
        const double cells = (frame.camera.origin_m[i] - drift_m) / scale_m;
        origin[i] = static_cast<float>(cells - period * std::floor(cells / period));
    }
    return origin;
}

} // namespace

void write_noise(const FrameInputs& frame, gpu::VolumetricParameters& u) {
    const DensityNoise& noise = frame.medium.noise;
    const auto scale_m = static_cast<double>(noise.scale_m);
    const auto amplitude = static_cast<double>(noise.amplitude);
    if (!is_baked(noise)) {
        u.noise_origin =
            glm::vec4(noise_origin(frame, scale_m, noise.wind_m_s, 256.0), amplitude / octave_weights(noise));
        u.noise_cells = glm::vec4(1.0F / noise.scale_m, noise.gain, 0.0F, 0.0F);
        return;
    }
    const double shape_m = scale_m * DensityNoise::cells_per_period;
    const double detail_m = static_cast<double>(noise.detail_scale_m) * DensityNoise::cells_per_period;
    const double per_coverage = 1.0 / static_cast<double>(noise.coverage);
    u.noise_origin = glm::vec4(noise_origin(frame, shape_m, noise.wind_m_s, 1.0), amplitude);
    u.noise_cells = glm::vec4(1.0 / shape_m, 0.0, 0.0, 0.0);
    u.noise_detail = glm::vec4(noise_origin(frame, detail_m, noise.detail_wind_m_s, 1.0), 1.0 / detail_m);
    u.noise_cover = glm::vec4(per_coverage, 1.0 - per_coverage, noise.detail, 1.0 / mean_cover(noise));
}

void write_map(const FrameInputs& frame, gpu::VolumetricParameters& u) {
    const DensityMap& map = frame.medium.map;
    if (!map.texels) {
        return;
    }
    for (int i = 0; i < 2; ++i) {
        const auto size_m = static_cast<double>(map.size_m[i]);
        const double from_center_m = frame.camera.origin_m[2 * i] - static_cast<double>(map.center_m[i]);
        const double place = 0.5 + from_center_m / size_m;
        u.map_place[i] = static_cast<float>(1.0 / size_m);
        u.map_place[i + 2] = static_cast<float>(map.edge == MapEdge::repeat ? place - std::floor(place) : place);
    }
    const glm::vec2 texels_per_m = glm::vec2(map.texels->size()) / map.size_m;
    u.map_profile =
        glm::vec4(static_cast<double>(map.bottom_m) - frame.camera.origin_m.y, 1.0F / map.fade_m,
                  static_cast<double>(map.top_m) - frame.camera.origin_m.y, std::max(texels_per_m.x, texels_per_m.y));
}

} // namespace tyndall::volumetrics
