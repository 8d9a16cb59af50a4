// A part of a line.
#pragma once

#include <limits>

namespace tyndall::volumetrics::reference {

/// Distances from a ray's origin, m, or another variable's span; `end` may be infinite.
struct Interval {
    double begin = 0.0;
    double end = std::numeric_limits<double>::infinity();
};

} // namespace tyndall::volumetrics::reference
