// Point and spot lights in double precision.
#pragma once

#include <optional>
#include <vector>

#include "features/volumetrics/reference/scene.hpp"

namespace tyndall::volumetrics::reference {

/// Irradiance (lux) of a surface at `point` that faces the light, through empty space.
[[nodiscard]] glm::dvec3 irradiance(const Light& light, const glm::dvec3& point);

/// The part of the ray within the light's range; none if it passes by.
[[nodiscard]] std::optional<Interval> within_range(const Light& light, const Ray& ray, Interval part);

/// Appends where the ray enters and leaves the source's radius and the inner and outer cone. Not sorted; some may lie
/// on the cones' other halves.
void add_light_breaks(const Light& light, const Ray& ray, std::vector<double>& breaks);

} // namespace tyndall::volumetrics::reference
