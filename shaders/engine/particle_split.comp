// Sorted keys and the depths of the sorted transparent draws -> one indirect draw for the particles between each two of
// them. Interval 0 lies behind the farthest draw, interval i between draws i - 1 and i, the last one before the nearest.
// A particle at the very depth of a draw is drawn after it.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "engine/particle_key.glsl"

layout(local_size_x_id = 0) in;

layout(set = 0, binding = 0, std430) readonly restrict buffer Keys { uvec2 keys[]; };
layout(set = 0, binding = 1, std430) readonly restrict buffer Splits { float split_depth_m[]; }; // back to front
layout(set = 0, binding = 2, std430) writeonly restrict buffer Draws { uvec4 draws[]; }; // VkDrawIndirectCommand
layout(push_constant) uniform Push {
    uint key_count;
    uint split_count;
};

// How many keys are less than `key`.
uint keys_below(uint key) {
    uint low = 0u;
    uint high = key_count;
    while (low < high) {
        uint middle = (low + high) / 2u;
        if (keys[middle].x < key) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}

uint first_of_interval(uint interval) {
    if (interval == 0u) {
        return 0u;
    }
    return keys_below(interval <= split_count ? particle_depth_key(split_depth_m[interval - 1u]) : particle_not_drawn);
}

void main() {
    uint interval = gl_GlobalInvocationID.x;
    if (interval > split_count) {
        return;
    }
    uint first = first_of_interval(interval);
    uint end = first_of_interval(interval + 1u);
    // Six vertices a particle in one instance: the number of the vertex says which particle it is.
    draws[interval] = uvec4(6u * (end - first), 1u, 6u * first, 0u);
}
