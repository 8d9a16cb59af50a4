// The density noise in double precision.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "features/volumetrics/reference/geometry.hpp"

namespace tyndall::volumetrics::reference {

/// One octave of Perlin's gradient noise ("Improving Noise", 2002) with hashed gradients, of period 256 in each axis,
/// within [-1, 1]. `p` in cells.
///
/// The gradient at lattice point (x, y, z), each taken modulo 256, comes of the 32-bit word
/// h = 0x8da6b343 x ^ 0xd8163841 y ^ 0xcb1ab31f z; h ^= h >> 15; h *= 0x2c1b3c6d; h ^= h >> 12: three groups of ten
/// bits, the lowest for x, each g meaning (2 g - 1023) / 1024. The eight products of gradient and offset are
/// interpolated by 6 a^5 - 15 a^4 + 10 a^3 in each axis, scaled by 1.25 and clamped.
[[nodiscard]] double gradient_noise(const glm::dvec3& p);

/// The point of octave i + 1 that belongs to the point `p` of octave i: 2 p + (17.375, 5.625, 11.125).
[[nodiscard]] glm::dvec3 next_octave(const glm::dvec3& p);

/// Mean of the octaves of gradient noise, the first at `p`, the i-th weighted by gain^i: of period 256, in [-1, 1].
[[nodiscard]] double octave_noise(const glm::dvec3& p, std::uint32_t octaves, double gain);

/// Appends where the ray, its origin and direction in cells, crosses a plane of the lattice within `part`: between two
/// such places the noise is a polynomial. Nothing is added if there are more than `most` of them.
void add_lattice_crossings(const glm::dvec3& origin, const glm::dvec3& direction, Interval part, std::size_t most,
                           std::vector<double>& seams);

} // namespace tyndall::volumetrics::reference
