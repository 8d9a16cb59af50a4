// Fog beyond the range of a scattering volume, which no froxel holds: the medium without noise, sun and ambient, in
// view space.
#ifndef TYNDALL_SHADERS_COMMON_FAR_FIELD_H
#define TYNDALL_SHADERS_COMMON_FAR_FIELD_H

#include "interop.h"

TYNDALL_INTEROP_BEGIN

// Up to four phase functions, a lobe a component: (constant + squared cos^2(theta)) s^-3/2, or s^-2 where `steep` is 1,
// with s = spread + forward |a - b|^2 + backward |a + b|^2 for the unit directions a in which light travels and b to
// the eye. All functions of volumetrics/phase.glsl have this form.
struct PhaseTerms {
    vec4 constant; // with the lobe's weight; 0 without a lobe
    vec4 squared;
    vec4 spread; // 1 without a lobe
    vec4 forward;
    vec4 backward;
    vec4 steep;
};

struct FarField {
    vec4 homogeneous;     // rgb albedo; w: extinction, 1/m
    vec4 homogeneous_color; // rgb: extinction of each channel in parts of that, where the medium is coloured
    vec4 height_color;      // the same of the height fog
    vec4 height;          // rgb albedo; w: extinction at and below the base, 1/m
    vec4 up;              // xyz: the world's up in view space; w: height of view space's origin above the base, m
    vec4 heights;         // xy: between which there is fog, along `up` from view space's origin, m; zw 0
    vec4 sun_direction;   // xyz: unit direction in which it travels, view space; w: 1 where the height fog
                          // weakens it, else 0
    vec4 sun_illuminance; // rgb lux; w: falloff of the height fog, 1/m
    PhaseTerms phase;
    vec4 ambient;         // rgb radiance from every direction; w 0
    vec4 ambient_x; // rgb: what scattering leaves of the part of ambient radiance that is proportional to the x of
    vec4 ambient_y; // its direction in view space; the same of y and z
    vec4 ambient_z;
};

TYNDALL_INTEROP_END

#endif
