// The frustum-shaped grid over which scattering is stored: the in-scattered radiance at slice centres, and the
// accumulated radiance and optical depth at slice boundaries.
#ifndef TYNDALL_SHADERS_COMMON_SCATTERING_VOLUME_H
#define TYNDALL_SHADERS_COMMON_SCATTERING_VOLUME_H

#include "depth_law.h"
#include "far_field.h"
#include "interop.h"

TYNDALL_INTEROP_BEGIN

// The column of uv (0,0 at the top left of the image) is the set of view-space points
//   xy(z) = (uv * slope.xy + slope.zw) * z + (uv * origin.xy + origin.zw),  z the positive view depth, m.
// A perspective view has origin = 0, an orthographic one slope = 0. Column i of W lies at uv i / (W - 1): the outermost
// columns are the image's edges, so that a look-up never has to go beyond them.
struct ScatteringVolume {
    vec4 slope;  // xy scale, zw offset
    vec4 origin; // xy scale, zw offset, m
    vec4 grid;   // x width, y height, z slices N; w 0
    vec4 slice;  // without a curve: x: depth of the first slice, m; y: depth at its middle t, m; z: length of a slice over that of the one
                 // before it, (1 + R / s)^(1 / N); w: 1 / z
    vec4 area;   // xy: rendered part of the allocated grid in x and y, 1 where all of it is; zw: largest coordinates there
                 // that mix in no column which is not rendered
    vec4 scale;  // x: stored radiance is radiance times this; y: its reciprocal; z: length of a slice over that of the
                 // one before it, less 1; w 0
    DepthLaw law;
    FarField beyond; // the fog behind the last boundary
};

TYNDALL_INTEROP_END

#endif
