// The depth law and its inverse without the cancellation of `exp2(x) - 1` and `log2(1 + x)` in fp32.
#ifndef TYNDALL_SHADERS_COMMON_DEPTH_LAW_GLSL
#define TYNDALL_SHADERS_COMMON_DEPTH_LAW_GLSL

#include "depth_law.h"
#include "phi1.glsl"

// ln(1 + u) for u >= 0; below 0.25 by the series of 2 artanh(u / (2 + u)), whose first term left out is 5e-11 of it.
float log_one_plus(float u) {
    float v = u / (2.0 + u);
    float v2 = v * v;
    float series = 2.0 * v * (1.0 + v2 * (1.0 / 3.0 + v2 * (0.2 + v2 * (1.0 / 7.0 + v2 * (1.0 / 9.0)))));
    return u < 0.25 ? series : log(1.0 + u);
}

// e^y - 1 for y >= 0.
float exp_minus_one(float y) { return y * phi1(-y); }

// View depth (m) at t in [0, 1].
float depth_from_t(DepthLaw law, float t) { return law.range_shape.y * exp_minus_one(t * law.range_shape.z); }

// t of a view depth in metres; more than 1 beyond the range.
float t_from_depth(DepthLaw law, float depth_m) {
    return log_one_plus(max(depth_m, 0.0) / law.range_shape.y) * law.range_shape.w;
}

#endif
