// What air takes from light on its way to a particle or a surface: homogeneous and height fog, in closed form.
#ifndef TYNDALL_SHADERS_COMMON_LIGHT_ATTENUATION_GLSL
#define TYNDALL_SHADERS_COMMON_LIGHT_ATTENUATION_GLSL

#include "height_density.glsl"

// `air`: x: extinction of homogeneous fog, 1/m; y: of height fog at and below its base, 1/m; z: its falloff, 1/m;
// w: height of render space's origin above its base, m.

// Of the straight way from a point to another, `way` metres off.
float air_optical_depth(vec4 air, vec3 point, vec3 way) {
    float height_m = air.w + point.y;
    return length(way) * (air.x + air.y * mean_height_density(height_m, height_m + way.y, air.z));
}

// From outside the air, against the unit direction `travel`. Fog without end in that direction takes nothing: the
// illuminance of a sun is what arrives through it.
float air_optical_depth_to_sun(vec4 air, vec3 point, vec3 travel) {
    float height_m = air.w + point.y;
    float climb = -travel.y;
    float above_m = exp(-air.z * max(height_m, 0.0)) / max(air.z, 1e-30);
    float column_m = min((above_m + max(-height_m, 0.0)) / max(climb, 1e-30), 1e30);
    return mix(0.0, air.y * column_m, climb > 0.0 && air.z > 0.0);
}

#endif
