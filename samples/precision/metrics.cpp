#include "samples/precision/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <glm/geometric.hpp>

namespace tyndall::samples {

ErrorMetrics compare_images(std::span<const glm::dvec3> found, std::span<const glm::dvec3> exact) {
    const auto count = static_cast<double>(exact.size());
    std::vector<double> errors; // squared, a pixel each
    double sum = 0.0;
    double sum_exact = 0.0;
    double sum_squares = 0.0;
    double difference = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        const glm::dvec3 d = found[i] - exact[i];
        errors.push_back(glm::dot(d, d));
        sum += errors.back();
        sum_squares += glm::dot(exact[i], exact[i]);
        difference += d.x + d.y + d.z;
        sum_exact += exact[i].x + exact[i].y + exact[i].z;
    }
    ErrorMetrics metrics;
    metrics.relative_l2 = std::sqrt(sum / sum_squares);
    metrics.rmse = std::sqrt(sum / (3.0 * count));
    metrics.bias = difference / sum_exact;
    // The ratio of two means: its variance to first order (Cochran, Sampling Techniques, 1977, 6.3), halved by the
    // root.
    const double ratio = sum / sum_squares;
    double variance = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        const double residual = errors[i] - ratio * glm::dot(exact[i], exact[i]);
        variance += residual * residual;
    }
    metrics.standard_error = ratio > 0.0 ? 0.5 * std::sqrt(variance) / sum_squares / std::sqrt(ratio) : 0.0;

    const double mean = sum_exact / (3.0 * count);
    const auto relative = [&](double squared) { return std::sqrt(squared / 3.0) / mean; };
    const auto rank = errors.begin() + static_cast<std::ptrdiff_t>(0.99 * (count - 1.0));
    std::nth_element(errors.begin(), rank, errors.end());
    metrics.percentile99 = relative(*rank);
    metrics.maximum = relative(*std::max_element(rank, errors.end()));
    return metrics;
}

} // namespace tyndall::samples
