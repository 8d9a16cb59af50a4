// How much of the sun a surface sees through the shadow cascades. Included after `sun` and `cascades` are declared by
// sun_bindings below; set 0.
#ifndef TYNDALL_SHADERS_ENGINE_SUN_VISIBILITY_GLSL
#define TYNDALL_SHADERS_ENGINE_SUN_VISIBILITY_GLSL

#include "common/sun_shadow.h"

layout(set = 0, binding = 2) uniform Sun { SunCascades sun; };
layout(set = 0, binding = 3) uniform sampler2DArray cascades; // depth, nearest

// Against acne, in texels of depth: what rounding takes. The receiver's own slope is accounted for texel by texel.
const float bias_texels = 0.1;
// Rise of depth over distance across the light at which a surface counts as edge-on.
const float steepest_slope = 16.0;
// Texels over which a shadow's edge fades.
const float edge_texels = 0.75;

// Where the mean of 3 x 3 bilinear comparisons (4 x 4 texels, weighted) is a half, there is the edge: nearer to the true
// one than any texel's, to a sixth of a texel where the edge runs aslant. The mean itself, a ramp of more than three
// texels, is cut down to `edge_texels`. `p`: uv and depth in the cascade. `slope`: of the receiving plane, depth a texel,
// so that each texel is compared with the plane's own depth there (Isidoro, Shadow Mapping: GPU-based Tips and
// Techniques, 2006).
float filtered_visibility(vec3 p, vec2 slope, float cascade) {
    float size = float(textureSize(cascades, 0).x);
    vec2 texel = p.xy * size - 0.5;
    vec2 base = floor(texel);
    vec2 f = texel - base;
    // A gather at a texel's corner takes the four texels around it: w z are its upper row, x y the lower one.
    vec2 low = base / size;
    vec2 high = (base + 2.0) / size;
    vec4 a = textureGather(cascades, vec3(low, cascade));
    vec4 b = textureGather(cascades, vec3(high.x, low.y, cascade));
    vec4 c = textureGather(cascades, vec3(low.x, high.y, cascade));
    vec4 d = textureGather(cascades, vec3(high, cascade));
    const vec4 places = vec4(-1.0, 0.0, 1.0, 2.0);
    vec4 plane_x = slope.x * (places - f.x);
    vec4 plane_y = slope.y * (places - f.y) + p.z;
    vec4 weight_x = vec4(1.0 - f.x, 1.0, 1.0, f.x);
    vec4 rows = vec4(dot(weight_x, step(plane_x + plane_y.x, vec4(a.wz, b.wz))),
                     dot(weight_x, step(plane_x + plane_y.y, vec4(a.xy, b.xy))),
                     dot(weight_x, step(plane_x + plane_y.z, vec4(c.wz, d.wz))),
                     dot(weight_x, step(plane_x + plane_y.w, vec4(c.xy, d.xy))));
    float lit = dot(rows, vec4(1.0 - f.y, 1.0, 1.0, f.y)) * (1.0 / 9.0);
    return clamp((lit - 0.5) * (3.0 / edge_texels) + 0.5, 0.0, 1.0);
}

// `normal`: geometric, unit, toward the eye's side.
float sun_visibility(vec3 position, vec3 normal, float depth_m) {
    int count = int(sun.direction_count.w);
    int cascade = 0;
    while (cascade < count && depth_m > sun.split_depth_m[cascade]) {
        ++cascade;
    }
    if (cascade == count) {
        return 1.0;
    }
    mat4 shadow_from_render = sun.shadow_from_render[cascade];
    vec3 p = (shadow_from_render * vec4(position, 1.0)).xyz;
    float texel_depth = sun.texel_m[cascade] / sun.depth_range_m[cascade];
    p.z = clamp(p.z - bias_texels * texel_depth, 0.0, 1.0);
    // The normal along the axes of the map, whose rows are as long as one over its side.
    float side_m = sun.texel_m[cascade] * float(textureSize(cascades, 0).x);
    vec2 across = side_m * (mat3(shadow_from_render) * normal).xy;
    vec2 slope = across / max(-dot(normal, sun.direction_count.xyz), 1e-3);
    slope *= min(1.0, steepest_slope / max(length(slope), 1e-6));
    return filtered_visibility(p, slope * texel_depth, float(cascade));
}

#endif
