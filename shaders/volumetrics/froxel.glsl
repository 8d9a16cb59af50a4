// Froxels as points and rays of view space.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_FROXEL_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_FROXEL_GLSL

#include "common/scattering_volume.glsl"

// View depth of boundary k of N slices, k in [0, N].
float boundary_depth(ScatteringVolume volume, float k) { return depth_from_t(volume.law, k / volume.grid.z); }

// Length of view depth of slice k, which begins at near_m: without a curve slices grow in proportion to s + z.
float slice_depth(ScatteringVolume volume, float k, float near_m) {
    return DEPTH_CURVE ? boundary_depth(volume, k + 1.0) - near_m
                       : volume.slice.x * (1.0 + near_m / volume.law.range_shape.y);
}

// View depth at the middle t of slice k, which begins at near_m.
float slice_middle(ScatteringVolume volume, float k, float near_m) {
    return DEPTH_CURVE ? boundary_depth(volume, k + 0.5)
                       : near_m + volume.slice.y * (1.0 + near_m / volume.law.range_shape.y);
}

vec3 view_position(ScatteringVolume volume, vec2 uv, float depth_m) {
    return vec3(column_xy(volume, uv, depth_m), -depth_m);
}

#endif
