// A point or spot light as it lies in a storage buffer; positions in render space (metres, origin at the camera).
#ifndef TYNDALL_SHADERS_COMMON_LIGHTS_H
#define TYNDALL_SHADERS_COMMON_LIGHTS_H

#include "interop.h"

TYNDALL_INTEROP_BEGIN

struct GpuLight {
    vec4 position_range;   // xyz render space, m; w: > 0, where the light has faded to exactly 0, m, or infinity
    vec4 intensity_type;   // rgb candela; w: 0 point, 1 spot
    vec4 direction_radius; // xyz unit direction in which a spot's light travels; w: radius of the source, m
    vec4 cone; // x: angle scale, y: angle offset of KHR_lights_punctual (scale = 1 / max(0.001, cos inner - cos outer),
               // offset = -cos outer * scale). A point light has x = 0, y = 1. z: 0, or 1 + the number of its
               // LocalShadow (common/local_shadow.h); w 0
};

TYNDALL_INTEROP_END

#endif
