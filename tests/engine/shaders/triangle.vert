// The half of the image that lies above and left of the diagonal from bottom left to top right, at a depth.
#version 460
layout(push_constant) uniform Push { float depth; };

void main() {
    const vec2 corners[3] = vec2[3](vec2(-1.0, -1.0), vec2(-1.0, 1.0), vec2(1.0, -1.0));
    gl_Position = vec4(corners[gl_VertexIndex], depth, 1.0);
}
