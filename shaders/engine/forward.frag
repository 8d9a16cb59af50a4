// Lit surfaces. Bindings differ between the variants:
//   SUN_SHADOW   1: the sun shines through its cascades
//   LIGHTS       0: none, 1: all of them, 2: those of the point's cluster
//   LOCAL_SHADOW 1: (with LIGHTS) those that cast shadows do
//   TRANSPARENT  1: laid over what is behind, or added to it; 2: a filter of its base colour, which no light concerns
//   SCATTERING   1: (with TRANSPARENT) fogged at the fragment's own depth
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "engine/brdf.glsl"
#include "engine/material.glsl"

layout(set = 0, binding = 0) uniform Frame { FrameParameters frame; };
layout(constant_id = 2) const bool air_weakens_light = false; // on its way to surfaces
layout(constant_id = 3) const bool light_volumes = false;     // 3 and 4: see light_march.glsl
layout(constant_id = 4) const uint light_octaves = 0u;
layout(constant_id = 6) const bool has_color = false; // extinction differs between the channels
#define COLORED_EXTINCTION has_color
#define MEDIUM frame.medium
#include "common/light_march.glsl"
#if SUN_SHADOW
#include "engine/sun_visibility.glsl"
#endif
#if LIGHTS
#include "common/lights.glsl"
layout(set = 0, binding = 4, std430) readonly restrict buffer Lights { GpuLight lights[]; };
// 1 to 32: the number of lights, each of which has code of its own; 0: a loop. Unrolled code pays on a processor that
// jumps over what none of its eight pixels needs: there a load from a constant place serves all eight at once.
layout(constant_id = 1) const uint unrolled_lights = 0u;
#endif
#if LOCAL_SHADOW
#include "common/local_shadow.glsl"
layout(set = 0, binding = 9) uniform sampler2DArray local_shadow_maps; // depth, nearest, clamps
layout(set = 0, binding = 10, std430) readonly restrict buffer LocalShadows { LocalShadow local_shadows[]; };
#endif
#if LIGHTS == 2
#include "common/light_clusters.glsl"
layout(set = 0, binding = 5) uniform Clusters { LightClusters clusters; };
layout(set = 0, binding = 6, std430) readonly restrict buffer Masks { uint masks[]; };
#endif
#if SCATTERING
layout(constant_id = 5) const uint airlight_features = 0u;
#define AIRLIGHT_SKIPS 0
#include "common/airlight.glsl"
layout(set = 0, binding = 7) uniform Volume {
    ScatteringVolume volume;
    Airlights airlights;
};
layout(set = 0, binding = 8) uniform sampler2DArray accumulated;
#endif

layout(location = 0) in vec3 surface_position;
layout(location = 1) in vec3 surface_normal;
layout(location = 2) in vec4 surface_tangent;
layout(location = 3) in vec4 surface_uv;
layout(location = 4) in vec4 surface_color;

#if TRANSPARENT == 2
layout(location = 0, index = 0) out vec4 color;
layout(location = 0, index = 1) out vec4 passes; // share of the light from behind
#else
layout(location = 0) out vec4 color; // of the light from behind passes 1 - its alpha
#endif

// A degenerate transform leaves no direction: zero then, and not a number that spreads.
vec3 unit(vec3 v) { return v * inversesqrt(max(dot(v, v), 1e-30)); }

vec4 base_color() {
    vec4 base = material.base_color;
    if (has(feature_vertex_color)) {
        base *= surface_color;
    }
    if (has_texture(base_color_slot)) {
        base *= texture(base_color_texture, slot_uv(base_color_slot, surface_uv));
    }
    return base;
}

// Of unit length, toward the eye's side of the surface.
vec3 geometric_normal() {
    vec3 n = unit(surface_normal);
    return gl_FrontFacing ? n : -n;
}

vec3 shading_normal(vec3 geometric) {
    if (!has_texture(normal_slot)) {
        return geometric;
    }
    vec3 mapped = texture(normal_texture, slot_uv(normal_slot, surface_uv)).xyz * 2.0 - 1.0;
    mapped.xy *= material.surface.z;
    vec3 tangent = unit(surface_tangent.xyz);
    vec3 bitangent = cross(unit(surface_normal), tangent) * surface_tangent.w;
    // On back faces the whole frame turns with the normal (glTF 2.0, 3.9.4, double sided).
    vec3 turned = gl_FrontFacing ? mapped.x * tangent + mapped.y * bitangent : -(mapped.x * tangent + mapped.y * bitangent);
    return unit(turned + mapped.z * geometric);
}

