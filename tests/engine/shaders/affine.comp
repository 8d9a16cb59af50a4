// values[i] = factor * values[i] + summand
#version 460
layout(local_size_x_id = 0) in;
layout(constant_id = 1) const float factor = 0.0;
layout(set = 0, binding = 0, std430) restrict buffer Values { float values[]; };
layout(push_constant) uniform Push {
    float summand;
    uint count;
};

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i < count) {
        values[i] = factor * values[i] + summand;
    }
}
