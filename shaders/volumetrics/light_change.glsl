// How much the light of a froxel has changed since the frame before, in parts of itself: what its history is worth.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_LIGHT_CHANGE_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_LIGHT_CHANGE_GLSL

#include "common/lights.glsl"

// Froxels at the edge of a shadow change by as much per radian that its light moves: a caster stands some two hundred
// times the size of a froxel away.
const float shadow_edge_per_rad = 200.0;

// A light's irradiance without its intensity, 1/m^2, within reach_m of a point from which d leads to the light: no less
// than anywhere there, and where only the cone's edge makes it less.
struct FalloffBounds {
    float largest;
    float at_edge; // with the smallest value of the cone
};

float cone_of_cosine(GpuLight light, float cosine) {
    float a = clamp(cosine * light.cone.x + light.cone.y, 0.0, 1.0);
    return mix(1.0, a * a, light.intensity_type.w > 0.5);
}

FalloffBounds falloff_bounds(GpuLight light, vec3 d, float reach_m) {
    float centre_m = length(d);
    float nearest_m = max(centre_m - reach_m, 0.0);
    float cosine = -dot(d, light.direction_radius.xyz) / max(centre_m, 1e-10);
    float spread = reach_m / max(centre_m, 1e-10);
    float radius_m = max(light.direction_radius.w, smallest_light_radius_m);
    float falloff = light_window(light.position_range.w, nearest_m * nearest_m) /
                    max(nearest_m * nearest_m, radius_m * radius_m);
    return FalloffBounds(falloff * cone_of_cosine(light, cosine + spread),
                         falloff * cone_of_cosine(light, cosine - spread));
}

// In [0, 1], of the light that froxels within reach_m of the point scatter. `steepness` bounds the change of the phase
// function's logarithm, 1/rad.
float light_change(GpuLight before, GpuLight now, vec3 position, float reach_m, float steepness) {
    vec3 d_before = before.position_range.xyz - position;
    vec3 d_now = now.position_range.xyz - position;
    FalloffBounds was = falloff_bounds(before, d_before, reach_m);
    FalloffBounds is = falloff_bounds(now, d_now, reach_m);
    bool stands = before.position_range == now.position_range && before.direction_radius == now.direction_radius &&
                  before.cone.xy == now.cone.xy;
    vec3 brighter = max(before.intensity_type.rgb * was.largest, now.intensity_type.rgb * is.largest);
    vec3 came = now.intensity_type.rgb * is.largest - before.intensity_type.rgb * mix(was.at_edge, was.largest, stands);
    vec3 went = before.intensity_type.rgb * was.largest - now.intensity_type.rgb * mix(is.at_edge, is.largest, stands);
    vec3 change = max(came, went) / max(brighter, 1e-30);
    // The angle under which the light's way is seen; beside the light, its falloff over that way.
    float nearest_m = max(min(length(d_before), length(d_now)) - reach_m, smallest_light_radius_m);
    float shadow = now.cone.z > 0.5 ? shadow_edge_per_rad : 0.0;
    float moved = distance(before.position_range.xyz, now.position_range.xyz) * (2.0 + steepness + shadow) / nearest_m;
    float any = max(brighter.r, max(brighter.g, brighter.b));
    return mix(0.0, min(max(change.r, max(change.g, change.b)) + moved, 1.0), any > 0.0);
}

// The age that history may have at most, frames, when the light has changed by a part `change`: it then leaves at most
// 1 part in 160 of the change after 8 frames, a / (a + 8) of it, and follows a steady one within 1 part in 20.
float oldest_age(float change) { return 0.05 / max(change, 1e-6); }

#endif
