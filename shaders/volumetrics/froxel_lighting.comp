// Sun shadow map, light clusters, ambient, history -> in-scattered radiance per unit of scattering coefficient (rgb) and the number
// of frames in its mean (a).
//
// The sample lies at a jittered place in its froxel, so that the mean over frames averages visibility along the slice
// and across it. Reprojection blends with the frame before: a running mean, 1/n, until the steady weight.
//
// SUN_SHADOW 1: sun through the ESM or the cascades, as `visibility` wants. LIGHTS 0: none; 1: every froxel visits all; 2: by clusters; 3: by clusters, from the
// compact copy of at most 256 lights in a uniform buffer, which processors fetch several times faster than a storage
// buffer when the index differs between lanes. LOCAL_SHADOW 1: of them those that cast shadows do. HISTORY 1: temporal
// reprojection.
#version 460
#extension GL_GOOGLE_include_directive : require

layout(constant_id = 12) const bool has_depth_curve = false;
#define DEPTH_CURVE has_depth_curve
layout(constant_id = 17) const bool has_color = false;
#define COLORED_EXTINCTION has_color

#include "common/lights.glsl"
#include "volumetrics/froxel.glsl"
#include "volumetrics/interop.h"
#include "volumetrics/random.glsl"
#include "volumetrics/ray_segment.glsl"
#include "volumetrics/storage.glsl"

layout(local_size_x_id = 0, local_size_y_id = 1, local_size_z_id = 2) in;
layout(constant_id = 3) const bool has_sun = true;
layout(constant_id = 4) const uint cascade_count = 4;
layout(constant_id = 5) const bool is_perspective = true;
layout(constant_id = 6) const bool camera_stands = false; // since the frame before: history is not reprojected
layout(constant_id = 7) const uint sun_visibility = 2;    // of slice_visibility.glsl
layout(constant_id = 8) const uint visibility_taps = 1;   // 9 and 10: phase.glsl
layout(constant_id = 11) const bool has_directed_ambient = false;

layout(constant_id = 13) const uint light_changes = 2; // 0: since the frame before nothing; 1: sun, ambient or the
                                                       // direction of view; 2: local lights, too

layout(constant_id = 14) const bool air_weakens_light = false; // on its way to the froxel
layout(constant_id = 15) const bool light_volumes = false;     // 15 and 16: see light_march.glsl
layout(constant_id = 16) const uint light_octaves = 0u;
layout(constant_id = 18) const bool leaves_out_lights = false; // which each pixel integrates along its ray

layout(set = 0, binding = 0) uniform Parameters { VolumetricParameters u; };
layout(set = 0, binding = 1, VOLUME_FORMAT) uniform writeonly restrict image3D in_scattered;

#define MEDIUM u
#include "common/light_march.glsl"
#include "volumetrics/phase.glsl"

#if SUN_SHADOW
#include "volumetrics/slice_visibility.glsl"
layout(set = 0, binding = 2) uniform sampler2DArray shadow_map; // ESM or cascades; nearest, clamps
layout(set = 0, binding = 3) uniform Sun { SunCascades cascades; };
#endif
#if LIGHTS
#include "common/light_clusters.glsl"
#if LOCAL_SHADOW
#include "common/local_shadow.glsl"
layout(set = 0, binding = 8) uniform sampler2DArray local_shadow_maps; // nearest, clamps
layout(set = 0, binding = 9, std430) readonly restrict buffer LocalShadows { LocalShadow local_shadows[]; };
#endif
#include "volumetrics/local_lights.glsl"
#if LIGHTS == 3
layout(set = 0, binding = 4) uniform Lights { GpuLight lights[TYNDALL_COMPACT_LIGHT_COUNT]; };
#else
layout(set = 0, binding = 4, std430) readonly restrict buffer Lights { GpuLight lights[]; };
#endif
#endif
#if LIGHTS >= 2
layout(set = 0, binding = 5) uniform ClusterParameters { LightClusters clusters; };
layout(set = 0, binding = 6, std430) readonly restrict buffer Masks { uint masks[]; };
#endif
#if HISTORY
layout(set = 0, binding = 7) uniform sampler3D history; // linear, clamps
layout(push_constant) uniform Push { uint history_valid; };
#include "volumetrics/light_change.glsl"
#endif

