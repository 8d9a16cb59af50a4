// A soft sphere of fog as shaders see it.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_FOG_PARTICLE_H
#define TYNDALL_SHADERS_VOLUMETRICS_FOG_PARTICLE_H

#include "../common/interop.h"

TYNDALL_INTEROP_BEGIN

// At most as many.
#define TYNDALL_FOG_PARTICLE_COUNT 4096

struct GpuFogParticle {
    vec4 position_radius; // xyz render space, m; w: radius, m
    vec4 albedo_amount;   // rgb; w: extinction at the centre, 1/m, times density_scale
};

TYNDALL_INTEROP_END

#endif
