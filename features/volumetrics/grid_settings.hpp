// How finely the fog is computed along and across the view.
#pragma once

#include <cstdint>

namespace tyndall::volumetrics {

/// The froxel grid: columns over the image, slices over view depth (see shaders/common/depth_law.h).
struct GridSettings {
    std::uint32_t width = 160; ///< [1, 1024]
    std::uint32_t height = 90; ///< [1, 1024]
    std::uint32_t slices = 64; ///< [1, 512]
    float range_m = 64.0F;     ///< view depth of the last boundary, [1e-2, 1e7]
    float shape_m = 16.0F;     ///< small: slices gather at the eye; large: evenly spread; [1e-4, 100] times the range
};

} // namespace tyndall::volumetrics
