// The physics of fog in double precision, written from its definitions; shares no arithmetic with the shaders.
#pragma once

#include <cmath>
#include <numbers>

#include <glm/vec3.hpp>

#include "features/volumetrics/settings.hpp"

namespace tyndall::volumetrics::reference {

/// Henyey and Greenstein 1941, per steradian. `cos_theta`: 1 is forward scattering; g in (-1, 1).
[[nodiscard]] inline double henyey_greenstein(double g, double cos_theta) {
    // The sum of two terms that are never negative: no cancellation near g = 1.
    const double denominator = (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - cos_theta);
    return (1.0 - g * g) / (4.0 * std::numbers::pi * denominator * std::sqrt(denominator));
}

/// Integral of e^(-falloff max(0, y)) along a straight way of `length_m` from height `from_m` to `to_m`, both above the
/// base of the fog. In metres.
[[nodiscard]] inline double height_integral(double falloff_per_m, double from_m, double to_m, double length_m) {
    const double rise_m = std::abs(to_m - from_m);
    const double low_m = std::fmin(from_m, to_m);
    const double high_m = std::fmax(from_m, to_m);
    if (high_m <= 0.0) {
        return length_m;
    }
    const double below = low_m < 0.0 ? -low_m / rise_m : 0.0; // part of the way that lies below the base
    const double start_m = std::fmax(low_m, 0.0);
    const double x = falloff_per_m * (high_m - start_m);
    const double mean = x == 0.0 ? 1.0 : -std::expm1(-x) / x;
    return length_m * (below + (1.0 - below) * std::exp(-falloff_per_m * start_m) * mean);
}

/// Optical depth of the homogeneous and the height fog between two points (world, metres). Density noise has no closed
/// form: the medium's amplitude must be 0.
[[nodiscard]] inline double closed_optical_depth(const Medium& medium, glm::dvec3 from, glm::dvec3 to) {
    const glm::dvec3 way = to - from;
    const double length_m = std::hypot(way.x, way.y, way.z);
    const double base_m = medium.height.base_height_m;
    return static_cast<double>(medium.homogeneous.extinction_per_m) * length_m +
           static_cast<double>(medium.height.extinction_per_m) *
               height_integral(medium.height.falloff_per_m, from.y - base_m, to.y - base_m, length_m);
}

} // namespace tyndall::volumetrics::reference
