// Coverage of a particle's billboard: a soft disc broken up by noise, fading where it comes close to a surface.
//
// TWO_SOURCES 1: what passes from behind differs between the channels, as it does where particles are filters. One
// formula serves every way of blending, so that all particles are drawn in one order by one pipeline.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "engine/particle_interop.h"

layout(set = 0, binding = 0, std430) readonly restrict buffer Frame { ParticleFrame frame; };
layout(set = 0, binding = 3) uniform sampler2D scene_depth;

layout(location = 0) in vec2 place;
layout(location = 1) flat in vec2 noise_offset;
layout(location = 2) flat in float noise_share;
layout(location = 3) flat in vec2 depth_and_scale;
layout(location = 4) flat in float alpha;
layout(location = 5) in vec3 radiance;
layout(location = 6) flat in vec4 taken;

#if TWO_SOURCES
layout(location = 0, index = 0) out vec4 color;
layout(location = 0, index = 1) out vec4 passes; // share of the light from behind
#else
layout(location = 0) out vec4 color; // of the light from behind passes 1 - its alpha
#endif

// Hashes of the four corners of a cell, each in [0, 1).
vec4 cell_corners(ivec2 cell) {
    uvec4 x = uvec4(cell.x, cell.x + 1, cell.x, cell.x + 1) * 0x9e3779b1u;
    uvec4 y = uvec4(cell.y, cell.y, cell.y + 1, cell.y + 1) * 0x85ebca77u;
    uvec4 h = (x ^ y) * 0x27d4eb2fu;
    return vec4((h ^ (h >> 15u)) & 0xffffu) * (1.0 / 65536.0);
}

// Value noise in [0, 1), smooth, one feature a cell.
float value_noise(vec2 p) {
    vec2 cell = floor(p);
    vec2 f = p - cell;
    vec2 w = f * f * (3.0 - 2.0 * f);
    vec4 corners = cell_corners(ivec2(cell));
    vec2 rows = mix(corners.xz, corners.yw, w.x);
    return mix(rows.x, rows.y, w.y);
}

void main() {
    float r2 = dot(place, place);
    float scene = texelFetch(scene_depth, ivec2(gl_FragCoord.xy), 0).r;
    float scene_m = (frame.depth.x - scene * frame.depth.y) / max(frame.depth.z + scene * frame.depth.w, 1e-30);
    float clearance = clamp((scene_m - depth_and_scale.x) * depth_and_scale.y, 0.0, 1.0);
    float body = max(1.0 - r2, 0.0);
    float coverage = body * body * clearance;
    if (coverage <= 0.0) {
        discard;
    }
    if (noise_share > 0.0) {
        float noise = 0.65 * value_noise(2.3 * place + noise_offset) + 0.35 * value_noise(5.1 * place - noise_offset);
        // Noise eats the rim first, so that the outline frays and the middle keeps its mass.
        coverage *= mix(1.0, smoothstep(0.25, 0.75, noise + 0.35 * body), noise_share);
    }
    float a = alpha * coverage;
    color = vec4(radiance, taken.w) * a;
#if TWO_SOURCES
    passes = 1.0 - a * taken;
#endif
}
