// Writes (x, y, base.z, base.w) into each texel.
#version 460
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, rgba32f) writeonly uniform image2D destination;
layout(push_constant) uniform Constants { vec4 base; };

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (all(lessThan(at, imageSize(destination)))) {
        imageStore(destination, at, vec4(vec2(at) + base.xy, base.zw));
    }
}
