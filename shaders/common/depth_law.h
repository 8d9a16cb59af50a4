// How view depth is spread over slices: z(b) = s (2^(b log2(1 + R / s)) - 1), with range R and shape s in metres.
// z(0) = 0 whatever the near plane; nearly linear for large s, and linear to the last digit for s = 2^20 R. b is t, the
// part of all slices that lies in front, in [0, 1]; where the law is a curve, a polyline of t through up to 8 depths.
#ifndef TYNDALL_SHADERS_COMMON_DEPTH_LAW_H
#define TYNDALL_SHADERS_COMMON_DEPTH_LAW_H

#include "interop.h"

TYNDALL_INTEROP_BEGIN

// Pieces 0 to 3 and 4 to 7 of the polyline, each as long in t as all others. It is straight where there is one.
struct DepthLaw {
    vec4 range_shape; // x: R, m; y: s, m; z: ln(1 + R / s); w: 1 / z
    vec4 pieces;      // x: their number n; y: 1 / n; zw 0
    vec4 first_0;     // b at the piece's beginning; any beyond the n-th
    vec4 first_4;
    vec4 step_0; // b over the piece, 0 beyond the n-th
    vec4 step_4;
    vec4 inverse_0; // 1 / step, 0 beyond the n-th
    vec4 inverse_4;
};

TYNDALL_INTEROP_END

#endif
