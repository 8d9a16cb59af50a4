// Sorts keys by a bitonic network (Batcher 1968). Three steps of it, chosen by STEP:
//   0  sorts each block of keys in shared memory, even blocks ascending, odd ones descending
//   1  one compare-and-exchange of keys that lie a block or more apart
//   2  the rest of a merge, whose distances are within a block, in shared memory
// A block holds `largest_block` keys, or all if they are fewer; the number of keys is a power of two, at least 2.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "engine/particle_key.glsl"

layout(local_size_x_id = 0) in;
layout(constant_id = 1) const uint largest_block = 2048;

layout(set = 0, binding = 0, std430) restrict buffer Keys { uvec2 keys[]; };
layout(push_constant) uniform Push {
    uint key_count;
    uint sequence; // length of the sorted runs that the merge makes
    uint stride;   // step 1: distance of the two keys
};

#if STEP != 1
shared uvec2 block[largest_block];

void exchange_in_block(uint first, uint pairs, uint run, uint distance) {
    for (uint i = gl_LocalInvocationID.x; i < pairs; i += gl_WorkGroupSize.x) {
        uint a = 2u * i - (i & (distance - 1u));
        uint b = a + distance;
        bool ascending = ((first + a) & run) == 0u;
        uvec2 ka = block[a];
        uvec2 kb = block[b];
        if (particle_precedes(kb, ka) == ascending) {
            block[a] = kb;
            block[b] = ka;
        }
    }
    barrier();
}

void main() {
    uint block_size = min(largest_block, key_count);
    uint first = gl_WorkGroupID.x * block_size;
    for (uint i = gl_LocalInvocationID.x; i < block_size; i += gl_WorkGroupSize.x) {
        block[i] = keys[first + i];
    }
    barrier();
#if STEP == 0
    for (uint run = 2u; run <= block_size; run *= 2u) {
        for (uint distance = run / 2u; distance > 0u; distance /= 2u) {
            exchange_in_block(first, block_size / 2u, run, distance);
        }
    }
#else
    for (uint distance = block_size / 2u; distance > 0u; distance /= 2u) {
        exchange_in_block(first, block_size / 2u, sequence, distance);
    }
#endif
    for (uint i = gl_LocalInvocationID.x; i < block_size; i += gl_WorkGroupSize.x) {
        keys[first + i] = block[i];
    }
}
#else
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= key_count / 2u) {
        return;
    }
    uint a = 2u * i - (i & (stride - 1u));
    uint b = a + stride;
    uvec2 ka = keys[a];
    uvec2 kb = keys[b];
    if (particle_precedes(kb, ka) == ((a & sequence) == 0u)) {
        keys[a] = kb;
        keys[b] = ka;
    }
}
#endif
