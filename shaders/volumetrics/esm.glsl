// Sun visibility of a point of the air from the exponential shadow map.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_ESM_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_ESM_GLSL

#include "common/sun_shadow.h"
#include "volumetrics/log_sum.glsl"

// Bilinear in log space: the sampler would filter logarithms. `esm` holds ln of the mean of e^(k z); size in texels.
float esm_log_fetch(sampler2DArray esm, vec2 uv, int cascade, vec2 size_and_texel) {
    vec2 p = uv * size_and_texel.x - 0.5;
    vec2 corner = floor(p);
    vec2 f = p - corner;
    // At the corner that the four texels share, the gather is the same whatever the sampler's rounding.
    vec4 logs = textureGather(esm, vec3((corner + 1.0) * size_and_texel.y, cascade)); // (0,1) (1,1) (1,0) (0,0)
    vec4 weights = vec4((1.0 - f.x) * f.y, f.x * f.y, f.x * (1.0 - f.y), (1.0 - f.x) * (1.0 - f.y));
    return log_weighted_sum(logs, weights);
}

// Visibility of the sun, 0 to 1, at a point of render space at a view depth. The first cascade that reaches the depth
// and contains the point decides; outside all of them the sun is not shadowed.
float sun_visibility(SunCascades sun, sampler2DArray esm, vec4 exponents, vec2 size_and_texel, vec3 position,
                     float depth_m) {
    int count = int(sun.direction_count.w);
    for (int cascade = 0; cascade < count; ++cascade) {
        if (depth_m > sun.split_depth_m[cascade]) {
            continue;
        }
        vec3 p = (sun.shadow_from_render[cascade] * vec4(position, 1.0)).xyz;
        if (any(lessThan(p.xy, vec2(0.0))) || any(greaterThan(p.xy, vec2(1.0)))) {
            continue;
        }
        float receiver = exponents[cascade] * clamp(p.z, 0.0, 1.0);
        return exp(min(esm_log_fetch(esm, p.xy, cascade, size_and_texel) - receiver, 0.0));
    }
    return 1.0;
}

#endif
