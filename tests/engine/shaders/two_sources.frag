// A colour, and as second source the weights of what is there already.
#version 460
layout(constant_id = 0) const float red = 0.0;
layout(constant_id = 1) const float green = 0.0;
layout(constant_id = 2) const float weight = 0.0;
layout(location = 0, index = 0) out vec4 color;
layout(location = 0, index = 1) out vec4 weights;

void main() {
    color = vec4(red, green, 0.0, 1.0);
    weights = vec4(weight);
}
