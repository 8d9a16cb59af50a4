// Finding a point's cluster. The loop over a cluster's lights is written by the caller, who owns the buffer:
//
//   uint first = cluster_index(clusters, uv, depth_m) * clusters.block.w;
//   for (uint word = 0u; word < clusters.block.w; ++word)
//       for (uint mask = masks[first + word]; mask != 0u; mask &= mask - 1u)
//           shade(lights[32u * word + uint(findLSB(mask))]);
//
// Lights are visited in index order and one outside its range contributes exactly 0, so the sum has the same bits as
// that over all lights.
#ifndef TYNDALL_SHADERS_COMMON_LIGHT_CLUSTERS_GLSL
#define TYNDALL_SHADERS_COMMON_LIGHT_CLUSTERS_GLSL

#include "depth_law.glsl"
#include "light_clusters.h"

uint cluster_index_of_froxel(LightClusters clusters, uvec3 froxel) {
    uvec3 c = min(froxel / clusters.block.xyz, clusters.counts.xyz - 1u);
    return (c.z * clusters.counts.y + c.y) * clusters.counts.x + c.x;
}

// uv in [0, 1]^2 of the image, depth_m the positive view depth.
uint cluster_index(LightClusters clusters, vec2 uv, float depth_m) {
    float t = min(t_from_depth(clusters.law, depth_m), 1.0);
    vec3 froxel = vec3(max(uv, 0.0) * vec2(clusters.grid.xy - 1u) + 0.5, t * float(clusters.grid.z));
    return cluster_index_of_froxel(clusters, uvec3(froxel));
}

#endif
