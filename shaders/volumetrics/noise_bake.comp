// A volume of noise that repeats in every direction, two texels of fp16 an invocation. Made once.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "common/noise.glsl"
#include "volumetrics/noise_quantiles.h"

layout(local_size_x_id = 0, local_size_y_id = 1, local_size_z_id = 2) in;
layout(constant_id = 3) const uint size = 128u;        // texels of a side
layout(constant_id = 4) const bool is_detail = false; // else the shape

layout(set = 0, binding = 0) writeonly restrict buffer Texels { uint texels[]; }; // x fastest, then y, then z

const int last = TYNDALL_NOISE_QUANTILE_COUNT - 1;
const float ranks[] = float[](TYNDALL_NOISE_RANKS);
const float shape_quantiles[] = float[](TYNDALL_SHAPE_QUANTILES);
const float detail_quantiles[] = float[](TYNDALL_DETAIL_QUANTILES);

// 1 less the distance, at most 1, to the nearest of the points of which each cell has one (Worley 1996). p in cells.
float worley_noise(vec3 p, uint mask, uint seed) {
    vec3 base = floor(p);
    vec3 inside = p - base;
    float nearest_squared = 1.0;
    [[dont_unroll]] for (int i = 0; i < 27; ++i) {
        ivec3 step = ivec3(i % 3, i / 3 % 3, i / 9) - 1;
        uvec3 words = (uvec3(ivec3(base) + step) & mask) * uvec3(0x8da6b343u, 0xd8163841u, 0xcb1ab31fu);
        uint hash = lattice_hash(words.x ^ seed, words.y, words.z);
        vec3 bits = vec3(uvec3(hash, hash >> 10u, hash >> 20u) & 1023u);
        vec3 offset = vec3(step) - inside + (bits + 0.5) * (1.0 / 1024.0);
        nearest_squared = min(nearest_squared, dot(offset, offset));
    }
    return 1.0 - sqrt(nearest_squared);
}

// Perlin noise dilated by Worley noise (Schneider and Vos 2015). p in periods.
float raw_shape(vec3 p) {
    float perlin = 0.0;
    float worley = 0.0;
    float weight = 4.0;
    [[dont_unroll]] for (uint octave = 0u; octave < 3u; ++octave) {
        uint cells = 4u << octave;
        perlin += weight * tiled_gradient_noise(p * float(cells), cells - 1u, 1u + octave);
        worley += (octave == 0u ? 5.0 : weight) * worley_noise(p * float(cells), cells - 1u, 4u + octave);
        weight *= 0.5;
    }
    worley *= 0.125;
    return worley + (1.0 - worley) * (0.5 + perlin * (0.5 / 7.0));
}

float raw_detail(vec3 p) {
    return (2.0 * worley_noise(p * 4.0, 3u, 7u) + worley_noise(p * 8.0, 7u, 8u)) * (1.0 / 3.0);
}

// The part of all texels below this value, so that the volume's values are uniform on [0, 1].
float rank_of(float value) {
    float rank = 0.0;
    for (int i = 0; i < last; ++i) {
        float low = is_detail ? detail_quantiles[i] : shape_quantiles[i];
        float high = is_detail ? detail_quantiles[i + 1] : shape_quantiles[i + 1];
        rank += (ranks[i + 1] - ranks[i]) * clamp((value - low) / (high - low), 0.0, 1.0);
    }
    return rank;
}

float noise_at(uvec3 texel) {
    vec3 p = (vec3(texel) + 0.5) / float(size);
    return rank_of(is_detail ? raw_detail(p) : raw_shape(p));
}

void main() {
    uvec3 pair = gl_GlobalInvocationID;
    if (any(greaterThanEqual(pair, uvec3(size / 2u, size, size)))) {
        return;
    }
    uvec3 texel = uvec3(2u * pair.x, pair.yz);
    texels[(pair.z * size + pair.y) * (size / 2u) + pair.x] =
        packHalf2x16(vec2(noise_at(texel), noise_at(texel + uvec3(1u, 0u, 0u))));
}
