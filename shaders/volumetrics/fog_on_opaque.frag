// Opaque colour -> colour times transmittance plus in-scattered radiance, at each pixel's own depth. The blend unit does
// it: source factor ONE, destination factor SRC_ALPHA, or, with COLORED 1, that of a second source: each channel has a
// transmittance of its own. A pixel without surface gets the fog of the whole ray to infinity, wherever the far plane lies.
// Lights that the froxels leave out are integrated here.
//
// LOCAL_SHADOW 1: one of them casts shadows.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

layout(constant_id = 0) const uint airlight_features = 0u;

#if LOCAL_SHADOW
#include "common/local_shadow.glsl"
layout(set = 0, binding = 3) uniform sampler2DArray local_shadow_maps; // nearest, clamps
layout(set = 0, binding = 4, std430) readonly restrict buffer LocalShadows { LocalShadow local_shadows[]; };
#endif
#if COLORED
#define COLORED_EXTINCTION true
#endif
#include "common/airlight.glsl"
#include "common/scattering_volume.glsl"
#include "volumetrics/interop.h"

layout(set = 0, binding = 0) uniform Parameters { VolumetricParameters u; };
layout(set = 0, binding = 1) uniform sampler2D scene_depth;      // nearest
layout(set = 0, binding = 2) uniform sampler2DArray accumulated; // linear, clamps

#if COLORED
layout(location = 0, index = 0) out vec4 fog;
layout(location = 0, index = 1) out vec4 passes;
#else
layout(location = 0) out vec4 fog;
#endif

void main() {
    float d = texelFetch(scene_depth, ivec2(gl_FragCoord.xy), 0).r;
    float depth_m = (u.depth.x - d * u.depth.y) / max(u.depth.z + d * u.depth.w, 1e-30);
    depth_m = mix(depth_m, 1e29, d == u.sky.x);
    vec2 uv = gl_FragCoord.xy / vec2(textureSize(scene_depth, 0));
    vec3 radiance;
    vec3 transmittance;
    scattering_lookup(u.volume, accumulated, uv, depth_m, radiance, transmittance);
    vec3 ray = u.ray_u.xyz * uv.x + u.ray_v.xyz * uv.y + u.ray_0.xyz;
    vec3 start = u.eye_u.xyz * uv.x + u.eye_v.xyz * uv.y + u.eye_0.xyz;
    PixelPath path =
        pixel_path(u.volume, uv, depth_m, start, normalize(ray), interleaved_noise(gl_FragCoord.xy));
    ADD_AIRLIGHT(u.volume, u.airlights, path, radiance)
    fog = vec4(radiance, transmittance.r);
#if COLORED
    passes = vec4(transmittance, 1.0);
#endif
}
