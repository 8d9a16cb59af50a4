// Cascade depth (0 at the light, 1 at the far end) -> ln of the mean of e^(k z) over the texels that an ESM texel covers.
// One array layer a cascade: an atlas would bleed across its seams. Wronski 2014, in log space.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "volumetrics/interop.h"

layout(local_size_x_id = 0, local_size_y_id = 1, local_size_z_id = 2) in;

layout(set = 0, binding = 0) uniform Parameters { VolumetricParameters u; };
layout(set = 0, binding = 1) uniform sampler2DArray cascades; // nearest, clamps
layout(set = 0, binding = 2, r32f) uniform writeonly restrict image2DArray esm;

void main() {
    ivec3 texel = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(texel, imageSize(esm)))) {
        return;
    }
    // The footprint in source texels, rounded up to whole gathers of 2 x 2.
    float ratio = u.esm_size.z * u.esm_size.y;
    vec2 first = floor(vec2(texel.xy) * ratio);
    int gathers = int(ceil(ratio * 0.5));
    float k = u.esm_exponents[texel.z];

    // A running largest term and a sum relative to it: each depth is read once.
    float largest = 0.0;
    vec4 sum = vec4(0.0);
    for (int y = 0; y < gathers; ++y) {
        for (int x = 0; x < gathers; ++x) {
            vec2 corner = (first + 2.0 * vec2(x, y) + 1.0) * u.esm_size.w; // shared by four texels
            vec4 z = clamp(textureGather(cascades, vec3(corner, texel.z)), 0.0, 1.0);
            float m = max(largest, max(max(z.x, z.y), max(z.z, z.w)));
            sum = sum * exp(k * (largest - m)) + exp(k * (z - m));
            largest = m;
        }
    }
    float mean = dot(sum, vec4(1.0)) / float(4 * gathers * gathers);
    imageStore(esm, texel, vec4(k * largest + log(mean)));
}
