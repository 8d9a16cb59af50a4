// Fog beyond the range of a scattering volume, which no froxel holds: the medium without noise, sun and ambient, in
// view space.
#ifndef TYNDALL_SHADERS_COMMON_FAR_FIELD_H
#define TYNDALL_SHADERS_COMMON_FAR_FIELD_H

#include "interop.h"

TYNDALL_INTEROP_BEGIN

struct FarField {
    vec4 homogeneous;     // rgb albedo; w: extinction, 1/m
    vec4 height;          // rgb albedo; w: extinction at and below the base, 1/m
    vec4 up;              // xyz: the world's up in view space; w: height of view space's origin above the base, m
    vec4 sun_direction;   // xyz: unit direction in which it travels, view space; w: Henyey-Greenstein g
    vec4 sun_illuminance; // rgb lux; w: falloff of the height fog, 1/m
    vec4 ambient;         // rgb radiance from every direction; w 0
};

TYNDALL_INTEROP_END

#endif
