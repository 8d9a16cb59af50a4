// One octave of gradient noise (Perlin, "Improving Noise", 2002, with hashed gradients).
#ifndef TYNDALL_SHADERS_COMMON_NOISE_GLSL
#define TYNDALL_SHADERS_COMMON_NOISE_GLSL

// One word of hash per lattice point from words per axis: three multiplications, where a hash of three words needs nine.
uint lattice_hash(uint x, uint y, uint z) {
    uint h = x ^ y ^ z;
    h ^= h >> 15u;
    h *= 0x2c1b3c6du;
    h ^= h >> 12u;
    return h;
}

// Contribution of one lattice point: its gradient, of components in (-1, 1), along `offset`.
float lattice(uint hash, float x, float y, float z) {
    vec3 gradient = vec3(ivec3(hash & 1023u, (hash >> 10u) & 1023u, (hash >> 20u) & 1023u)) * (1.0 / 512.0) - (1023.0 / 1024.0);
    return gradient.x * x + gradient.y * y + gradient.z * z;
}

// Mean 0, within [-1, 1]; p in cells; of period mask + 1 cells, a power of two.
float tiled_gradient_noise(vec3 p, uint mask, uint seed) {
    vec3 base = floor(p);
    vec3 a = p - base;
    vec3 b = a - 1.0;
    uvec3 cell = uvec3(ivec3(base));
    uvec3 h0 = (cell & mask) * uvec3(0x8da6b343u, 0xd8163841u, 0xcb1ab31fu) ^ uvec3(seed, 0u, 0u);
    uvec3 h1 = ((cell + 1u) & mask) * uvec3(0x8da6b343u, 0xd8163841u, 0xcb1ab31fu) ^ uvec3(seed, 0u, 0u);
    vec3 w = a * a * a * (a * (a * 6.0 - 15.0) + 10.0);
    float x00 = mix(lattice(lattice_hash(h0.x, h0.y, h0.z), a.x, a.y, a.z),
                    lattice(lattice_hash(h1.x, h0.y, h0.z), b.x, a.y, a.z), w.x);
    float x10 = mix(lattice(lattice_hash(h0.x, h1.y, h0.z), a.x, b.y, a.z),
                    lattice(lattice_hash(h1.x, h1.y, h0.z), b.x, b.y, a.z), w.x);
    float x01 = mix(lattice(lattice_hash(h0.x, h0.y, h1.z), a.x, a.y, b.z),
                    lattice(lattice_hash(h1.x, h0.y, h1.z), b.x, a.y, b.z), w.x);
    float x11 = mix(lattice(lattice_hash(h0.x, h1.y, h1.z), a.x, b.y, b.z),
                    lattice(lattice_hash(h1.x, h1.y, h1.z), b.x, b.y, b.z), w.x);
    return clamp(1.25 * mix(mix(x00, x10, w.y), mix(x01, x11, w.y), w.z), -1.0, 1.0);
}

// Of period 256 cells.
float gradient_noise(vec3 p) { return tiled_gradient_noise(p, 255u, 0u); }

// What density is multiplied by: the octaves of DensityNoise, features/volumetrics/density_noise.hpp, the first of this amplitude,
// each next one's `gain` times that; p in cells. Faded where a sample stands for so many `cells` that they do not show.
float octave_noise(vec3 p, float cells, float amplitude, float gain, uint octaves) {
    float factor = 1.0;
    for (uint octave = 0u; octave < octaves && cells < 1.0; ++octave) {
        factor += amplitude * clamp(2.0 - 2.0 * cells, 0.0, 1.0) * gradient_noise(p);
        amplitude *= gain;
        cells *= 2.0;
        p = 2.0 * p + vec3(17.375, 5.625, 11.125);
    }
    return factor;
}

#endif
