// What the host tells the particle passes, and what they tell each other; the same structs in GLSL and C++.
#ifndef TYNDALL_SHADERS_ENGINE_PARTICLE_INTEROP_H
#define TYNDALL_SHADERS_ENGINE_PARTICLE_INTEROP_H

#include "../common/interop.h"

TYNDALL_INTEROP_BEGIN

// One view at one time. A storage buffer holds a ParticleFrame and then the emitters.
struct ParticleFrame {
    mat4 view_from_render;
    mat4 clip_from_view;   // y down, reverse z
    vec4 frustum[4];       // unit inward normals (view space) and distances: left, right, top, bottom
    vec4 depth;            // view depth of device depth d: (x - d y) / (z + d w), m
    vec4 near_size;        // x: near plane, m; y: image width, z: image height, px; w 0
    vec4 ambient;          // rgb radiance from every direction } these two and the lights are
    vec4 sun_illuminance;  // rgb lux                           } used where there is no scattering volume
    uvec4 counts;          // x: emitters, y: particles, z: sort keys, a power of two >= y; w: lights
    vec4 wave_number[3];   // turbulence is three plane waves: xyz wave number, rad/m; w: frequency, rad/s
    vec4 wave_speed[3];    // xyz unit direction of its motion, across the wave number; w: amplitude over frequency, s
};

// A source of particles. Birth number k happens at time k / rate, for every integer k, so that the emitter has always
// been there; birth k owns slot k mod slots for its whole life.
struct GpuEmitter {
    vec4 origin_lifetime;     // xyz centre of the box in render space, m; w: lifetime, s
    vec4 box_start_radius;    // xyz half extent, m; w: radius at birth, m
    vec4 velocity_end_radius; // xyz mean velocity, m/s; w: radius at the end of life, m
    vec4 spread_opacity;      // xyz half width of the velocity's spread, m/s; w: opacity
    vec4 albedo_noise;        // rgb: what it scatters; w: share of the billboard's alpha that is noise
    vec4 taken;               // as GpuParticle has it
    vec4 forces;              // x: buoyancy, m/s^2; y: drag, 1/s; z: turbulence, m/s; w: time between births, s
    vec4 wave_phase;          // xyz: phases of the turbulence's waves at the box's centre now; w: age of the newest, s
    uvec4 slots;              // x: first slot, y: slots, z: number of the newest birth mod 2^32, w: its slot
    uvec4 seed;               // x: seed; yzw 0
};

// A particle as the vertex shader pulls it.
struct GpuParticle {
    vec4 position_radius; // render space, m
    vec4 albedo_alpha;    // rgb: what it scatters; w: alpha at the middle of the billboard
    vec4 taken;           // rgb: at alpha 1 it takes this share of the light from behind and shows this share of the fog
                          // before it; w: the mean, for the picture's alpha
    vec4 look;            // x: rotation, rad; y, z: offset into the noise; w: share of noise
};

TYNDALL_INTEROP_END

#endif
