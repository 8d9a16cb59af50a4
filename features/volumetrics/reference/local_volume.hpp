// Boxes and ellipsoids of fog in double precision, from the definition in docs/fog.md.
#pragma once

#include <vector>

#include "features/volumetrics/local_volume.hpp"
#include "features/volumetrics/reference/geometry.hpp"
#include "features/volumetrics/reference/interval.hpp"

namespace tyndall::volumetrics::reference {

/// What is there per metre.
struct Coefficients {
    glm::dvec3 scattering{0.0};
    glm::dvec3 extinction{0.0};
    glm::dvec3 emission{0.0}; ///< radiance gained
};

[[nodiscard]] bool has_inside(const LocalVolume& volume);

/// `before` with the volume blended in at a point.
[[nodiscard]] Coefficients blended(const LocalVolume& volume, const Coefficients& before, const glm::dvec3& point);

/// A point of the world, and a direction, in a grid that fills the volume's shape from 0 to 1.
[[nodiscard]] glm::dvec3 place_in_grid(const LocalVolume& volume, const glm::dvec3& point);
[[nodiscard]] glm::dvec3 way_in_grid(const LocalVolume& volume, const glm::dvec3& direction);

/// Appends the distances within `part` between which the volume's weight is smooth. Not sorted.
void add_volume_breaks(const LocalVolume& volume, const Ray& ray, Interval part, std::vector<double>& breaks);

/// Where the ray leaves the sphere around the volume; 0 if it does not meet it.
[[nodiscard]] double end_of_volume(const LocalVolume& volume, const Ray& ray);

} // namespace tyndall::volumetrics::reference
