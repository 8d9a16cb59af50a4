// A binding of every kind that a compute shader has, and one that no code touches.
#version 460
layout(local_size_x = 1) in;
layout(set = 0, binding = 0, std140) uniform Parameters { vec4 parameters; };
layout(set = 0, binding = 1, std430) buffer Both { uint both[]; };
layout(set = 0, binding = 2, std430) buffer Partly { readonly uint read_only; uint read_and_written; };
layout(set = 0, binding = 3, std430) buffer Piecewise { readonly uint first; readonly uint second; };
layout(set = 0, binding = 4, std430) readonly buffer Untouched { uint untouched[]; };
layout(set = 0, binding = 5, r32ui) uniform uimage2D counters;
layout(set = 0, binding = 6, rgba32f) readonly uniform image3D volumes[2];
layout(set = 0, binding = 7) uniform texture2D separate_texture;
layout(set = 0, binding = 8) uniform sampler separate_sampler;
layout(set = 0, binding = 9) uniform samplerBuffer texels;
layout(set = 0, binding = 10, rgba32f) writeonly uniform imageBuffer storage_texels;
layout(set = 1, binding = 0) uniform sampler2D maps[3];

float of_map(sampler2D map) {
    return texture(map, vec2(0.5)).x;
}

void main() {
    both[0] += both.length() + read_only + first + second;
    read_and_written = imageAtomicAdd(counters, ivec2(0), 1);
    vec4 sum = parameters + imageLoad(volumes[1], ivec3(0)) + texelFetch(texels, 0) + of_map(maps[2]);
    imageStore(storage_texels, 0, sum + texture(sampler2D(separate_texture, separate_sampler), vec2(0.5)));
}
