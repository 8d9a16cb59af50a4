// Densities of texels in double precision: linear between the centres of the texels in every direction.
#pragma once

#include <glm/vec3.hpp>

#include "features/volumetrics/density_texels.hpp"

namespace tyndall::volumetrics::reference {

/// At `place`, 0 to 1 over the texels of each axis. Beyond the outermost centres a density goes on, or it repeats.
[[nodiscard]] double density_at(const DensityTexels& texels, const glm::dvec3& place, bool repeats);

/// What a map leaves of the fog at a point of the world; 1 without a map.
[[nodiscard]] double map_density(const DensityMap& map, const glm::dvec3& point);

} // namespace tyndall::volumetrics::reference
