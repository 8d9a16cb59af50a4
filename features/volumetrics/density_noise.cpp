#include "features/volumetrics/density_noise.hpp"

namespace tyndall::volumetrics {

double octave_weights(const DensityNoise& noise) {
    double sum = 0.0;
    for (std::uint32_t i = noise.octaves; i > 0; --i) { // Horner's scheme
        sum = 1.0 + static_cast<double>(noise.gain) * sum;
    }
    return sum;
}

double mean_cover(const DensityNoise& noise) {
    // c exceeds x with the probability coverage (1 - x), so that the mean of max(0, c - e) is coverage (1 - e)^2 / 2;
    // of n that is coverage (1 - e) / 2, with e uniform up to `detail` and independent of c.
    return 0.5 * static_cast<double>(noise.coverage) * (1.0 - 0.5 * static_cast<double>(noise.detail));
}

double noise_bound(const DensityNoise& noise) {
    const auto amplitude = static_cast<double>(noise.amplitude);
    return is_baked(noise) ? 1.0 + amplitude * (1.0 / mean_cover(noise) - 1.0) : 1.0 + amplitude;
}

void check_noise(const DensityNoise& noise, RangeCheck& check) {
    check.in_range("medium.noise.amplitude", noise.amplitude, 0.0, 1.0);
    check.in_range("medium.noise.scale_m", noise.scale_m, 1e-3, 1e6);
    check.in_range("medium.noise.wind_m_s", noise.wind_m_s, -1e3, 1e3);
    check.in_range("medium.noise.octaves", noise.octaves, 1.0, DensityNoise::most_octaves);
    check.in_range("medium.noise.gain", noise.gain, 0.0, 1.0);
    check.in_range("medium.noise.coverage", noise.coverage, 0.01F, 1.0);
    check.in_range("medium.noise.detail", noise.detail, 0.0, 0.95F);
    check.in_range("medium.noise.detail_scale_m", noise.detail_scale_m, 1e-4F, 1e6);
    check.in_range("medium.noise.detail_wind_m_s", noise.detail_wind_m_s, -1e3, 1e3);
}

} // namespace tyndall::volumetrics
