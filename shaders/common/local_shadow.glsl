// What a point or spot light's shadow map says about a point. To be used:
//
//   layout(...) uniform sampler2DArray local_shadow_maps; // depth, nearest, clamps
//   layout(..., std430) readonly restrict buffer LocalShadows { LocalShadow local_shadows[]; };
//   if (casts_local_shadow(light.cone)) {
//       light_reaching *= local_visibility(local_shadows[local_shadow_index(light.cone)], local_shadow_maps, position);
//   }
#ifndef TYNDALL_SHADERS_COMMON_LOCAL_SHADOW_GLSL
#define TYNDALL_SHADERS_COMMON_LOCAL_SHADOW_GLSL

#include "common/local_shadow.h"

// `cone`: that of the GpuLight.
bool casts_local_shadow(vec4 cone) { return cone.z > 0.5; }
uint local_shadow_index(vec4 cone) { return uint(max(cone.z - 0.5, 0.0)); }

vec3 local_shadow_space(LocalShadow shadow, vec3 position) {
    vec4 p = vec4(position, 1.0);
    return vec3(dot(shadow.row_x, p), dot(shadow.row_y, p), dot(shadow.row_z, p));
}

// 0 to 5: the side of the cube that `p` of the light's space lies in; 0 where there is one layer.
float local_shadow_side(LocalShadow shadow, vec3 p) {
    vec3 a = abs(p);
    bool x = a.x >= a.y && a.x >= a.z;
    bool y = a.y >= a.z;
    vec2 axis = x ? vec2(0.0, p.x) : y ? vec2(2.0, p.y) : vec2(4.0, p.z);
    return shadow.lens.w * (axis.x + (axis.y < 0.0 ? 1.0 : 0.0));
}

// From the light's space to that of a side: z along its view.
vec3 local_shadow_view(LocalShadow shadow, float side, vec3 p) {
    vec3 turned = side < 2.0 ? p.yzx : side < 4.0 ? p.zxy : p;
    turned.z = mod(side, 2.0) > 0.5 ? -turned.z : turned.z;
    return shadow.lens.w > 0.5 ? turned : p;
}

// Texel coordinates in xy, near / z, which is 1 within the near distance, in z. `v`: of local_shadow_view.
vec3 local_shadow_place(LocalShadow shadow, vec3 v) {
    float z = max(v.z, shadow.lens.y);
    return vec3((v.xy * (shadow.lens.x / z) + 0.5) * shadow.texel.y, shadow.lens.y / z);
}

// 1 where no caster stands before the point, else 0. For the air: nothing there shadows itself, so there is no bias.
float local_visibility(LocalShadow shadow, sampler2DArray maps, vec3 position) {
    vec3 p = local_shadow_space(shadow, position);
    float side = local_shadow_side(shadow, p);
    vec3 place = local_shadow_place(shadow, local_shadow_view(shadow, side, p));
    vec2 texel = clamp(place.xy, vec2(0.0), vec2(shadow.texel.y - 1.0));
    float caster = texelFetch(maps, ivec3(texel, shadow.lens.z + side), 0).r;
    return caster <= place.z ? 1.0 : 0.0;
}

// The part, 0 to 1, that a point of a surface sees: four texels, weighted bilinearly. `normal`: geometric, unit, on the
// light's side. Each texel's caster is compared with the surface's own plane at that texel, not with the point, so that
// a slope shadows nothing of itself and the bias need not grow with it: half a texel along the normal, for normals of
// curved surfaces and the map's rounding. Where walls meet, a texel beyond the corner shows the other wall, before this
// one's plane: what lies less than half a texel before the point itself casts no shadow on it.
float local_surface_visibility(LocalShadow shadow, sampler2DArray maps, vec3 position, vec3 normal) {
    vec3 p = local_shadow_space(shadow, position);
    float side = local_shadow_side(shadow, p);
    vec3 v = local_shadow_view(shadow, side, p);
    vec3 n = local_shadow_view(
        shadow, side, vec3(dot(shadow.row_x.xyz, normal), dot(shadow.row_y.xyz, normal), dot(shadow.row_z.xyz, normal)));
    v += n * (0.5 * shadow.texel.x * max(v.z, 0.0));
    vec3 place = local_shadow_place(shadow, v);
    vec2 corner = place.xy - 0.5;
    vec2 low = floor(corner);
    vec2 f = corner - low;
    // The plane n . x = n . v meets the line through (x, y, 1) at 1 / z = n . (x, y, 1) / n . v: affine over the map.
    float per_plane = shadow.lens.y / min(dot(n, v), -1e-6);
    vec2 slope = n.xy * (per_plane * shadow.texel.z / shadow.lens.x);
    float middle = per_plane * (dot(n.xy, (low + 0.5) * shadow.texel.z - 0.5) / shadow.lens.x + n.z);
    vec4 plane = middle + vec4(0.0, slope.x, slope.x, 0.0) + vec4(slope.y, slope.y, 0.0, 0.0);
    // As textureGather: (0, 1), (1, 1), (1, 0), (0, 0). Where the plane is seen edge on it stays near the point.
    plane = clamp(plane, place.z, 1.1 * place.z) * (1.0 + 0.5 * shadow.texel.x);
    vec4 casters = textureGather(maps, vec3((low + 1.0) * shadow.texel.z, shadow.lens.z + side), 0);
    vec4 lit = vec4(lessThanEqual(casters, plane));
    vec2 rows = mix(lit.wx, lit.zy, f.x);
    return v.z <= shadow.lens.y ? 1.0 : mix(rows.x, rows.y, f.y);
}

#endif
