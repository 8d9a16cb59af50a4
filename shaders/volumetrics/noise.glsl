// One octave of gradient noise (Perlin, "Improving Noise", 2002, with hashed gradients), of period 256 cells.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_NOISE_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_NOISE_GLSL

#include "volumetrics/random.glsl"

// Contribution of one lattice point: its gradient, of components in [-1, 1), along `offset`.
float lattice(ivec3 cell, vec3 offset) {
    uvec3 bits = hash3(uvec3(cell & 255));
    return dot(vec3(ivec3(bits)) * (1.0 / 2147483648.0), offset);
}

// Mean 0, within [-1, 1]; p in cells.
float gradient_noise(vec3 p) {
    vec3 base = floor(p);
    ivec3 c = ivec3(base);
    vec3 f = p - base;
    vec3 w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    float x00 = mix(lattice(c, f), lattice(c + ivec3(1, 0, 0), f - vec3(1, 0, 0)), w.x);
    float x10 = mix(lattice(c + ivec3(0, 1, 0), f - vec3(0, 1, 0)), lattice(c + ivec3(1, 1, 0), f - vec3(1, 1, 0)), w.x);
    float x01 = mix(lattice(c + ivec3(0, 0, 1), f - vec3(0, 0, 1)), lattice(c + ivec3(1, 0, 1), f - vec3(1, 0, 1)), w.x);
    float x11 = mix(lattice(c + ivec3(0, 1, 1), f - vec3(0, 1, 1)), lattice(c + ivec3(1, 1, 1), f - vec3(1, 1, 1)), w.x);
    return clamp(1.25 * mix(mix(x00, x10, w.y), mix(x01, x11, w.y), w.z), -1.0, 1.0);
}

#endif
