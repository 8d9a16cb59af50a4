// How far a picture is from the truth.
#pragma once

#include <span>

#include <glm/vec3.hpp>

namespace tyndall::samples {

/// Of linear radiance, over all pixels and channels given.
struct ErrorMetrics {
    double relative_l2 = 0.0;    ///< root of the sum of squared errors by that of squared true values
    double rmse = 0.0;           ///< root of the mean squared error, cd/m^2
    double percentile99 = 0.0;   ///< 99 % of the pixels are off by no more than this part of the mean true value
    double maximum = 0.0;        ///< the worst pixel, likewise
    double bias = 0.0;           ///< sum of errors by that of true values, signed: above 0 the picture is too bright
    double standard_error = 0.0; ///< of relative_l2, if the pixels are a random choice of a picture's
};

/// Both have a value a pixel, in the same order; at least one.
[[nodiscard]] ErrorMetrics compare_images(std::span<const glm::dvec3> found, std::span<const glm::dvec3> exact);

} // namespace tyndall::samples
