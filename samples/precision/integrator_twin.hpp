// The integrators of shaders/volumetrics/accumulation.comp in double precision: the same sums, nothing else.
#pragma once

#include <vector>

#include "features/volumetrics/lighting_settings.hpp"

namespace tyndall::samples {

/// What the volumes hold of one slice of a column.
struct TwinSlice {
    double extinction_per_m = 0.0; ///< mean over the slice
    double source_per_m = 0.0;     ///< scattering coefficient times in-scattered radiance at its middle
    double length_m = 0.0;
};

struct TwinResult {
    double radiance = 0.0;
    double optical_depth = 0.0;
};

/// The radiance toward the eye and the optical depth of the whole column; at least 3 slices, each longer than the one
/// before it by the same ratio.
[[nodiscard]] TwinResult integrate(volumetrics::Integrator integrator, const std::vector<TwinSlice>& slices);

} // namespace tyndall::samples
