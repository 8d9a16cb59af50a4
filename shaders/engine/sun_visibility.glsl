// How much of the sun a surface sees through the shadow cascades. Included after `sun` and `cascades` are declared by
// sun_bindings below; set 0.
#ifndef TYNDALL_SHADERS_ENGINE_SUN_VISIBILITY_GLSL
#define TYNDALL_SHADERS_ENGINE_SUN_VISIBILITY_GLSL

#include "common/sun_shadow.h"

layout(set = 0, binding = 2) uniform Sun { SunCascades sun; };
layout(set = 0, binding = 3) uniform sampler2DArrayShadow cascades;

// Mean of 3 x 3 bilinear comparisons: 4 x 4 texels, weighted. `p`: uv and depth in the cascade.
float filtered_visibility(vec3 p, float cascade) {
    float size = float(textureSize(cascades, 0).x);
    vec2 texel = p.xy * size - 0.5;
    vec2 base = floor(texel);
    vec2 f = texel - base;
    // A gather at a texel's corner takes the four texels around it.
    vec2 low = base / size;
    vec2 high = (base + 2.0) / size;
    vec4 a = textureGather(cascades, vec3(low, cascade), p.z);
    vec4 b = textureGather(cascades, vec3(high.x, low.y, cascade), p.z);
    vec4 c = textureGather(cascades, vec3(low.x, high.y, cascade), p.z);
    vec4 d = textureGather(cascades, vec3(high, cascade), p.z);
    // Of a gather: w z are its upper row, x y the lower one.
    vec4 weight_x = vec4(1.0 - f.x, 1.0, 1.0, f.x);
    vec4 rows = vec4(dot(weight_x, vec4(a.wz, b.wz)), dot(weight_x, vec4(a.xy, b.xy)),
                     dot(weight_x, vec4(c.wz, d.wz)), dot(weight_x, vec4(c.xy, d.xy)));
    return dot(rows, vec4(1.0 - f.y, 1.0, 1.0, f.y)) * (1.0 / 9.0);
}

// `normal`: geometric, unit, toward the eye's side. The receiver is moved out along it by as much as the filter's footprint
// rises above a texel on a slope, and a little toward the light (Holbert, Normal Offset Shadows, 2011).
float sun_visibility(vec3 position, vec3 normal, float depth_m) {
    int count = int(sun.direction_count.w);
    int cascade = 0;
    while (cascade < count && depth_m > sun.split_depth_m[cascade]) {
        ++cascade;
    }
    if (cascade == count) {
        return 1.0;
    }
    float cosine = clamp(-dot(normal, sun.direction_count.xyz), 0.0, 1.0);
    float sine = sqrt(1.0 - cosine * cosine);
    float texel_m = sun.texel_m[cascade];
    vec3 moved = position + normal * (texel_m * (0.5 + 2.0 * sine));
    vec3 p = (sun.shadow_from_render[cascade] * vec4(moved, 1.0)).xyz;
    p.z = clamp(p.z - 0.5 * texel_m / sun.depth_range_m[cascade], 0.0, 1.0);
    return filtered_visibility(p, float(cascade));
}

#endif
