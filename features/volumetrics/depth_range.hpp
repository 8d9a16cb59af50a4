// The range and shape of the depth law `scene`: what the view contains, and no more (after Kosian 2020). Pure
// functions.
#pragma once

#include <optional>
#include <string>

#include "features/volumetrics/parameters.hpp"

namespace tyndall::volumetrics {

struct FittedRange {
    float range_m = 0.0F;
    float shape_m = 0.0F;
    std::string why; ///< what it was fitted to, a part of a sentence
};

/// The range is the grid's own over a whole power of the root of 2, the least that reaches behind the farthest visible
/// surface, local light and local volume, and at least a 64th. The shape keeps its proportion to the range, and grows
/// up to it where the nearest visible surface is farther. What the frame before had is kept while the range is at most
/// twice too long and the shape within a factor of 2, since each change begins history anew. The full range where no
/// visible depths are given, or where fog that the far field does not know reaches everywhere: noise and emission.
[[nodiscard]] FittedRange fitted_range(const FrameInputs& frame, const std::optional<FrameMemory>& before);

} // namespace tyndall::volumetrics
