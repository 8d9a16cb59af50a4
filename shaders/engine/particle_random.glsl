// Random numbers of a particle: a pure function of its emitter's seed and its birth number.
#ifndef TYNDALL_SHADERS_ENGINE_PARTICLE_RANDOM_GLSL
#define TYNDALL_SHADERS_ENGINE_PARTICLE_RANDOM_GLSL

// PCG-4D of Jarzynski and Olano, "Hash Functions for GPU Rendering", 2020.
uvec4 particle_hash(uvec4 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> 16u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

// Four numbers in [0, 1), exact in fp32. Each `set` gives others.
vec4 particle_random(uint birth, uint seed, uint set) {
    return vec4(particle_hash(uvec4(birth, seed, set, 0u)) >> 8u) * (1.0 / 16777216.0);
}

#endif
