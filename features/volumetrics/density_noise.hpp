// Noise by which the density of all fog is multiplied, its emission too. Its mean over all space is 1.
#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

#include "features/volumetrics/range_check.hpp"

namespace tyndall::volumetrics {

enum class NoiseKind : std::uint8_t {
    /// 1 + amplitude * noise, the noise being the mean of octaves of gradient noise weighted by gain^i, in [-1, 1];
    /// octave i + 1 at the point p, in cells, is octave i at 2 p + (17.375, 5.625, 11.125), which keeps octaves from
    /// vanishing at the same points.
    perlin,
    /// 1 + amplitude * (n / m - 1), from two volumes that are baked once and repeat in every direction, their texels
    /// uniform on [0, 1]: the shape s, of 4 cells and 128 texels a side, and the detail t, of 4 cells and 32 texels.
    /// c = max(0, (s - (1 - coverage)) / coverage), e = detail t, n = max(0, (c - e) / (1 - e)), and the mean of n is
    /// m = coverage / 2 (1 - detail / 2). So `coverage` is the part of space that has fog before detail takes its
    /// share.
    perlin_worley,
};

struct DensityNoise {
    static constexpr std::uint32_t most_octaves = 8;
    static constexpr float cells_per_period = 4.0F; ///< of both volumes of perlin_worley

    NoiseKind kind = NoiseKind::perlin;
    float amplitude = 0.0F;          ///< [0, 1]; 0: no noise
    float scale_m = 4.0F;            ///< size of a cell of the first octave, of the shape's; [1e-3, 1e6]
    glm::vec3 wind_m_s{0.0F};        ///< velocity with which the pattern moves, each in [-1e3, 1e3]
    std::uint32_t octaves = 1;       ///< of perlin, [1, most_octaves], each twice as fine as the one before
    float gain = 0.5F;               ///< of perlin, weight of an octave over that of the one before, [0, 1]
    float coverage = 0.5F;           ///< of perlin_worley, [0.01, 1]
    float detail = 0.4F;             ///< of perlin_worley: what the detail takes at most, [0, 0.95]
    float detail_scale_m = 1.0F;     ///< size of a cell of the detail, [1e-4, 1e6]
    glm::vec3 detail_wind_m_s{0.0F}; ///< velocity of the detail, each in [-1e3, 1e3]

    friend bool operator==(const DensityNoise&, const DensityNoise&) = default;
};

/// Made of baked volumes.
[[nodiscard]] inline bool is_baked(const DensityNoise& noise) {
    return noise.amplitude > 0.0F && noise.kind == NoiseKind::perlin_worley;
}

/// Sum of the weights of perlin's octaves, the first one's being 1.
[[nodiscard]] double octave_weights(const DensityNoise& noise);

/// m of perlin_worley.
[[nodiscard]] double mean_cover(const DensityNoise& noise);

/// No less than what density is multiplied by anywhere.
[[nodiscard]] double noise_bound(const DensityNoise& noise);

void check_noise(const DensityNoise& noise, RangeCheck& check);

} // namespace tyndall::volumetrics
