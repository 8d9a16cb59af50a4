// What weakens light on its way to a surface, in the render space of one view: the part of a medium that light's way
// depends on.
#ifndef TYNDALL_SHADERS_COMMON_LIGHT_MEDIUM_H
#define TYNDALL_SHADERS_COMMON_LIGHT_MEDIUM_H

#include "interop.h"
#include "local_volume.h"

TYNDALL_INTEROP_BEGIN

struct LightMedium {
    vec4 air;           // see light_attenuation.glsl
    vec4 air_heights;   // xy: there, too; zw 0
    vec4 homogeneous_color; // rgb: extinction of each channel in parts of air's, of the homogeneous fog
    vec4 height_color;      // and of the height fog
    vec4 noise_origin;  // xyz: render space's origin in noise cells, in [0, 256); w: amplitude of the first octave
    vec4 noise_cells;   // x: cells per metre; y: amplitude of an octave over that of the one before; zw 0
    vec4 density_scale; // x: what the volumes' extinction is stored times; y: 1 / x; zw 0
    vec4 march;         // see light_march.glsl
    GpuLocalVolume volumes[TYNDALL_LOCAL_VOLUME_COUNT]; // the first march.x
};

TYNDALL_INTEROP_END

#endif
