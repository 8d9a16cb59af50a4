// The sun's shadow cascades: a D32_SFLOAT 2D array of 4 layers, 0 at the light, linear (orthographic), cleared to 1.
#ifndef TYNDALL_SHADERS_COMMON_SUN_SHADOW_H
#define TYNDALL_SHADERS_COMMON_SUN_SHADOW_H

#include "interop.h"

TYNDALL_INTEROP_BEGIN

struct SunCascades {
    mat4 shadow_from_render[4]; // xy in [0, 1]: uv of the layer; z in [0, 1]: depth, 0 at the light
    vec4 split_depth_m;         // far view depth of each cascade
    vec4 depth_range_m;         // metres that z = 1 spans, of each cascade
    vec4 texel_m;               // size of a texel in the world, of each cascade
    vec4 direction_count;       // xyz: unit direction in which the light travels, render space; w: number of cascades
    vec4 illuminance;           // rgb lux
};

TYNDALL_INTEROP_END

#endif
