// What air takes from light on its way to a particle or a surface: homogeneous and height fog, in closed form.
#ifndef TYNDALL_SHADERS_COMMON_LIGHT_ATTENUATION_GLSL
#define TYNDALL_SHADERS_COMMON_LIGHT_ATTENUATION_GLSL

#include "height_density.glsl"

// `air`: x: extinction of homogeneous fog, 1/m; y: of height fog at and below its base, 1/m; z: its falloff, 1/m;
// w: height of render space's origin above its base, m. `heights`: y in render space between which there is air, m.

// Parts of the two extinctions in the mean over a straight way between two heights of render space.
vec2 mean_air_density(vec4 air, vec2 heights, float from, float to) {
    float a = clamp(from, heights.x, heights.y);
    float b = clamp(to, heights.x, heights.y);
    float part = mix((b - a) / (to - from), float(a == from), from == to);
    return vec2(part, part * mean_height_density(air.w + a, air.w + b, air.z));
}

// Of the straight way from a point to another, `way` metres off.
float air_optical_depth(vec4 air, vec2 heights, vec3 point, vec3 way) {
    return length(way) * dot(air.xy, mean_air_density(air, heights, point.y, point.y + way.y));
}

// From outside the air, against the unit direction `travel`. Fog without end in that direction takes nothing: the
// illuminance of a sun is what arrives through it.
float air_optical_depth_to_sun(vec4 air, vec2 heights, vec3 point, vec3 travel) {
    float low_m = air.w + clamp(point.y, heights.x, heights.y);
    float high_m = air.w + heights.y;
    float climb = -travel.y;
    float below_m = min(high_m, 0.0) - min(low_m, 0.0);
    float rise_m = max(high_m, 0.0) - max(low_m, 0.0);
    float above_m = exp(-air.z * max(low_m, 0.0)) * phi1(air.z * rise_m) * rise_m;
    float column_m = min((below_m + above_m) / max(climb, 1e-30), 1e30);
    return mix(0.0, air.y * column_m, climb > 0.0 && air.z > 0.0);
}

#endif
