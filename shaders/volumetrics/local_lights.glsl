// Point and spot lights in a slice of fog.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_LOCAL_LIGHTS_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_LOCAL_LIGHTS_GLSL

#include "common/lights.glsl"

// The part of a ray that one froxel sees: a sample on it, and how far the slice reaches on both sides of the sample.
struct RaySegment {
    vec3 position; // render space
    vec3 to_eye;   // unit
    float behind_m; // from the sample toward the eye, >= 0
    float ahead_m;  // and away from it
};

// In-scattered radiance per scattering coefficient from one light. 1 / d^2 is averaged over the segment exactly (the
// integral is a difference of arc tangents): sampled at a point it would be several times too bright beside the light and
// flicker as either moves. Window, cone and phase are taken at the sample. Exactly 0 beyond the light's range.
vec3 scattered_from_light(GpuLight light, RaySegment segment, float g) {
    vec3 d = light.position_range.xyz - segment.position;
    float distance_squared = dot(d, d);
    float window = light_window(light, distance_squared);
    if (window <= 0.0) {
        return vec3(0.0);
    }
    vec3 to_light = d * inversesqrt(max(distance_squared, 1e-20));
    float along = -dot(d, segment.to_eye); // of the light's foot on the ray, from the sample
    vec3 offset = d + along * segment.to_eye;
    float radius = max(light.direction_radius.w, smallest_light_radius_m);
    float h_squared = max(dot(offset, offset), radius * radius);
    float h = sqrt(h_squared);
    float a = -segment.behind_m - along;
    float b = segment.ahead_m - along;
    float length_m = max(b - a, 1e-6);
    float mean_inverse_square = atan(h * length_m, h_squared + a * b) / (h * length_m);
    float phase = henyey_greenstein(g, -to_light, segment.to_eye);
    return light.intensity_type.rgb * (window * light_cone(light, to_light) * phase * mean_inverse_square);
}

#endif