Reflection make_reflection(vec3 base, float metallic, float roughness, float n_v) {
    float specular = material.specular.w;
    vec3 specular_color = material.specular.rgb;
    if (has_texture(specular_slot)) {
        specular *= texture(specular_texture, slot_uv(specular_slot, surface_uv)).a;
    }
    if (has_texture(specular_color_slot)) {
        specular_color *= texture(specular_color_texture, slot_uv(specular_color_slot, surface_uv)).rgb;
    }
    vec3 dielectric_f0 = min(0.04 * specular_color, vec3(1.0)) * specular;
    float taken = max(dielectric_f0.r, max(dielectric_f0.g, dielectric_f0.b)); // KHR_materials_specular
    Reflection r;
    r.diffuse = base * ((1.0 - metallic) * inverse_pi);
    r.f0 = mix(dielectric_f0, base, metallic);
    r.f_rise = mix(specular, 1.0, metallic) - r.f0;
    r.transmitted = vec2(1.0 - taken, taken - specular);
    r.a2 = roughness * roughness * roughness * roughness;
    r.n_v = n_v;
    r.smith_v = smith(n_v, r.a2);
    return r;
}

vec3 ambient_radiance(vec3 direction) {
    return mix(frame.ambient_down.rgb, frame.ambient_up.rgb, 0.5 + 0.5 * direction.y);
}

#if LIGHTS
// `geometric`: normal without its map.
vec3 local_light(GpuLight light, Reflection r, vec3 normal, vec3 geometric, vec3 to_eye) {
    if (unrolled_lights > 0u) { // what is out of reach adds exactly 0 below as well
        vec3 d = light.position_range.xyz - surface_position;
        if (dot(d, d) >= light.position_range.w * light.position_range.w || dot(d, normal) <= 0.0) {
            return vec3(0.0);
        }
    }
    vec3 to_light;
    vec3 irradiance = light_irradiance_normal(light, surface_position, to_light);
    if (air_weakens_light) {
        irradiance *= light_transmittance(surface_position, light.position_range.xyz - surface_position);
    }
#if LOCAL_SHADOW
    if (casts_local_shadow(light.cone)) {
        float facing = dot(geometric, to_light);
        if (facing <= 0.0 || irradiance == vec3(0.0)) {
            return vec3(0.0);
        }
        irradiance *= local_surface_visibility(local_shadows[local_shadow_index(light.cone)], local_shadow_maps,
                                               surface_position, geometric);
    }
#endif
    return irradiance * reflect_light(r, to_eye, to_light, max(dot(normal, to_light), 0.0));
}

// In index order in every variant, so that all give the same bits.
vec3 local_lights(Reflection r, vec3 normal, vec3 geometric, vec3 to_eye, vec2 uv, float depth_m) {
    vec3 sum = vec3(0.0);
#if LIGHTS == 2
    uint first = cluster_index(clusters, uv, depth_m) * clusters.block.w;
#endif
    if (unrolled_lights > 0u) {
#if LIGHTS == 2
        uint mask = masks[first];
#else
        uint mask = ~0u;
#endif
        [[unroll]] for (uint i = 0u; i < unrolled_lights; ++i) {
            if ((mask & (1u << i)) != 0u) {
                sum += local_light(lights[i], r, normal, geometric, to_eye);
            }
        }
        return sum;
    }
#if LIGHTS == 2
    for (uint word = 0u; word < clusters.block.w; ++word) {
        for (uint mask = masks[first + word]; mask != 0u; mask &= mask - 1u) {
            sum += local_light(lights[32u * word + uint(findLSB(mask))], r, normal, geometric, to_eye);
        }
    }
#else
    uint count = uint(frame.ambient_down.w);
    for (uint i = 0u; i < count; ++i) {
        sum += local_light(lights[i], r, normal, geometric, to_eye);
    }
#endif
    return sum;
}
#endif

vec3 directional_light(Reflection r, vec3 normal, vec3 to_eye, vec3 travel, vec3 illuminance) {
    float n_l = -dot(normal, travel);
    return n_l > 0.0 ? illuminance * reflect_light(r, to_eye, -travel, n_l) : vec3(0.0);
}

