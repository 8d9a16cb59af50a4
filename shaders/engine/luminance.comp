// Sums of log luminance over a fixed grid of pixels, one sum an invocation: the first half of automatic exposure. The
// order of summation is fixed, so that the same image gives the same bits.
#version 460

layout(local_size_x = 64) in;

layout(set = 0, binding = 0) uniform sampler2D scene_color; // texels are fetched
layout(set = 0, binding = 1, std430) writeonly restrict buffer Sums { vec2 sums[]; };
layout(push_constant) uniform Push {
    uvec2 grid;    // samples in x and y
    uint step;     // pixels between samples
    uint partials; // sums
};

void main() {
    uint index = gl_GlobalInvocationID.x;
    vec2 sum = vec2(0.0);
    for (uint i = index; i < grid.x * grid.y; i += partials) {
        ivec2 pixel = min(ivec2(uvec2(i % grid.x, i / grid.x) * step + step / 2u), textureSize(scene_color, 0) - 1);
        float luminance = dot(texelFetch(scene_color, pixel, 0).rgb, vec3(0.2126, 0.7152, 0.0722));
        // Black says nothing about the light in the scene, and what is not a number nothing at all.
        if (luminance > 1e-6 && luminance < 1e30) {
            sum += vec2(log2(luminance), 1.0);
        }
    }
    if (index < partials) {
        sums[index] = sum;
    }
}
