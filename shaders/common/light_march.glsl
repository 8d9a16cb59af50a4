// What a whole medium takes from light on its way: the closed forms of light_attenuation.glsl, and what local volumes
// and noise change of them, by a march along the way.
//
// The includer defines MEDIUM, a block that has the members of LightMedium (light_medium.h), and the constants
//   air_weakens_light   anything does
//   light_volumes       the march sees local volumes
//   light_octaves       and so many octaves of noise
// march: x: number of volumes; y: steps; z: length of a step over that of the one before it on the way to the sun;
// w: noise cells per step, at most, on that way.
#ifndef TYNDALL_SHADERS_COMMON_LIGHT_MARCH_GLSL
#define TYNDALL_SHADERS_COMMON_LIGHT_MARCH_GLSL

#include "light_attenuation.glsl"
#include "local_volumes.glsl"
#include "noise.glsl"

// The part of the way within which some volume lies; not in order where none does.
vec2 span_of_volumes(vec3 point, vec3 direction, float way_m) {
    vec2 span = vec2(way_m, 0.0);
    for (uint i = 0u; i < uint(MEDIUM.march.x); ++i) {
        vec3 a = shape_space(MEDIUM.volumes[i], point);
        vec3 d = shape_direction(MEDIUM.volumes[i], direction);
        vec2 overlap = overlap_with_shape(MEDIUM.volumes[i], a, d, way_m);
        bool meets = overlap.x < overlap.y;
        span = vec2(mix(span.x, min(span.x, overlap.x), meets), mix(span.y, max(span.y, overlap.y), meets));
    }
    return span;
}

// Optical depth of each channel that volumes and noise add to fog of the extinctions `base` (x: homogeneous, y: height
// fog's at its base, 1/m) between `span.x` and `span.y` metres of the way; negative where they take from it. Each of the steps, the next
// `growth` times as long as the one before, sees the volumes by their exact overlap with it and the noise at its middle.
vec3 marched_change(vec2 base, vec3 point, vec3 direction, vec2 span, float growth) {
    float steps = MEDIUM.march.y;
    float whole = growth > 1.0 ? (pow(growth, steps) - 1.0) / (growth - 1.0) : steps;
    float t = span.x;
    float dt = (span.y - span.x) / whole;
    vec3 sum = vec3(0.0);
    for (float i = 0.0; i < steps; i += 1.0) {
        vec3 near = point + t * direction;
        vec3 far = point + (t + dt) * direction;
        vec2 air = base * mean_air_density(MEDIUM.air, MEDIUM.air_heights.xy, near.y, far.y);
        float before = (air.x + air.y) * MEDIUM.density_scale.x;
        vec4 medium = vec4(0.0, 0.0, 0.0, before);
        vec3 extinction = vec3(0.0);
        vec3 colored_before = vec3(0.0);
        if (COLORED_EXTINCTION) {
            colored_before = (air.x * MEDIUM.homogeneous_color.rgb + air.y * MEDIUM.height_color.rgb) *
                             MEDIUM.density_scale.x;
            extinction = colored_before;
        }
        if (light_volumes) {
            vec3 emission = vec3(0.0);
            for (uint v = 0u; v < uint(MEDIUM.march.x); ++v) {
                blend_local_volume(MEDIUM.volumes[v], near, far, medium, extinction, emission);
            }
        }
        if (light_octaves > 0u) {
            vec3 p = (0.5 * (near + far)) * MEDIUM.noise_cells.x + MEDIUM.noise_origin.xyz;
            float factor = octave_noise(p, 0.5 * dt * MEDIUM.noise_cells.x, MEDIUM.noise_origin.w, MEDIUM.noise_cells.y,
                                        light_octaves);
            medium.a *= factor;
            extinction *= factor;
        }
        sum += COLORED_EXTINCTION ? (extinction - colored_before) * dt : vec3((medium.a - before) * dt);
        t += dt;
        dt *= growth;
    }
    return sum * MEDIUM.density_scale.y;
}

// Transmittance of the straight way from a point to a light, `way` metres off.
vec3 light_transmittance(vec3 point, vec3 way) {
    vec2 heights = MEDIUM.air_heights.xy;
    vec3 tau = vec3(air_optical_depth(MEDIUM.air, heights, point, way));
    if (COLORED_EXTINCTION) {
        vec4 even = vec4(MEDIUM.air.x, 0.0, MEDIUM.air.zw);
        tau = air_optical_depth(even, heights, point, way) * MEDIUM.homogeneous_color.rgb +
              air_optical_depth(vec4(0.0, MEDIUM.air.yzw), heights, point, way) * MEDIUM.height_color.rgb;
    }
    if (!light_volumes && light_octaves == 0u) {
        return exp(-tau);
    }
    float way_m = length(way);
    vec3 direction = way / max(way_m, 1e-20);
    vec2 span = light_octaves > 0u ? vec2(0.0, way_m) : span_of_volumes(point, direction, way_m);
    if (span.x < span.y) {
        tau += marched_change(MEDIUM.air.xy, point, direction, span, 1.0);
    }
    return exp(-max(tau, 0.0));
}

// From outside the medium, against the unit direction `travel`. Fog without end in that direction counts nothing: volumes
// and noise change none of it, either. Noise is followed through 6 scale heights of the height fog, and as far as the
// steps can see it; beyond, its mean remains.
vec3 sun_transmittance(vec3 point, vec3 travel) {
    vec3 tau = vec3(air_optical_depth_to_sun(MEDIUM.air, MEDIUM.air_heights.xy, point, travel));
    if (COLORED_EXTINCTION) {
        tau *= MEDIUM.height_color.rgb;
    }
    if (!light_volumes && light_octaves == 0u) {
        return exp(-tau);
    }
    vec3 direction = -travel;
    bool thins_out = direction.y > 0.0 && MEDIUM.air.z > 0.0;
    vec2 base = vec2(0.0, mix(0.0, MEDIUM.air.y, thins_out));
    vec2 span = vec2(1e30, 0.0);
    if (light_volumes) {
        span = span_of_volumes(point, direction, 1e30);
    }
    if (light_octaves > 0u) {
        float height_m = MEDIUM.air.w + point.y;
        float rise_m = max(-height_m, 0.0) + 6.0 / max(MEDIUM.air.z, 1e-30);
        float seen_m = MEDIUM.march.w * MEDIUM.march.y / MEDIUM.noise_cells.x;
        span = vec2(0.0, max(span.y, mix(0.0, min(rise_m / max(direction.y, 1e-30), seen_m), base.y > 0.0)));
    }
    if (span.x < span.y) {
        tau += marched_change(base, point, direction, span, light_octaves > 0u ? MEDIUM.march.z : 1.0);
    }
    return exp(-max(tau, 0.0));
}

#endif
