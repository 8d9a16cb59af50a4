// How finely the fog is computed along and across the view.
#pragma once

#include <cstdint>
#include <vector>

namespace tyndall::volumetrics {

/// How boundaries of slices are spread over view depth (shaders/common/depth_law.h).
enum class DepthLawKind : std::uint8_t {
    shaped, ///< z(t) = s (2^(t log2(1 + R / s)) - 1); beyond s = 100 R linear
    linear, ///< z(t) = R t
    curve,  ///< a polyline of t through the depths of `curve_m`
    scene,  ///< shaped, with range and shape made smaller to fit what the view contains (depth_range.hpp)
};

/// The froxel grid: columns over the image, slices over view depth.
struct GridSettings {
    std::uint32_t width = 160; ///< [2, 1024]
    std::uint32_t height = 90; ///< [2, 1024]
    std::uint32_t slices = 64; ///< [8, 512]
    float range_m = 64.0F;     ///< view depth of the last boundary, [1e-2, 1e7]
    float shape_m = 16.0F;     ///< small: slices gather at the eye; large: evenly spread; [1e-4, 1e6] times the range
    DepthLawKind law = DepthLawKind::shaped;
    /// Of a curve: depths at t = 1/n, 2/n, ..., 1 for 1 to 8 of them, growing, the last one the range.
    std::vector<float> curve_m = {};
};

} // namespace tyndall::volumetrics
