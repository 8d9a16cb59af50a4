// A box or an ellipsoid of fog as shaders see it.
#ifndef TYNDALL_SHADERS_COMMON_LOCAL_VOLUME_H
#define TYNDALL_SHADERS_COMMON_LOCAL_VOLUME_H

#include "interop.h"

TYNDALL_INTEROP_BEGIN

// At most as many local volumes.
#define TYNDALL_LOCAL_VOLUME_COUNT 16

struct GpuLocalVolume {
    vec4 row_x;            // xyz . p + w: the render-space point p in the space where the shape reaches from -1 to 1
    vec4 row_y;
    vec4 row_z;
    vec4 albedo_amount;    // rgb; w: extinction, 1/m, times density_scale, or the factor of multiply
    vec4 color;            // rgb: extinction of each channel in parts of that, where the medium is coloured
    vec4 emission;         // rgb, times emission_scale.x; a: mean of its density grid; 1 without
    vec4 edge_shape_blend; // x: 1 / edge, 0 where it is hard; y: VolumeShape; z: VolumeBlend; w 0
    vec4 grid;             // xyz: texels of its density grid; w: which grid, from 1; 0: none
};

TYNDALL_INTEROP_END

#endif
