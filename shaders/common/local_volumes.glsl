// Boxes and ellipsoids of fog in a slice of the ray, by their exact overlap with it: a point test would make their faces
// flicker from slice to slice.
#ifndef TYNDALL_SHADERS_COMMON_LOCAL_VOLUMES_GLSL
#define TYNDALL_SHADERS_COMMON_LOCAL_VOLUMES_GLSL

#include "local_volume.h"

#ifndef COLORED_EXTINCTION
#define COLORED_EXTINCTION false // a constant: each channel has an extinction of its own
#endif

// As VolumeShape and VolumeBlend of features/volumetrics/local_volume.hpp.
const float shape_ellipsoid = 1.0;
const float blend_subtract = 1.0;
const float blend_multiply = 2.0;
const float blend_max = 3.0;

// A render-space point in the space where the shape reaches from -1 to 1.
vec3 shape_space(GpuLocalVolume volume, vec3 p) {
    return vec3(dot(volume.row_x.xyz, p) + volume.row_x.w, dot(volume.row_y.xyz, p) + volume.row_y.w,
                dot(volume.row_z.xyz, p) + volume.row_z.w);
}

vec3 shape_direction(GpuLocalVolume volume, vec3 d) {
    return vec3(dot(volume.row_x.xyz, d), dot(volume.row_y.xyz, d), dot(volume.row_z.xyz, d));
}

// The s in [0, end] between which a + s d is inside; not in order where it passes by.
vec2 overlap_with_box(vec3 a, vec3 d, float end) {
    vec3 inverse = 1.0 / mix(d, vec3(1e-20), lessThan(abs(d), vec3(1e-20)));
    vec3 s0 = (-1.0 - a) * inverse;
    vec3 s1 = (1.0 - a) * inverse;
    vec3 enter = min(s0, s1);
    vec3 leave = max(s0, s1);
    return vec2(max(max(enter.x, enter.y), max(enter.z, 0.0)), min(min(leave.x, leave.y), min(leave.z, end)));
}

// By the point of the line that is nearest to the centre: b^2 - a c would cancel far away.
vec2 overlap_with_ellipsoid(vec3 a, vec3 d, float end) {
    float squared = max(dot(d, d), 1e-30);
    float nearest = -dot(a, d) / squared;
    vec3 offset = a + nearest * d;
    float inside = 1.0 - dot(offset, offset);
    if (inside <= 0.0) {
        return vec2(1.0, 0.0);
    }
    float reach = sqrt(inside / squared);
    return vec2(max(nearest - reach, 0.0), min(nearest + reach, end));
}

vec2 overlap_with_shape(GpuLocalVolume volume, vec3 a, vec3 d, float end) {
    return volume.edge_shape_blend.y == shape_ellipsoid ? overlap_with_ellipsoid(a, d, end) : overlap_with_box(a, d, end);
}

float edge_weight(GpuLocalVolume volume, vec3 q) {
    float inverse_edge = volume.edge_shape_blend.x;
    if (volume.edge_shape_blend.y == shape_ellipsoid) {
        return clamp((1.0 - length(q)) * inverse_edge, 0.0, 1.0);
    }
    vec3 weight = clamp((1.0 - abs(q)) * inverse_edge, 0.0, 1.0);
    return weight.x * weight.y * weight.z;
}

// The rest of blend_local_volume where each channel has an extinction of its own; `amount` is that of the largest.
void blend_colored(GpuLocalVolume volume, float amount, float weight, float part, inout vec4 medium,
                   inout vec3 extinction, inout vec3 emission) {
    float blend = volume.edge_shape_blend.z;
    vec3 own = amount * volume.color.rgb;
    vec3 keep = vec3(1.0);
    vec3 adds = vec3(1.0);
    if (blend == blend_subtract) {
        keep = max(1.0 - own / max(extinction, 1e-30), 0.0);
        adds = vec3(0.0);
    } else if (blend == blend_multiply) {
        keep = vec3(1.0 + weight * (volume.albedo_amount.w - 1.0));
        adds = vec3(0.0);
    } else if (blend == blend_max) {
        adds = vec3(greaterThan(own, extinction));
        keep = 1.0 - adds;
    }
    medium.rgb = mix(medium.rgb, medium.rgb * keep + adds * volume.albedo_amount.rgb * own, part);
    extinction = mix(extinction, extinction * keep + adds * own, part);
    emission = mix(emission, emission * keep + adds * volume.emission.rgb * weight, part);
}

// Blends the volume into `medium` (scattering rgb, extinction a) and `emission`, means over the slice from `near` to
// `far`. Inside the overlap the weight is its mean there, of soft edges by Gauss-Legendre with three nodes. Where the
// medium is coloured its extinction is `extinction`.
// Who defines DENSITY_GRIDS, a bool, has mean_grid_weight for volumes with a grid; for others
// its mean counts.
void blend_local_volume(GpuLocalVolume volume, vec3 near, vec3 far, inout vec4 medium, inout vec3 extinction,
                        inout vec3 emission) {
    vec3 a = shape_space(volume, near);
    vec3 d = shape_space(volume, far) - a;
    vec2 overlap = overlap_with_shape(volume, a, d, 1.0);
    float part = overlap.y - overlap.x;
    if (part <= 0.0) {
        return;
    }
    float weight = 1.0;
    if (volume.edge_shape_blend.x > 0.0) {
        float middle = 0.5 * (overlap.x + overlap.y);
        float node = 0.387298335 * part;
        weight = (5.0 * edge_weight(volume, a + (middle - node) * d) + 8.0 * edge_weight(volume, a + middle * d) +
                  5.0 * edge_weight(volume, a + (middle + node) * d)) / 18.0;
    }
#ifdef DENSITY_GRIDS
    if (DENSITY_GRIDS && volume.grid.w > 0.0) {
        weight = mean_grid_weight(volume, a + overlap.x * d, part * d);
    }
#else
    weight *= volume.emission.a;
#endif
    float amount = weight * volume.albedo_amount.w;
    if (COLORED_EXTINCTION) {
        blend_colored(volume, amount, weight, part, medium, extinction, emission);
        return;
    }
    vec4 own = vec4(volume.albedo_amount.rgb, 1.0) * amount;
    float blend = volume.edge_shape_blend.z;
    vec3 own_emission = volume.emission.rgb * weight;
    float keep = 1.0;
    if (blend == blend_subtract) {
        keep = max(1.0 - amount / max(medium.a, 1e-30), 0.0);
    } else if (blend == blend_multiply) {
        keep = 1.0 + weight * (volume.albedo_amount.w - 1.0);
    } else if (blend == blend_max) {
        keep = own.a > medium.a ? 0.0 : 1.0;
    }
    bool adds = blend != blend_subtract && blend != blend_multiply && (blend != blend_max || keep == 0.0);
    medium = mix(medium, medium * keep + (adds ? own : vec4(0.0)), part);
    emission = mix(emission, emission * keep + (adds ? own_emission : vec3(0.0)), part);
}

#endif
