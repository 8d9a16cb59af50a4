// Each number of the input times `scale`, plus `offset`.
#version 460
layout(local_size_x = 64) in;
layout(set = 0, binding = 0, std430) readonly buffer Source { uint source[]; };
layout(set = 0, binding = 1, std430) writeonly buffer Destination { uint destination[]; };
layout(push_constant) uniform Constants { uint scale; uint offset; uint count; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < count) {
        destination[i] = source[i] * scale + offset;
    }
}