vec3 sun_scattering(RaySegment segment, float depth_m) {
    float visibility = 1.0;
#if SUN_SHADOW
    vec2 size = sun_visibility == prefiltered ? u.esm_size.xy : u.esm_size.zw;
    SUN_VISIBILITY(cascades, cascade_count, shadow_map, u.esm_exponents, size, sun_visibility, visibility_taps,
                   segment, depth_m, visibility)
#endif
    vec3 illuminance = u.sun_illuminance.rgb;
    if (air_weakens_light) {
        vec3 passes = sun_transmittance(segment.position, u.sun_direction.xyz);
        if (has_color) {
            illuminance *= passes;
        } else {
            visibility *= passes.r;
        }
    }
    return illuminance * (visibility * phase_function(phase_angle(u.sun_direction.xyz, segment.to_eye)));
}

#if LIGHTS
// The bits of `mask`, that of lights 32 word and up, without those of lights that the froxels leave out.
uint kept_lights(uint mask, uint word) {
    if (!leaves_out_lights || word >= TYNDALL_AIRLIGHT_CANDIDATES / 32u) {
        return mask;
    }
    return mask & u.kept_lights[word / 4u][word % 4u];
}

vec3 local_scattering(uvec3 froxel, RaySegment segment) {
    vec3 sum = vec3(0.0);
#if LIGHTS >= 2
    uint first = cluster_index_of_froxel(clusters, froxel) * clusters.block.w;
    for (uint word = 0u; word < clusters.block.w; ++word) {
        for (uint mask = kept_lights(masks[first + word], word); mask != 0u; mask &= mask - 1u) {
            uint i = 32u * word + uint(findLSB(mask));
            ADD_SCATTERED_FROM_LIGHT(lights, i, segment, sum)
        }
    }
#else
    for (uint i = 0u; i < u.frame.y; ++i) {
        if (kept_lights(1u << i % 32u, i / 32u) != 0u) {
            ADD_SCATTERED_FROM_LIGHT(lights, i, segment, sum)
        }
    }
#endif
    return sum;
}
#endif

#if HISTORY
// The frame before at this froxel's centre: rgb in this frame's scale, a: its age, 0 where there is none.
vec4 fetch_history(ivec3 froxel, float near_m) {
    vec4 old;
    if (camera_stands) {
        old = texelFetch(history, froxel, 0);
    } else {
        vec3 now = view_position(u.volume, uv_of_column(u.volume, vec2(froxel.xy)),
                                 slice_middle(u.volume, float(froxel.z), near_m));
        vec3 before = (u.previous_view_from_view * vec4(now, 1.0)).xyz;
        vec2 uv = column_uv(u.volume, before.xy, -before.z);
        float t = t_from_depth(u.volume.law, -before.z);
        bool inside = before.z < 0.0 && all(greaterThanEqual(uv, vec2(0.0))) && all(lessThanEqual(uv, vec2(1.0))) &&
                      t <= 1.0;
        if (!inside) {
            return vec4(0.0);
        }
        old = textureLod(history, vec3(texture_uv(u.volume, uv), t), 0.0);
    }
    old.rgb *= u.temporal.z;
    return is_finite(old) ? old : vec4(0.0);
}

// The change of the phase function by the eye's way, of the sun's light as it is, else no less than it can be. It counts a
// third, as an average over more frames is worth some lag.
float a_third_of_change_of_view(RaySegment segment) {
    if (has_sun) {
        vec3 to_eye_before = normalize(u.motion.xyz - segment.position);
        float now = phase_function(phase_angle(u.sun_direction.xyz, segment.to_eye));
        float before = phase_function(phase_angle(u.sun_direction.xyz, to_eye_before));
        return abs(now - before) / max(3.0 * now, 1e-30);
    }
    return u.phase.x * u.motion.w / (3.0 * max(length(segment.position), max(u.motion.w, 1e-10)));
}

