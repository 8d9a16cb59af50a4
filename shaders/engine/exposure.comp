// From sums of log luminance to the exposure: the second half of automatic exposure. One invocation.
#version 460

layout(local_size_x = 1) in;

layout(set = 0, binding = 0, std430) readonly restrict buffer Sums { vec2 sums[]; };
layout(set = 0, binding = 1, std430) writeonly restrict buffer Exposure { vec4 exposure; };
layout(push_constant) uniform Push {
    uint partials;
    float key;      // what the mean is exposed to
    float fallback; // exposure of an image that is black
};

void main() {
    vec2 total = vec2(0.0);
    for (uint i = 0u; i < partials; ++i) {
        total += sums[i];
    }
    // Reinhard et al., Photographic Tone Reproduction for Digital Images, 2002, equation 1.
    float mean = exp2(total.x / max(total.y, 1.0));
    exposure = vec4(total.y > 0.0 ? key / mean : fallback, mean, total.y, 0.0);
}
