// Lights whose glow no grid of froxels can hold: their light is integrated along the ray of each pixel instead.
#ifndef TYNDALL_SHADERS_COMMON_AIRLIGHT_H
#define TYNDALL_SHADERS_COMMON_AIRLIGHT_H

#include "interop.h"
#include "lights.h"

TYNDALL_INTEROP_BEGIN

// At most as many.
#define TYNDALL_AIRLIGHT_COUNT 32

struct Airlights {
    vec4 shape; // x: width of the phase function's forward peak, rad; y: of its backward one; z: 1 where air weakens light
                // on its way, else 0; w 0
    GpuLight lights[TYNDALL_AIRLIGHT_COUNT]; // in view space
};

// What a pipeline is specialised to, bits of one constant; 0: no such light.
#define TYNDALL_AIRLIGHT_COUNT_BITS 6u    // lowest: the number of lights
#define TYNDALL_AIRLIGHT_HEIGHT_BIT 64u   // there is height fog
#define TYNDALL_AIRLIGHT_SPOT_BIT 128u    // one of the lights is a spot
#define TYNDALL_AIRLIGHT_LOBES_SHIFT 8u   // the number of phase functions, 1 to 4

TYNDALL_INTEROP_END

#endif
