// Punctual lights.
#ifndef TYNDALL_SHADERS_COMMON_LIGHTS_GLSL
#define TYNDALL_SHADERS_COMMON_LIGHTS_GLSL

#include "lights.h"

// No light is smaller than this, so that nothing is divided by zero beside it (m).
const float smallest_light_radius_m = 0.005;

// The fade to exactly 0 at the range, as KHR_lights_punctual recommends: 1 - (d / range)^4.
float light_window(float range_m, float distance_squared) {
    float x = distance_squared / (range_m * range_m);
    return clamp(1.0 - x * x, 0.0, 1.0);
}

// KHR_lights_punctual's spot attenuation by angle scale and offset; exactly 0 outside the outer cone.
float spot_cone(vec3 direction, vec2 scale_offset, vec3 to_light) {
    float a = clamp(dot(-to_light, direction) * scale_offset.x + scale_offset.y, 0.0, 1.0);
    return a * a;
}

// Irradiance (lux, rgb) at `position` on a surface that faces the light: candela / d^2, windowed, within the cone.
// Exactly 0 beyond the range. Inside the source the distance is held at its radius. `to_light` is of unit length.
vec3 light_irradiance_normal(GpuLight light, vec3 position, out vec3 to_light) {
    vec3 d = light.position_range.xyz - position;
    float distance_squared = dot(d, d);
    to_light = d * inversesqrt(max(distance_squared, 1e-20));
    float radius = max(light.direction_radius.w, smallest_light_radius_m);
    float fade = light_window(light.position_range.w, distance_squared);
    if (light.intensity_type.w > 0.5) {
        fade *= spot_cone(light.direction_radius.xyz, light.cone.xy, to_light);
    }
    return light.intensity_type.rgb * (fade / max(distance_squared, radius * radius));
}

#endif
