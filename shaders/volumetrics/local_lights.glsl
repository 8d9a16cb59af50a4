// Point and spot lights in a slice of fog.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_LOCAL_LIGHTS_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_LOCAL_LIGHTS_GLSL

#include "common/lights.glsl"
#include "common/small_angles.glsl"
#include "volumetrics/phase.glsl"
#include "volumetrics/ray_segment.glsl"

// Where the light's direction makes the angle phi with the ray's normal, the cosine of scattering is -sin(phi).
float phase_of_sine(float s) { return phase_function(PhaseAngle(2.0 + 2.0 * s, 2.0 - 2.0 * s)); }

// Mean over the segment of phase function / d^2. With h the light's distance from the ray and t = h tan(phi) along it,
// dt / d^2 = dphi / h: exact for an isotropic phase function, where a sample of 1 / d^2 would be several times too
// bright beside the light and flicker as either moves. Elsewhere the phase function, p(-sin(phi)), is integrated over
// phi; where it hardly changes, the segment being seen from the light under a small angle, its value at the sample
// stands for it. `d` leads from the sample to the light, `to_light` is of unit length.
float scattered_inverse_square(RaySegment segment, vec3 d, vec3 to_light, float radius_m) {
    float along = -dot(d, segment.to_eye); // of the light's foot on the ray, from the sample
    vec3 offset = d + along * segment.to_eye;
    float h_squared = max(dot(offset, offset), radius_m * radius_m);
    float h = sqrt(h_squared);
    float a = -segment.behind_m - along;
    float b = segment.ahead_m - along;
    float length_m = max(b - a, 1e-6);
    float angle = positive_atan(h * length_m, h_squared + a * b);
    float change = angle * u.phase.x; // at most, of the phase function's logarithm
    float phase = 0.0;
    if (change < 0.7) {
        phase = phase_function(phase_angle(-to_light, segment.to_eye));
    } else {
        float panels = min(floor(0.5 * change) + 1.0, 16.0);
        float panel = angle / panels;
        float middle = 1.57079633 - positive_atan(h, a) + 0.5 * panel; // phi of the first panel's
        for (float i = 0.0; i < panels; i += 1.0) {
            // Gauss-Legendre, two nodes a panel.
            phase += phase_of_sine(sine(middle - 0.28867513 * panel)) +
                     phase_of_sine(sine(middle + 0.28867513 * panel));
            middle += panel;
        }
        phase *= 0.5 / panels;
    }
    return angle * phase / (h * length_m);
}

// What of the light's shadow map falls on the segment is multiplied to `fade`, at the sample.
#if LOCAL_SHADOW
#define FADE_IN_SHADOW(light_cone, segment, fade)                                                                      \
    if (casts_local_shadow(light_cone)) {                                                                              \
        fade *= local_visibility(local_shadows[local_shadow_index(light_cone)], local_shadow_maps, segment.position);  \
    }
#else
#define FADE_IN_SHADOW(light_cone, segment, fade)
#endif

// Adds the in-scattered radiance per scattering coefficient from light `index`. Window, cone, shadow and what the air
// takes are taken at the sample. Exactly 0 beyond the light's range. A macro, since a buffer cannot be passed to a
// function.
#define ADD_SCATTERED_FROM_LIGHT(lights, index, segment, sum)                                                          \
    {                                                                                                                  \
        vec4 position_range = lights[index].position_range;                                                            \
        vec3 d = position_range.xyz - segment.position;                                                                \
        float distance_squared = dot(d, d);                                                                            \
        float fade = light_window(position_range.w, distance_squared);                                                 \
        if (fade > 0.0) {                                                                                              \
            vec4 intensity_type = lights[index].intensity_type;                                                        \
            vec4 direction_radius = lights[index].direction_radius;                                                    \
            vec3 to_light = d * inversesqrt(max(distance_squared, 1e-20));                                             \
            float cone = spot_cone(direction_radius.xyz, lights[index].cone.xy, to_light);                             \
            fade *= intensity_type.w > 0.5 ? cone : 1.0;                                                               \
            if (air_weakens_light) {                                                                                   \
                vec3 passes = light_transmittance(segment.position, d);                                                \
                intensity_type.rgb *= COLORED_EXTINCTION ? passes : vec3(1.0);                                         \
                fade *= COLORED_EXTINCTION ? 1.0 : passes.r;                                                           \
            }                                                                                                          \
            FADE_IN_SHADOW(lights[index].cone, segment, fade)                                                          \
            float radius_m = max(direction_radius.w, smallest_light_radius_m);                                         \
            sum += intensity_type.rgb * (fade * scattered_inverse_square(segment, d, to_light, radius_m));             \
        }                                                                                                              \
    }

#endif
