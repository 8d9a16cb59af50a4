#include "features/volumetrics/reference/noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace tyndall::volumetrics::reference {
namespace {

std::uint32_t modulo_period(double cell) {
    return static_cast<std::uint32_t>(cell - 256.0 * std::floor(cell / 256.0));
}

glm::dvec3 gradient(std::uint32_t h) {
    h ^= h >> 15U;
    h *= 0x2c1b3c6dU;
    h ^= h >> 12U;
    const glm::dvec3 bits(h & 1023U, h >> 10U & 1023U, h >> 20U & 1023U);
    return (2.0 * bits - 1023.0) / 1024.0;
}

double fade(double a) {
    return a * a * a * (10.0 + a * (6.0 * a - 15.0));
}

} // namespace

double gradient_noise(const glm::dvec3& p) {
    const glm::dvec3 cell = glm::floor(p);
    const glm::dvec3 inside = p - cell;
    const glm::dvec3 weight(fade(inside.x), fade(inside.y), fade(inside.z));
    constexpr std::array factors{0x8da6b343U, 0xd8163841U, 0xcb1ab31fU};
    std::array<std::array<std::uint32_t, 2>, 3> words{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::uint32_t first = modulo_period(cell[static_cast<int>(axis)]);
        words[axis] = {first * factors[axis], (first + 1U) % 256U * factors[axis]};
    }
    double sum = 0.0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        const glm::uvec3 side(corner & 1U, corner >> 1U & 1U, corner >> 2U);
        const glm::dvec3 at(side);
        const glm::dvec3 share = at * weight + (1.0 - at) * (1.0 - weight);
        const glm::dvec3 slope = gradient(words[0][side.x] ^ words[1][side.y] ^ words[2][side.z]);
        sum += share.x * share.y * share.z * glm::dot(slope, inside - at);
    }
    return std::clamp(1.25 * sum, -1.0, 1.0);
}

glm::dvec3 next_octave(const glm::dvec3& p) {
    return p + p + glm::dvec3(17.375, 5.625, 11.125);
}

double octave_noise(const glm::dvec3& p, std::uint32_t octaves, double gain) {
    double sum = 0.0;
    double weights = 0.0;
    glm::dvec3 at = p;
    for (std::uint32_t i = 0; i < octaves; ++i) {
        const double weight = std::pow(gain, i);
        sum += weight * gradient_noise(at);
        weights += weight;
        at = next_octave(at);
    }
    return sum / weights;
}

void add_lattice_crossings(const glm::dvec3& origin, const glm::dvec3& direction, Interval part, std::size_t most,
                           std::vector<double>& seams) {
    const double planes =
        (part.end - part.begin) * (std::abs(direction.x) + std::abs(direction.y) + std::abs(direction.z));
    if (!(planes <= static_cast<double>(most))) {
        return;
    }
    for (int axis = 0; axis < 3; ++axis) {
        if (direction[axis] == 0.0) {
            continue;
        }
        const double from = origin[axis] + part.begin * direction[axis];
        const double to = origin[axis] + part.end * direction[axis];
        for (double plane = std::ceil(std::min(from, to)); plane < std::max(from, to); plane += 1.0) {
            seams.push_back((plane - origin[axis]) / direction[axis]);
        }
    }
}

} // namespace tyndall::volumetrics::reference
