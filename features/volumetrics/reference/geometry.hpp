// Triangles in double precision: what a ray hits, and which parts of it a light reaches.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "features/volumetrics/reference/interval.hpp"

namespace tyndall::volumetrics::reference {

/// World space, metres.
struct Ray {
    glm::dvec3 origin{0.0};
    glm::dvec3 direction{0.0, 0.0, -1.0}; ///< unit
};

[[nodiscard]] inline glm::dvec3 point_at(const Ray& ray, double distance_m) {
    return ray.origin + distance_m * ray.direction;
}

/// Lambertian, of both sides alike.
struct Triangle {
    std::array<glm::dvec3, 3> corners; ///< world space, m
    glm::dvec3 albedo{0.0};            ///< each in [0, 1]
    glm::dvec3 emission{0.0};          ///< radiance, cd/m^2
};

struct Hit {
    double distance_m = 0.0;
    glm::dvec3 normal{0.0}; ///< unit, toward the ray's origin
    std::size_t triangle = 0;
};

/// Embree finds what is hit and whether a surface point is shadowed, in single precision; distances are then those of
/// the triangles' planes in double. The parts of a ray that are lit have no such bound: their ends are computed from
/// the triangles' edges in double.
class Geometry {
public:
    Geometry();
    /// Triangles without area are ignored.
    explicit Geometry(std::vector<Triangle> triangles);
    ~Geometry();
    Geometry(Geometry&&) noexcept;
    Geometry& operator=(Geometry&&) noexcept;
    Geometry(const Geometry&) = delete;
    Geometry& operator=(const Geometry&) = delete;

    [[nodiscard]] const std::vector<Triangle>& triangles() const;

    [[nodiscard]] std::optional<Hit> hit(const Ray& ray) const;

    /// Whether a surface stands between the ray's origin and the point at `distance_m`, which may be infinite.
    [[nodiscard]] bool is_blocked(const Ray& ray, double distance_m) const;

    /// The parts of `part` of the ray from which nothing stands in the direction `toward` (unit): ascending, disjoint.
    [[nodiscard]] std::vector<Interval> lit_from_direction(const Ray& ray, Interval part,
                                                           const glm::dvec3& toward) const;
    /// And from which nothing stands before the point `light`.
    [[nodiscard]] std::vector<Interval> lit_from_point(const Ray& ray, Interval part, const glm::dvec3& light) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace tyndall::volumetrics::reference
