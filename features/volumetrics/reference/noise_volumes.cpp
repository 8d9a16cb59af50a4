#include "features/volumetrics/reference/noise_volumes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "shaders/volumetrics/noise_quantiles.h"

namespace tyndall::volumetrics::reference {
namespace {

std::int64_t wrapped(std::int64_t i, std::uint32_t period) {
    const std::int64_t rest = i % period;
    return rest < 0 ? rest + period : rest;
}

/// A cell of a lattice that repeats after `cells`, and its neighbours.
class Cell {
public:
    Cell(const glm::dvec3& p, std::uint32_t cells, std::uint32_t seed) : seed_(seed) {
        constexpr std::array factors{0x8da6b343U, 0xd8163841U, 0xcb1ab31fU};
        for (int axis = 0; axis < 3; ++axis) {
            const auto first = static_cast<std::int64_t>(std::floor(p[axis])) - 1;
            for (int side = 0; side < 3; ++side) {
                const auto at = static_cast<std::uint32_t>(wrapped(first + side, cells));
                words_[static_cast<std::size_t>(axis)][static_cast<std::size_t>(side)] =
                    at * factors[static_cast<std::size_t>(axis)];
            }
        }
    }
    /// The three groups of ten bits of the neighbour x, y, z cells away, each -1, 0 or 1.
    [[nodiscard]] glm::dvec3 bits(int x, int y, int z) const {
        const auto word = [&](std::size_t axis, int side) {
            const int place = side + 1;
            return words_[axis][static_cast<std::size_t>(place)];
        };
        std::uint32_t h = seed_ ^ word(0, x) ^ word(1, y) ^ word(2, z);
        h ^= h >> 15U;
        h *= 0x2c1b3c6dU;
        h ^= h >> 12U;
        return {h & 1023U, h >> 10U & 1023U, h >> 20U & 1023U};
    }

private:
    std::uint32_t seed_;
    std::array<std::array<std::uint32_t, 3>, 3> words_{};
};

/// The polyline through the quantiles.
double rank_among(const Quantiles& quantiles, double value) {
    constexpr Quantiles ranks{TYNDALL_NOISE_RANKS};
    const auto above =
        static_cast<std::size_t>(std::upper_bound(quantiles.begin(), quantiles.end(), value) - quantiles.begin());
    if (above == 0 || above == quantiles.size()) {
        return above == 0 ? 0.0 : 1.0;
    }
    const double part = (value - quantiles[above - 1]) / (quantiles[above] - quantiles[above - 1]);
    return ranks[above - 1] + part * (ranks[above] - ranks[above - 1]);
}

} // namespace

double tiled_gradient_noise(const glm::dvec3& p, std::uint32_t cells, std::uint32_t seed) {
    const glm::dvec3 q = p * static_cast<double>(cells);
    const glm::dvec3 f = q - glm::floor(q);
    const glm::dvec3 share = f * f * f * (10.0 + f * (6.0 * f - 15.0));
    const Cell cell(q, cells, seed);
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::ivec3 side(corner & 1, corner >> 1 & 1, corner >> 2);
        const glm::dvec3 slope = (2.0 * cell.bits(side.x, side.y, side.z) - 1023.0) / 1024.0;
        double weight = 1.0;
        for (int axis = 0; axis < 3; ++axis) {
            weight *= side[axis] == 1 ? share[axis] : 1.0 - share[axis];
        }
        sum += weight * glm::dot(slope, f - glm::dvec3(side));
    }
    return std::clamp(1.25 * sum, -1.0, 1.0);
}

double tiled_worley_noise(const glm::dvec3& p, std::uint32_t cells, std::uint32_t seed) {
    const glm::dvec3 q = p * static_cast<double>(cells);
    const glm::dvec3 f = q - glm::floor(q);
    const Cell cell(q, cells, seed);
    double nearest_squared = 1.0;
    for (int z = -1; z <= 1; ++z) {
        for (int y = -1; y <= 1; ++y) {
            for (int x = -1; x <= 1; ++x) {
                const glm::dvec3 point = glm::dvec3(x, y, z) + (cell.bits(x, y, z) + 0.5) / 1024.0;
                nearest_squared = std::fmin(nearest_squared, glm::dot(point - f, point - f));
            }
        }
    }
    return 1.0 - std::sqrt(nearest_squared);
}

double raw_noise_shape(const glm::dvec3& p) {
    const double perlin =
        (4.0 * tiled_gradient_noise(p, 4, 1) + 2.0 * tiled_gradient_noise(p, 8, 2) + tiled_gradient_noise(p, 16, 3)) /
        7.0;
    const double worley =
        (5.0 * tiled_worley_noise(p, 4, 4) + 2.0 * tiled_worley_noise(p, 8, 5) + tiled_worley_noise(p, 16, 6)) / 8.0;
    return worley + (1.0 - worley) * (1.0 + perlin) / 2.0;
}

double raw_noise_detail(const glm::dvec3& p) {
    return (2.0 * tiled_worley_noise(p, 4, 7) + tiled_worley_noise(p, 8, 8)) / 3.0;
}

NoiseVolume::NoiseVolume(std::uint32_t size, Raw raw, const Quantiles& quantiles)
    : size_(size), raw_(raw), quantiles_(&quantiles), texels_(std::size_t{size} * size * size) {
    for (std::atomic<float>& texel : texels_) {
        texel.store(not_made, std::memory_order_relaxed);
    }
}

const NoiseVolume& NoiseVolume::shape() {
    static constexpr Quantiles quantiles{TYNDALL_SHAPE_QUANTILES};
    static const NoiseVolume volume(128, raw_noise_shape, quantiles);
    return volume;
}

const NoiseVolume& NoiseVolume::detail() {
    static constexpr Quantiles quantiles{TYNDALL_DETAIL_QUANTILES};
    static const NoiseVolume volume(32, raw_noise_detail, quantiles);
    return volume;
}

double NoiseVolume::texel(std::int64_t x, std::int64_t y, std::int64_t z) const {
    const glm::dvec3 at(wrapped(x, size_), wrapped(y, size_), wrapped(z, size_));
    const double size = size_;
    std::atomic<float>& kept = texels_[static_cast<std::size_t>((at.z * size + at.y) * size + at.x)];
    float value = kept.load(std::memory_order_relaxed);
    if (value == not_made) { // two threads may both make it: the same
        value = static_cast<float>(rank_among(*quantiles_, raw_((at + 0.5) / size)));
        kept.store(value, std::memory_order_relaxed);
    }
    return static_cast<double>(value);
}

double NoiseVolume::at(const glm::dvec3& p) const {
    const glm::dvec3 q = p * static_cast<double>(size_) - 0.5;
    const glm::dvec3 f = q - glm::floor(q);
    const std::array<std::int64_t, 3> first{static_cast<std::int64_t>(std::floor(q.x)),
                                            static_cast<std::int64_t>(std::floor(q.y)),
                                            static_cast<std::int64_t>(std::floor(q.z))};
    const auto row = [&](std::int64_t y, std::int64_t z) {
        return (1.0 - f.x) * texel(first[0], y, z) + f.x * texel(first[0] + 1, y, z);
    };
    const auto plane = [&](std::int64_t z) { return (1.0 - f.y) * row(first[1], z) + f.y * row(first[1] + 1, z); };
    return (1.0 - f.z) * plane(first[2]) + f.z * plane(first[2] + 1);
}

} // namespace tyndall::volumetrics::reference
