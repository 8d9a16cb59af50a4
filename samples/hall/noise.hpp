#pragma once

#include <cmath>
#include <cstdint>

#include <glm/glm.hpp>

namespace tyndall::hall {

/// 32-bit finaliser with full avalanche ("lowbias32", Wellons 2018, public domain constants): same bits on every
/// machine.
[[nodiscard]] constexpr std::uint32_t hash(std::uint32_t value) {
    value ^= value >> 16;
    value *= 0x7feb352dU;
    value ^= value >> 15;
    value *= 0x846ca68bU;
    value ^= value >> 16;
    return value;
}

/// A number in [0, 1) that depends on a lattice point and a seed.
[[nodiscard]] constexpr float hash01(int x, int y, std::uint32_t seed) {
    const std::uint32_t bits =
        hash(static_cast<std::uint32_t>(x) ^ hash(static_cast<std::uint32_t>(y) ^ hash(seed + 0x9e3779b9U)));
    return static_cast<float>(bits >> 8) * (1.0F / 16777216.0F);
}

/// Value noise in [0, 1), smooth, repeating after `period` lattice cells in both directions (so that textures tile).
[[nodiscard]] inline float value_noise(glm::vec2 point, int period, std::uint32_t seed) {
    const glm::vec2 cell = glm::floor(point);
    const glm::vec2 f = point - cell;
    const glm::vec2 s = f * f * (3.0F - 2.0F * f);
    const auto wrap = [period](int i) { return ((i % period) + period) % period; };
    const int x0 = wrap(static_cast<int>(cell.x));
    const int y0 = wrap(static_cast<int>(cell.y));
    const int x1 = wrap(x0 + 1);
    const int y1 = wrap(y0 + 1);
    return glm::mix(glm::mix(hash01(x0, y0, seed), hash01(x1, y0, seed), s.x),
                    glm::mix(hash01(x0, y1, seed), hash01(x1, y1, seed), s.x), s.y);
}

/// Sum of octaves of value noise, each twice as fine and half as strong, normalised to [0, 1). `uv` in [0, 1) is one
/// tile.
[[nodiscard]] inline float fractal_noise(glm::vec2 uv, int period, int octaves, std::uint32_t seed) {
    float sum = 0.0F;
    float weight = 0.5F;
    float total = 0.0F;
    for (int octave = 0; octave < octaves; ++octave) {
        sum += weight * value_noise(uv * static_cast<float>(period), period, seed + static_cast<std::uint32_t>(octave));
        total += weight;
        weight *= 0.5F;
        period *= 2;
    }
    return sum / total;
}

} // namespace tyndall::hall
