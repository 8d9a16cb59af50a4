// Media -> scattering coefficient (rgb) and extinction (a) of each froxel, times density_scale so that fp16 holds thin
// and dense media alike. One pass, specialised to the media that are there. EMISSION 1: and the radiance gained per
// metre (rgb), times emission_scale. TEXTURES 1: media of textures may be there. PARTICLES 1: there are particles, with
// the clusters that they reach. Where extinction is coloured the volume is
// twice as deep: behind the N slices stand N with the extinction of each channel (rgb).
#version 460
#extension GL_GOOGLE_include_directive : require

layout(constant_id = 8) const bool has_depth_curve = false;
#define DEPTH_CURVE has_depth_curve
layout(constant_id = 9) const bool has_color = false;
#define COLORED_EXTINCTION has_color

#include "common/height_density.glsl"
#include "common/noise.glsl"
#include "volumetrics/froxel.glsl"
#include "volumetrics/interop.h"
#include "volumetrics/storage.glsl"

layout(local_size_x_id = 0, local_size_y_id = 1, local_size_z_id = 2) in;
layout(constant_id = 3) const bool has_homogeneous = true;
layout(constant_id = 4) const bool has_height = true;
layout(constant_id = 5) const uint noise_octaves = 1u; // 0: no noise of octaves
layout(constant_id = 6) const bool is_perspective = true;
layout(constant_id = 7) const bool has_volumes = false;

layout(set = 0, binding = 0) uniform Parameters { VolumetricParameters u; };
layout(set = 0, binding = 1, VOLUME_FORMAT) uniform writeonly restrict image3D density;
#if EMISSION
layout(set = 0, binding = 2, VOLUME_FORMAT) uniform writeonly restrict image3D emitted;
#endif
#if TEXTURES
layout(set = 0, binding = 3) uniform sampler3D noise_shape; // these repeat in every direction
layout(set = 0, binding = 4) uniform sampler3D noise_detail;
layout(constant_id = 10) const bool has_baked_noise = false;
layout(constant_id = 11) const bool has_map = false;
layout(constant_id = 12) const bool has_grids = false;
#define DENSITY_GRIDS has_grids
#include "volumetrics/density_textures.glsl"
#else
const bool has_baked_noise = false;
#endif
#include "common/local_volumes.glsl"
#if PARTICLES
#include "common/light_clusters.glsl"
#include "volumetrics/fog_particle.glsl"
layout(set = 0, binding = 10, std430) readonly restrict buffer Particles { GpuFogParticle particles[]; };
layout(set = 0, binding = 11, std430) readonly restrict buffer Masks { uint masks[]; };
layout(set = 0, binding = 12) uniform ClusterParameters { LightClusters clusters; };
#endif

float octave_noise_factor(vec3 render_position, float froxel_m) {
    vec3 p = render_position * u.noise_cells.x + u.noise_origin.xyz;
    return octave_noise(p, froxel_m * u.noise_cells.x, u.noise_origin.w, u.noise_cells.y, noise_octaves);
}

#if TEXTURES
// NoiseKind::perlin_worley of features/volumetrics/density_noise.hpp. Where a froxel is too large to show the cells of a
// volume, four a period, its means take its place: those of the detail leave the noise's mean as it is.
float baked_noise_factor(vec3 render_position, float froxel_m) {
    float shape_part = clamp(2.0 - 8.0 * froxel_m * u.noise_cells.x, 0.0, 1.0);
    float detail_part = clamp(2.0 - 8.0 * froxel_m * u.noise_detail.w, 0.0, 1.0);
    float shape = textureLod(noise_shape, render_position * u.noise_cells.x + u.noise_origin.xyz, 0.0).r;
    float detail = textureLod(noise_detail, render_position * u.noise_detail.w + u.noise_detail.xyz, 0.0).r;
    float cover = max(shape * u.noise_cover.x + u.noise_cover.y, 0.0);
    float eroded = u.noise_cover.z * mix(0.5, detail, detail_part);
    float left = max(cover - eroded, 0.0) / (1.0 - eroded);
    return 1.0 + u.noise_origin.w * shape_part * (left * u.noise_cover.w - 1.0);
}
#endif

