// One direction of a separable blur of the ESM in log space: binomial weights 1 4 6 4 1 over 16, edges clamped.
#version 460
#extension GL_GOOGLE_include_directive : require

layout(local_size_x_id = 0, local_size_y_id = 1, local_size_z_id = 2) in;
layout(constant_id = 3) const bool vertical = false;

layout(set = 0, binding = 0, r32f) uniform readonly restrict image2DArray source;
layout(set = 0, binding = 1, r32f) uniform writeonly restrict image2DArray blurred;

const float weights[5] = float[](0.0625, 0.25, 0.375, 0.25, 0.0625);

void main() {
    ivec3 texel = ivec3(gl_GlobalInvocationID);
    ivec3 size = imageSize(blurred);
    if (any(greaterThanEqual(texel, size))) {
        return;
    }
    // Not `vertical ? a : b`: as a specialization constant of vector type Mesa 22.3 folds it wrongly.
    ivec3 step = ivec3(1, 0, 0);
    if (vertical) {
        step = ivec3(0, 1, 0);
    }
    float logs[5];
    float largest = -1e30;
    for (int i = 0; i < 5; ++i) {
        ivec3 tap = clamp(texel + (i - 2) * step, ivec3(0), size - 1);
        logs[i] = imageLoad(source, tap).r;
        largest = max(largest, logs[i]);
    }
    float sum = 0.0;
    for (int i = 0; i < 5; ++i) {
        sum += weights[i] * exp(logs[i] - largest);
    }
    imageStore(blurred, texel, vec4(largest + log(sum)));
}
