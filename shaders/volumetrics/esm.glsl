// Sun visibility of a point of the air from the exponential shadow map.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_ESM_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_ESM_GLSL

#include "common/sun_shadow.h"

// Visibility at a point of the shadow map's space: the bilinear mean of e^(k z), over e^(k receiver), at most 1. The
// sampler would filter the logarithms that `esm` holds, so four texels are fetched and combined here; taken relative to
// the receiver the exponents cannot overflow where it matters, and beyond e^60 the point is lit whatever the weight.
// `size` is the ESM's side in texels and the reciprocal.
float esm_visibility(sampler2DArray esm, vec3 uv_layer, float k_receiver, vec2 size) {
    vec2 p = uv_layer.xy * size.x - 0.5;
    vec2 corner = floor(p);
    vec2 f = p - corner;
    // At the corner that the four texels share, the gather is the same whatever the sampler's rounding.
    vec4 logs = textureGather(esm, vec3((corner + 1.0) * size.y, uv_layer.z)); // (0,1) (1,1) (1,0) (0,0)
    vec4 weights = vec4((1.0 - f.x) * f.y, f.x * f.y, f.x * (1.0 - f.y), (1.0 - f.x) * (1.0 - f.y));
    return min(dot(weights, exp(min(logs - k_receiver, 60.0))), 1.0);
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
// and contains the point decides; outside all of them the sun is not shadowed. Written out for `count` of four cascades,
// and a macro, since a matrix that is indexed at run time, or copied into a function, is fetched lane by lane.
#define SUN_VISIBILITY(cascades, count, esm, exponents, size, position, depth_m, visibility)                           \
    {                                                                                                                  \
        vec4 place = vec4(0.0, 0.0, 0.0, -1.0);                                                                        \
        try_cascade(cascades.shadow_from_render[0], 0.0, cascades.split_depth_m.x, position, depth_m, place);          \
        if (count > 1) {                                                                                               \
            try_cascade(cascades.shadow_from_render[1], 1.0, cascades.split_depth_m.y, position, depth_m, place);      \
        }                                                                                                              \
        if (count > 2) {                                                                                               \
            try_cascade(cascades.shadow_from_render[2], 2.0, cascades.split_depth_m.z, position, depth_m, place);      \
        }                                                                                                              \
        if (count > 3) {                                                                                               \
            try_cascade(cascades.shadow_from_render[3], 3.0, cascades.split_depth_m.w, position, depth_m, place);      \
        }                                                                                                              \
        vec4 chosen = vec4(equal(place.wwww, vec4(0.0, 1.0, 2.0, 3.0)));                                               \
        float k_receiver = dot(exponents, chosen) * clamp(place.z, 0.0, 1.0);                                          \
        float lit = esm_visibility(esm, place.xyw, k_receiver, size);                                                  \
        visibility = place.w >= 0.0 && place.w < cascades.direction_count.w ? lit : 1.0;                               \
    }

#endif
