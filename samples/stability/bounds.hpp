// What holds of every frame of fog, however extreme: all that is stored is finite, radiance is neither negative nor
// brighter than the brightest source, optical depth never falls along a ray.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

namespace tyndall::samples {

/// What one intermediate image of the fog holds.
struct StageValues {
    std::string name; ///< "density", "esm", "lighting" or "accumulated"
    std::uint32_t width = 1;
    std::uint32_t height = 1;
    std::uint32_t slices = 1;  ///< or layers
    std::vector<float> values; ///< channel by channel of each texel, x fastest, then y; 4 channels, the ESM has 1
};

struct BoundsReport {
    std::size_t not_finite = 0;      ///< stored values
    std::size_t negative = 0;        ///< radiances and coefficients below 0
    std::size_t over_extinction = 0; ///< scattering coefficients above the extinction
    std::size_t falling_depth = 0;   ///< boundaries with less optical depth than the one before
    double over_source = 0.0;        ///< brightest radiance toward the eye by the brightest in-scattered one
};

/// Of all intermediates of a frame and its picture. With `tolerance`, what the storage format rounds in parts of a
/// value, radiance may exceed the source and scattering the extinction by so much.
[[nodiscard]] BoundsReport check_bounds(std::span<const StageValues> stages, std::span<const glm::dvec3> picture,
                                        double tolerance);

/// Nothing is out of bounds.
[[nodiscard]] bool holds(const BoundsReport& report, double tolerance);

/// What is out of bounds, in words; empty where nothing is.
[[nodiscard]] std::string to_text(const BoundsReport& report, double tolerance);

/// The largest error of a pixel's channel in parts of its exact value, which counts as at least `floor` times the
/// picture's mean, and the mean as at least `least_mean`. Where the exact picture and that are black, 0 if the other is
/// too, else infinite.
[[nodiscard]] double worst_relative_error(std::span<const glm::dvec3> found, std::span<const glm::dvec3> exact,
                                          double floor = 1e-3, double least_mean = 0.0);

} // namespace tyndall::samples
