// Opaque colour -> colour times transmittance plus in-scattered radiance, at each pixel's own depth. The blend unit does
// it: source factor ONE, destination factor SRC_ALPHA. A pixel without surface gets the fog
// of the whole ray, to infinity where the far plane lies there.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "common/scattering_volume.glsl"
#include "volumetrics/interop.h"

layout(set = 0, binding = 0) uniform Parameters { VolumetricParameters u; };
layout(set = 0, binding = 1) uniform sampler2D scene_depth;      // nearest
layout(set = 0, binding = 2) uniform sampler2DArray accumulated; // linear, clamps

layout(location = 0) out vec4 fog;

void main() {
    float d = texelFetch(scene_depth, ivec2(gl_FragCoord.xy), 0).r;
    float depth_m = (u.depth.x - d * u.depth.y) / max(u.depth.z + d * u.depth.w, 1e-30);
    vec2 uv = gl_FragCoord.xy / vec2(textureSize(scene_depth, 0));
    vec3 radiance;
    vec3 transmittance;
    scattering_lookup(u.volume, accumulated, uv, depth_m, radiance, transmittance);
    fog = vec4(radiance, transmittance.r);
}
