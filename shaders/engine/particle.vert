// A particle as a billboard parallel to the image, lit and fogged at its own depth. Vertices are pulled: number v belongs
// to the particle in sorted place v / 6.
//
// SCATTERING 1: light and fog from a scattering volume, and light of the lights that it leaves out. 0: no fog, light from
// the sun (SUN_SHADOW 1: through its cascades), the local lights (LIGHTS 1) and the ambient, scattered alike in all
// directions. LOCAL_SHADOW 1: local lights with their shadows.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "engine/particle_interop.h"

layout(set = 0, binding = 0, std430) readonly restrict buffer Frame { ParticleFrame frame; };
layout(set = 0, binding = 1, std430) readonly restrict buffer Particles { GpuParticle particles[]; };
layout(set = 0, binding = 2, std430) readonly restrict buffer Keys { uvec2 keys[]; };

#if SCATTERING
#if LOCAL_SHADOW
#include "common/local_shadow.glsl"
layout(set = 0, binding = 7) uniform sampler2DArray local_shadow_maps; // depth, nearest, clamps
layout(set = 0, binding = 8, std430) readonly restrict buffer LocalShadows { LocalShadow local_shadows[]; };
#endif
layout(constant_id = 0) const uint airlight_features = 0u;
layout(constant_id = 1) const bool has_color = false; // extinction differs between the channels
#define COLORED_EXTINCTION has_color
#include "common/airlight.glsl"
layout(set = 0, binding = 4) uniform Volume {
    ScatteringVolume volume;
    Airlights airlights;
};
layout(set = 0, binding = 5) uniform sampler2DArray accumulated;
layout(set = 0, binding = 6) uniform sampler3D in_scattered;
#else
#include "engine/particle_light.glsl"
#endif

layout(location = 0) out vec2 place;                // in [-1, 1]^2 of the billboard
layout(location = 1) flat out vec2 noise_offset;
layout(location = 2) flat out float noise_share;
layout(location = 3) flat out vec2 depth_and_scale; // view depth, m; reciprocal of the depth over which it fades, 1/m
layout(location = 4) flat out float alpha;
layout(location = 5) out vec3 radiance;             // of the particle and of the fog before it, where it is opaque
layout(location = 6) flat out vec4 taken;           // see GpuParticle

// Smaller billboards than this (px) would fall between pixel centres and flicker: they are drawn this large and thinner.
const float smallest_radius_px = 1.0;

vec2 uv_of(vec4 clip) { return clamp(0.5 * clip.xy / clip.w + 0.5, 0.0, 1.0); }

void main() {
    const vec2 corners[6] = vec2[](vec2(-1, -1), vec2(1, -1), vec2(-1, 1), vec2(-1, 1), vec2(1, -1), vec2(1, 1));
    GpuParticle particle = particles[keys[gl_VertexIndex / 6].y];
    place = corners[gl_VertexIndex % 6];
    vec3 centre = (frame.view_from_render * vec4(particle.position_radius.xyz, 1.0)).xyz;
    float depth_m = -centre.z;
    float w = frame.clip_from_view[2][3] * centre.z + frame.clip_from_view[3][3];
    float true_radius = particle.position_radius.w;
    float radius_px = true_radius * abs(frame.clip_from_view[1][1]) * 0.5 * frame.near_size.z / w;
    float enlarged = max(smallest_radius_px / radius_px, 1.0);
    float radius = true_radius * enlarged;

    float s = sin(particle.look.x);
    float c = cos(particle.look.x);
    vec2 turned = vec2(c * place.x - s * place.y, s * place.x + c * place.y) * radius;
    gl_Position = frame.clip_from_view * vec4(centre + vec3(turned, 0.0), 1.0);

    noise_offset = particle.look.yz;
    noise_share = enlarged > 1.0 ? 0.0 : particle.look.w;
    depth_and_scale = vec2(depth_m, 1.0 / true_radius);
    alpha = particle.albedo_alpha.w / (enlarged * enlarged);
    taken = particle.taken;

#if SCATTERING
    // The corner itself is transparent: light half way to it stands for its quarter of the billboard.
    vec3 light_place = centre + vec3(0.5 * turned, 0.0);
    vec2 light_uv = uv_of(frame.clip_from_view * vec4(light_place, 1.0));
    vec3 light = in_scattered_lookup(volume, in_scattered, light_uv, depth_m);
    ADD_LIGHT_OF_PARTICLE(volume, airlights, light_place, particle.position_radius.xyz, true_radius, light)
    vec3 fog;
    vec3 transmittance;
    scattering_lookup(volume, accumulated, uv_of(gl_Position), depth_m, fog, transmittance);
    // Where the view is orthographic the eye of this corner is not render space's origin.
    PixelPath path = pixel_path(volume, uv_of(gl_Position), depth_m, vec3(0.0), vec3(0.0), 0.5);
    mat3 render_from_view = transpose(mat3(frame.view_from_render));
    path.render_start = render_from_view * path.start;
    path.render_ray = render_from_view * path.ray;
    ADD_AIRLIGHT(volume, airlights, path, fog)
    radiance = particle.albedo_alpha.rgb * light * transmittance + taken.rgb * fog;
#else
    radiance = particle.albedo_alpha.rgb * particle_light(particle.position_radius.xyz, depth_m);
#endif
}
