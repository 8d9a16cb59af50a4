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
    vec4 sun_direction;   // xyz: unit direction in which it travels, view space; w 0
    vec4 sun_illuminance; // rgb lux; w: falloff of the height fog, 1/m
    uvec4 phase_function; // of each lobe, as PhaseFunction of features/volumetrics/phase.hpp
    vec4 phase_asymmetry; // g or k of each lobe
    vec4 phase_weight;    // of each lobe, of sum 1; 0: no lobe
    vec4 ambient;         // rgb radiance from every direction; w 0
    vec4 ambient_x; // rgb: what scattering leaves of the part of ambient radiance that is proportional to the x of
    vec4 ambient_y; // its direction in view space; the same of y and z
    vec4 ambient_z;
};

TYNDALL_INTEROP_END

#endif
