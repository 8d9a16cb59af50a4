// Sun visibility of a point of the air from the exponential shadow map.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_ESM_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_ESM_GLSL

#include "common/sun_shadow.h"
#include "volumetrics/log_sum.glsl"

// Bilinear in log space: the sampler would filter logarithms. `esm` holds ln of the mean of e^(k z); `size` is its side in
// texels and the reciprocal.
float esm_log_fetch(sampler2DArray esm, vec3 uv_layer, vec2 size) {
    vec2 p = uv_layer.xy * size.x - 0.5;
    vec2 corner = floor(p);
    vec2 f = p - corner;
    // At the corner that the four texels share, the gather is the same whatever the sampler's rounding.
    vec4 logs = textureGather(esm, vec3((corner + 1.0) * size.y, uv_layer.z)); // (0,1) (1,1) (1,0) (0,0)
    vec4 weights = vec4((1.0 - f.x) * f.y, f.x * f.y, f.x * (1.0 - f.y), (1.0 - f.x) * (1.0 - f.y));
    return log_weighted_sum(logs, weights);
}

// Where a point of render space lies in a cascade: uv and depth in xyz, the layer in w; unchanged where another cascade
// has it already, or where it lies outside this one.
void try_cascade(mat4 shadow_from_render, float layer, float split_depth_m, vec3 position, float depth_m,
                 inout vec4 place) {
    if (place.w < 0.0 && depth_m <= split_depth_m) {
        vec3 p = (shadow_from_render * vec4(position, 1.0)).xyz;
        if (all(equal(p.xy, clamp(p.xy, 0.0, 1.0)))) {
            place = vec4(p, layer);
        }
    }
}

// Visibility of the sun, 0 to 1, at a point of render space at a view depth. The first cascade that reaches the depth
// and contains the point decides; outside all of them the sun is not shadowed. Written out for four cascades, since a
// matrix that is indexed at run time is fetched lane by lane.
#define SUN_VISIBILITY(cascades, esm, exponents, size, position, depth_m, visibility)                                  \
    {                                                                                                                  \
        vec4 place = vec4(0.0, 0.0, 0.0, -1.0);                                                                        \
        vec4 reach = mix(cascades.split_depth_m, vec4(-1.0),                                                           \
                         greaterThanEqual(vec4(0.0, 1.0, 2.0, 3.0), vec4(cascades.direction_count.w)));                \
        try_cascade(cascades.shadow_from_render[0], 0.0, reach.x, position, depth_m, place);                           \
        try_cascade(cascades.shadow_from_render[1], 1.0, reach.y, position, depth_m, place);                           \
        try_cascade(cascades.shadow_from_render[2], 2.0, reach.z, position, depth_m, place);                           \
        try_cascade(cascades.shadow_from_render[3], 3.0, reach.w, position, depth_m, place);                           \
        visibility = 1.0;                                                                                              \
        if (place.w >= 0.0) {                                                                                          \
            vec4 chosen = vec4(equal(vec4(place.w), vec4(0.0, 1.0, 2.0, 3.0)));                                        \
            float receiver = dot(exponents, chosen) * clamp(place.z, 0.0, 1.0);                                        \
            visibility = exp(min(esm_log_fetch(esm, place.xyw, size) - receiver, 0.0));                                \
        }                                                                                                              \
    }

#endif