// How much the light of the froxel has changed since, in parts of itself: sun, ambient and phase function everywhere,
// the direction of view with the camera's way, local lights where they reach. Its diagonal and a half hold the parts of
// its neighbours that history is filtered from.
float change_since(RaySegment segment, float depth_m) {
    if (light_changes == 0u) {
        return 0.0;
    }
    float change = u.temporal.w;
    if (!camera_stands && is_perspective && u.phase.x > 0.0) {
        change += a_third_of_change_of_view(segment);
    }
    vec2 cell_m = (u.volume.slope.xy * depth_m + u.volume.origin.xy) / (u.volume.grid.xy - 1.0);
    float reach_m = 1.5 * length(vec3(cell_m, segment.behind_m + segment.ahead_m));
    for (uint i = 0u; light_changes == 2u && i < u.frame.w; ++i) {
        change += light_change(u.changed_lights[2u * i], u.changed_lights[2u * i + 1u], segment.position, reach_m,
                               u.phase.x);
    }
    return change;
}
#endif

void main() {
    uvec3 froxel = gl_GlobalInvocationID;
    if (any(greaterThanEqual(froxel, uvec3(u.volume.grid.xyz)))) {
        return;
    }
    // A low-discrepancy sequence over frames (Roberts' R3), shifted by a random offset per froxel.
    uvec3 bits = hash3(froxel);
    vec3 place = u.jitter.w > 0.5 ? fract(unit_floats(bits) + u.jitter.xyz) : vec3(0.5);
    vec2 uv = uv_of_column(u.volume, vec2(froxel.xy) + place.xy - 0.5);
    float near_m = boundary_depth(u.volume, float(froxel.z));
    float far_m = near_m + slice_depth(u.volume, float(froxel.z), near_m);
    float depth_m = mix(near_m, far_m, place.z);

    vec3 ray = u.ray_u.xyz * uv.x + u.ray_v.xyz * uv.y + u.ray_0.xyz;
    float stretch = length(ray);
    vec3 to_eye = ray * (-1.0 / stretch);
    vec3 position = ray * depth_m;
    if (!is_perspective) {
        position += u.eye_u.xyz * uv.x + u.eye_v.xyz * uv.y + u.eye_0.xyz;
    }

    RaySegment segment = RaySegment(position, to_eye, (depth_m - near_m) * stretch, (far_m - depth_m) * stretch);

    vec3 sum = u.ambient.rgb;
    if (has_directed_ambient) {
        // Looking along -to_eye, forward scattering brings the light from there.
        sum -= u.ambient_x.rgb * to_eye.x + u.ambient_y.rgb * to_eye.y + u.ambient_z.rgb * to_eye.z;
    }
    if (has_sun) {
        sum += sun_scattering(segment, depth_m);
    }
#if LIGHTS
    sum += local_scattering(froxel, segment);
#endif
    vec4 result = vec4(sum * u.volume.scale.x, 1.0);
    result = is_finite(result) ? result : vec4(0.0, 0.0, 0.0, 1.0);

#if HISTORY
    vec4 old = vec4(0.0);
    if (history_valid != 0u) {
        old = fetch_history(ivec3(froxel), near_m);
    }
    if (old.a > 0.0) {
        float age = min(old.a, min(u.temporal.y, oldest_age(change_since(segment, depth_m)))) + 1.0;
        result.rgb = mix(old.rgb, result.rgb, max(1.0 / age, u.temporal.x));
        result.a = age;
    }
    uint dice = (bits.x ^ u.frame.x * 0x9e3779b9u) * 0x2c1b3c6du;
    dice = (dice ^ dice >> 15u) * 0x297a2d39u;
    imageStore(in_scattered, ivec3(froxel), storable_unbiased(result, dice ^ dice >> 15u));
#else
    imageStore(in_scattered, ivec3(froxel), storable(result));
#endif
}
