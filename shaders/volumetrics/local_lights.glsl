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

// Mean of 1 / d^2 over the segment, exact (the integral is a difference of arc tangents): sampled at a point it would be
// several times too bright beside the light and flicker as either moves. `d` leads from the sample to the light.
float mean_inverse_square(RaySegment segment, vec3 d, float radius_m) {
    float along = -dot(d, segment.to_eye); // of the light's foot on the ray, from the sample
    vec3 offset = d + along * segment.to_eye;
    float h_squared = max(dot(offset, offset), radius_m * radius_m);
    float h = sqrt(h_squared);
    float a = -segment.behind_m - along;
    float b = segment.ahead_m - along;
    float length_m = max(b - a, 1e-6);
    return atan(h * length_m, h_squared + a * b) / (h * length_m);
}

// In-scattered radiance per scattering coefficient from light `index`. Window, cone and phase are taken at the sample.
// Exactly 0 beyond the light's range. A macro, since a buffer cannot be passed to a function: members are fetched when
// they are needed, and most lights end at their range, most others are no spots.
#define ADD_SCATTERED_FROM_LIGHT(lights, index, segment, g, sum)                                                       \
    {                                                                                                                  \
        vec4 position_range = lights[index].position_range;                                                            \
        vec3 d = position_range.xyz - segment.position;                                                                \
        float distance_squared = dot(d, d);                                                                            \
        float fade = light_window(position_range.w, distance_squared);                                                 \
        if (fade > 0.0) {                                                                                              \
            vec4 intensity_type = lights[index].intensity_type;                                                        \
            vec3 to_light = d * inversesqrt(max(distance_squared, 1e-20));                                             \
            if (intensity_type.w > 0.5) {                                                                              \
                fade *= spot_cone(lights[index].direction_radius.xyz, lights[index].cone.xy, to_light);                \
            }                                                                                                          \
            float radius_m = max(lights[index].direction_radius.w, smallest_light_radius_m);                           \
            float phase = henyey_greenstein(g, -to_light, segment.to_eye);                                             \
            sum += intensity_type.rgb * (fade * phase * mean_inverse_square(segment, d, radius_m));                    \
        }                                                                                                              \
    }

#endif
