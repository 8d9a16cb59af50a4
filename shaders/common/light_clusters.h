// Clusters: blocks of the scattering volume's froxels, each with a bit mask of the lights that can reach it.
#ifndef TYNDALL_SHADERS_COMMON_LIGHT_CLUSTERS_H
#define TYNDALL_SHADERS_COMMON_LIGHT_CLUSTERS_H

#include "depth_law.h"
#include "interop.h"

TYNDALL_INTEROP_BEGIN

// Cluster (x, y, z) holds froxels [x bx, (x + 1) bx) and so on of a grid of grid.xyz froxels; its mask is
// `uint masks[cluster_index * words + word]`, bit i of word w standing for light 32 w + i. The first slab starts at the
// eye, the last one reaches to infinity, so that every visible point has a cluster.
struct LightClusters {
    uvec4 grid;   // xyz: froxels; w: number of lights
    uvec4 block;  // xyz: froxels of a cluster; w: words of a mask, ceil(lights / 32)
    uvec4 counts; // xyz: clusters; w 0
    DepthLaw law;
};

TYNDALL_INTEROP_END

#endif
