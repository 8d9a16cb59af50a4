// The depth law and its inverse without the cancellation of `exp2(x) - 1` and `log2(1 + x)` in fp32.
#ifndef TYNDALL_SHADERS_COMMON_DEPTH_LAW_GLSL
#define TYNDALL_SHADERS_COMMON_DEPTH_LAW_GLSL

#include "depth_law.h"
#include "phi1.glsl"

// Whether the law may be a curve: a pass that knows defines it as its specialization constant.
#ifndef DEPTH_CURVE
#define DEPTH_CURVE true
#endif

// ln(1 + u) for u >= 0; below 0.25 by the series of 2 artanh(u / (2 + u)), whose first term left out is 5e-11 of it.
float log_one_plus(float u) {
    float v = u / (2.0 + u);
    float v2 = v * v;
    float series = 2.0 * v * (1.0 + v2 * (1.0 / 3.0 + v2 * (0.2 + v2 * (1.0 / 7.0 + v2 * (1.0 / 9.0)))));
    return u < 0.25 ? series : log(1.0 + u);
}

// e^y - 1 for y >= 0.
float exp_minus_one(float y) { return y * phi1(-y); }

// The polyline and its inverse: the sum of what of each piece lies in front. Beyond 1 both go on straight.
float base_from_t(DepthLaw law, float t) {
    vec4 piece = vec4(t * law.pieces.x) - vec4(0.0, 1.0, 2.0, 3.0);
    return dot(law.step_0, clamp(piece, 0.0, 1.0)) + dot(law.step_4, clamp(piece - 4.0, 0.0, 1.0)) + max(t - 1.0, 0.0);
}
float t_from_base(DepthLaw law, float b) {
    vec4 before = clamp((b - law.first_0) * law.inverse_0, 0.0, 1.0);
    vec4 behind = clamp((b - law.first_4) * law.inverse_4, 0.0, 1.0);
    return dot(before + behind, law.pieces.yyyy) + max(b - 1.0, 0.0);
}

// View depth (m) at t in [0, 1].
float depth_from_t(DepthLaw law, float t) {
    float b = DEPTH_CURVE ? base_from_t(law, t) : t;
    return law.range_shape.y * exp_minus_one(b * law.range_shape.z);
}

// t of a view depth in metres; more than 1 beyond the range.
float t_from_depth(DepthLaw law, float depth_m) {
    float b = log_one_plus(max(depth_m, 0.0) / law.range_shape.y) * law.range_shape.w;
    return DEPTH_CURVE ? t_from_base(law, b) : b;
}

#endif
