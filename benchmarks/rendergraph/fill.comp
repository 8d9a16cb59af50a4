// Something for a pass to dispatch. What it writes is never looked at.
#version 460
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, rgba16f) writeonly uniform image2D destination;

void main() {
    imageStore(destination, ivec2(gl_GlobalInvocationID.xy), vec4(1.0));
}