float noise_factor(vec3 render_position, float froxel_m) {
#if TEXTURES
    if (has_baked_noise) {
        return baked_noise_factor(render_position, froxel_m);
    }
#endif
    return octave_noise_factor(render_position, froxel_m);
}

void main() {
    ivec3 froxel = ivec3(gl_GlobalInvocationID);
    vec3 grid = u.volume.grid.xyz;
    if (any(greaterThanEqual(froxel, ivec3(grid)))) {
        return;
    }
    vec2 uv = uv_of_column(u.volume, vec2(froxel.xy));
    vec3 ray = u.ray_u.xyz * uv.x + u.ray_v.xyz * uv.y + u.ray_0.xyz;
    vec3 eye = is_perspective ? vec3(0.0) : u.eye_u.xyz * uv.x + u.eye_v.xyz * uv.y + u.eye_0.xyz;
    float near_m = boundary_depth(u.volume, float(froxel.z));
    float far_m = near_m + slice_depth(u.volume, float(froxel.z), near_m);

    vec4 medium = vec4(0.0);
    vec3 extinction = vec3(0.0); // where it is coloured
    vec3 emission = vec3(0.0);
    if (has_homogeneous) {
        vec4 parts = vec4(u.homogeneous.rgb, 1.0);
        if (has_color) {
            parts.rgb *= u.homogeneous_color.rgb;
            extinction += u.homogeneous_color.rgb * u.homogeneous.w;
        }
        medium += parts * u.homogeneous.w;
        emission += u.homogeneous_emission.rgb;
    }
    if (has_height) {
        float eye_height = eye.y - u.height_law.x;
        float mean = mean_height_density(eye_height + ray.y * near_m, eye_height + ray.y * far_m, u.height_law.y);
        vec4 parts = vec4(u.height.rgb, 1.0);
        if (has_color) {
            parts.rgb *= u.height_color.rgb;
            extinction += u.height_color.rgb * (u.height.w * mean);
        }
        medium += parts * (u.height.w * mean);
        emission += u.height_emission.rgb * mean;
    }
#if TEXTURES
    if (has_map) {
        float kept = mean_map_density(eye + ray * near_m, eye + ray * far_m);
        medium *= kept;
        extinction *= kept;
        emission *= kept;
    }
#endif
    if (has_volumes) {
        for (uint i = 0u; i < u.frame.z; ++i) {
            blend_local_volume(u.volumes[i], eye + ray * near_m, eye + ray * far_m, medium, extinction, emission);
        }
    }
#if PARTICLES
    float stretch = length(ray);
    uint first = cluster_index_of_froxel(clusters, uvec3(froxel)) * clusters.block.w;
    for (uint word = 0u; word < clusters.block.w; ++word) {
        for (uint mask = masks[first + word]; mask != 0u; mask &= mask - 1u) {
            GpuFogParticle particle = particles[32u * word + uint(findLSB(mask))];
            vec3 to_centre = particle.position_radius.xyz - (eye + ray * near_m);
            float weight = mean_fog_particle_weight(to_centre, particle.position_radius.w, ray / stretch,
                                                    (far_m - near_m) * stretch);
            float amount = weight * particle.albedo_amount.w;
            medium += vec4(particle.albedo_amount.rgb, 1.0) * amount;
            extinction += amount;
        }
    }
#endif
    if (noise_octaves > 0u || has_baked_noise) {
        float middle_m = 0.5 * (near_m + far_m);
        vec2 cell = (u.volume.slope.xy * middle_m + u.volume.origin.xy) / (grid.xy - 1.0);
        float froxel_m = max(max(abs(cell.x), abs(cell.y)), (far_m - near_m) * length(ray));
        float factor = noise_factor(eye + ray * middle_m, froxel_m);
        medium *= factor;
        extinction *= factor;
        emission *= factor;
    }
    if (has_color) {
        medium.a = max(extinction.r, max(extinction.g, extinction.b));
        imageStore(density, froxel + ivec3(0, 0, int(grid.z)), storable(vec4(extinction, 0.0)));
    }
    imageStore(density, froxel, storable(medium));
#if EMISSION
    imageStore(emitted, froxel, storable(vec4(emission, 0.0)));
#endif
}
