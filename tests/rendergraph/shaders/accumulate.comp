// The source texel, or nothing if it is not valid, plus `increment`.
#version 460
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform sampler2D source;
layout(set = 0, binding = 1, rgba32f) writeonly uniform image2D destination;
layout(push_constant) uniform Constants { vec4 increment; uint valid; };

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (all(lessThan(at, imageSize(destination)))) {
        vec4 before = valid != 0 ? texelFetch(source, at, 0) : vec4(0.0);
        imageStore(destination, at, before + increment);
    }
}
