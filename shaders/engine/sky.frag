// The background: a gradient over the elevation of the ray.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "engine/renderer_interop.h"

layout(set = 0, binding = 0) uniform Frame { FrameParameters frame; };
layout(location = 0) out vec4 color;

void main() {
    vec2 uv = gl_FragCoord.xy * frame.size.zw;
    vec3 direction = normalize(frame.ray_origin.xyz + uv.x * frame.ray_u.xyz + uv.y * frame.ray_v.xyz);
    // Most of the change is near the horizon, above it as in a clear sky, below it as in haze.
    float up = 1.0 - pow(1.0 - clamp(direction.y, 0.0, 1.0), 3.0);
    float down = clamp(-8.0 * direction.y, 0.0, 1.0);
    vec3 sky = mix(frame.sky_horizon.rgb, frame.sky_zenith.rgb, up);
    color = vec4(mix(sky, frame.sky_ground.rgb, down), 1.0);
}
