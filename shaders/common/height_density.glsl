// Density of exponential height fog along a straight path.
#ifndef TYNDALL_SHADERS_COMMON_HEIGHT_DENSITY_GLSL
#define TYNDALL_SHADERS_COMMON_HEIGHT_DENSITY_GLSL

#include "phi1.glsl"

// Mean over a path of e^(-falloff max(0, y - base)) along a line between heights a and b above the base: exact, so
// that optical depth is too. One part of the line may lie below the base.
float mean_height_density(float a, float b, float falloff) {
    float low = min(a, b);
    float high = max(a, b);
    float low_above = max(low, 0.0);
    float above = max(high - low_above, 0.0);
    float fraction_above = mix(float(low > 0.0), clamp(above / (high - low), 0.0, 1.0), high > low);
    float mean_above = exp(-falloff * low_above) * phi1(falloff * above);
    return mix(1.0, mean_above, fraction_above);
}

#endif
