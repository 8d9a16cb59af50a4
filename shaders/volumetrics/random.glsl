// Integer hashing for jitter offsets and lattice gradients.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_RANDOM_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_RANDOM_GLSL

// PCG-3D of Jarzynski and Olano, "Hash Functions for GPU Rendering", 2020.
uvec3 hash3(uvec3 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

// In [0, 1).
vec3 unit_floats(uvec3 bits) { return vec3(bits >> 8u) * (1.0 / 16777216.0); }

#endif