vec3 lit_radiance(vec3 base, float depth_m) {
    float metallic = material.surface.x;
    float roughness = material.surface.y;
    if (has_texture(surface_slot)) {
        vec2 texel = texture(surface_texture, slot_uv(surface_slot, surface_uv)).gb;
        roughness *= texel.x;
        metallic *= texel.y;
    }
    roughness = clamp(roughness, 0.045, 1.0); // smoother is a spike that neither numbers nor pixels can hold
    vec3 geometric = geometric_normal();
    vec3 normal = shading_normal(geometric);
    vec3 to_eye = unit(frame.to_eye.xyz - frame.to_eye.w * surface_position);
    float n_v = max(dot(normal, to_eye), 1e-3);
    Reflection r = make_reflection(base, metallic, roughness, n_v);

    float occlusion = 1.0;
    if (has_texture(occlusion_slot)) {
        float texel = texture(occlusion_texture, slot_uv(occlusion_slot, surface_uv)).r;
        occlusion += material.surface.w * (texel - 1.0);
    }
    vec2 environment = environment_reflection(roughness, n_v);
    vec3 mirrored = r.f0 * (environment.x + environment.y) + r.f_rise * environment.y;
    float beneath = 1.0 + (r.transmitted.x - 1.0) * (environment.x + environment.y) + r.transmitted.y * environment.y;
    vec3 radiance = occlusion * (r.diffuse * (pi * beneath) * ambient_radiance(normal) +
                                 mirrored * ambient_radiance(reflect(-to_eye, normal)));

    vec3 sun_travel = frame.sun_direction.xyz;
    vec3 sun_light = directional_light(r, normal, to_eye, sun_travel, frame.sun_illuminance.rgb);
    if (air_weakens_light) {
        sun_light *= sun_transmittance(surface_position, sun_travel);
    }
#if SUN_SHADOW
    if (sun_light != vec3(0.0) && dot(geometric, sun_travel) < 0.0) {
        radiance += sun_light * sun_visibility(surface_position, geometric, depth_m);
    }
#else
    radiance += sun_light;
#endif
    int fills = int(frame.ambient_up.w);
    for (int i = 0; i < fills; ++i) {
        radiance +=
            directional_light(r, normal, to_eye, frame.fill_direction[i].xyz, frame.fill_illuminance[i].rgb);
    }
#if LIGHTS
    radiance += local_lights(r, normal, geometric, to_eye, gl_FragCoord.xy * frame.size.zw, depth_m);
#endif
    vec3 emission = material.emission_cutoff.rgb;
    if (has_texture(emission_slot)) {
        emission *= texture(emission_texture, slot_uv(emission_slot, surface_uv)).rgb;
    }
    return radiance + emission;
}

void main() {
    vec4 base = base_color();
    float depth_m = dot(frame.depth_row.xyz, surface_position) + frame.depth_row.w;
#if TRANSPARENT == 2
    vec3 radiance = vec3(0.0);
    vec3 taken = 1.0 - clamp(base.rgb, 0.0, 1.0); // at alpha 1 of the light from behind, and shown of the fog before it
#else
    vec3 radiance = has(feature_unlit) ? base.rgb : lit_radiance(base.rgb, depth_m);
    vec3 taken = vec3(has(feature_additive) ? 0.0 : 1.0);
#endif
#if SCATTERING
    vec3 fog;
    vec3 transmittance;
    scattering_lookup(volume, accumulated, gl_FragCoord.xy * frame.size.zw, depth_m, fog, transmittance);
    vec3 ray = -unit(frame.to_eye.xyz - frame.to_eye.w * surface_position);
    PixelPath path = pixel_path(volume, gl_FragCoord.xy * frame.size.zw, depth_m, vec3(0.0), ray,
                                interleaved_noise(gl_FragCoord.xy));
    path.render_start = surface_position - path.length_m * ray;
    ADD_AIRLIGHT(volume, airlights, path, fog)
    radiance = radiance * transmittance + taken * fog;
#endif
    radiance = min(radiance, vec3(frame.ray_origin.w));
#if TRANSPARENT
    float alpha = clamp(base.a, 0.0, 1.0);
    vec4 all_taken = vec4(taken, (taken.r + taken.g + taken.b) / 3.0);
    color = vec4(radiance, all_taken.a) * alpha;
#if TRANSPARENT == 2
    passes = 1.0 - alpha * all_taken;
#endif
#else
    color = vec4(radiance, 1.0);
#endif
}
