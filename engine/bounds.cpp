#include "engine/bounds.hpp"

#include <algorithm>
#include <cmath>

namespace tyndall::engine {
namespace {

/// Largest eigenvalue of a symmetric 3x3 matrix, by the trigonometric solution of its cubic (Smith, Eigenvalues of a
/// symmetric 3x3 matrix, CACM 1961).
double largest_eigenvalue(const glm::dmat3& a) {
    const double mean = (a[0][0] + a[1][1] + a[2][2]) / 3.0;
    const glm::dmat3 deviator = a - glm::dmat3(mean);
    double squares = 0.0;
    for (int i = 0; i < 3; ++i) {
        squares += glm::dot(deviator[i], deviator[i]);
    }
    const double p = std::sqrt(squares / 6.0);
    if (!(p > 0.0)) {
        return mean;
    }
    const double half_determinant = std::clamp(0.5 * glm::determinant(deviator / p), -1.0, 1.0);
    return mean + 2.0 * p * std::cos(std::acos(half_determinant) / 3.0);
}

} // namespace

Bounds bounds_of(const Primitive& primitive) {
    Bounds bounds;
    for (const std::uint32_t index : primitive.indices) {
        bounds.box.grow(glm::dvec3(primitive.positions[index]));
    }
    if (bounds.box.empty()) {
        return bounds;
    }
    bounds.sphere.center = bounds.box.center();
    double squared_radius = 0.0;
    for (const std::uint32_t index : primitive.indices) {
        const glm::dvec3 offset = glm::dvec3(primitive.positions[index]) - bounds.sphere.center;
        squared_radius = std::max(squared_radius, glm::dot(offset, offset));
    }
    bounds.sphere.radius_m = std::sqrt(squared_radius);
    return bounds;
}

Box transformed(const Box& box, const glm::dmat4& transform) {
    if (box.empty()) {
        return box;
    }
    const glm::dvec3 half = 0.5 * box.extent();
    const glm::dvec3 center(transform * glm::dvec4(box.center(), 1.0));
    glm::dvec3 reach(0.0);
    for (int i = 0; i < 3; ++i) {
        reach += glm::abs(glm::dvec3(transform[i])) * half[i];
    }
    return Box{center - reach, center + reach};
}

Sphere transformed(const Sphere& sphere, const glm::dmat4& transform) {
    const glm::dmat3 linear(transform);
    const double squared_scale = largest_eigenvalue(glm::transpose(linear) * linear);
    return Sphere{glm::dvec3(transform * glm::dvec4(sphere.center, 1.0)),
                  sphere.radius_m * std::sqrt(std::max(squared_scale, 0.0))};
}

} // namespace tyndall::engine
