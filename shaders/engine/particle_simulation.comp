// Emitters and time -> particles and their sort keys. A particle is a pure function of its emitter, its birth number and
// the time: any time can be drawn, in any order, and two runs agree.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "common/phi1.glsl"
#include "engine/particle_interop.h"
#include "engine/particle_key.glsl"
#include "engine/particle_random.glsl"

layout(local_size_x_id = 0) in;

layout(set = 0, binding = 0, std430) readonly restrict buffer Frame {
    ParticleFrame frame;
    GpuEmitter emitters[];
};
layout(set = 0, binding = 1, std430) writeonly restrict buffer Particles { GpuParticle particles[]; };
layout(set = 0, binding = 2, std430) writeonly restrict buffer Keys { uvec2 keys[]; };

// (x - 1 + e^-x) / x^2, the weight of a constant force under drag; 1/2 at 0. Below 0.5 by its Taylor series (first term
// left out: x^6 / 40320, 4e-7 of it), where the difference cancels.
float phi2(float x) {
    float series = 1.0 / 2.0 -
                   x * (1.0 / 6.0 - x * (1.0 / 24.0 - x * (1.0 / 120.0 - x * (1.0 / 720.0 - x * (1.0 / 5040.0)))));
    return x < 0.5 ? series : (1.0 - phi1(x)) / x;
}

// Displacement (m) since birth, per m/s of turbulence, by a velocity field of three plane waves seen at the place of
// birth. Each wave moves across its direction of travel, so the field has no divergence. `offset` is from the box's centre,
// `phases` are the waves' there and now.
vec3 turbulence(vec3 offset, vec3 phases, float age_s) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 3; ++i) {
        float now = dot(frame.wave_number[i].xyz, offset) + phases[i];
        float then = now - frame.wave_number[i].w * age_s;
        sum += frame.wave_speed[i].xyz * (frame.wave_speed[i].w * (sin(now) - sin(then)));
    }
    return sum;
}

// The emitter that owns a slot: the last one whose first slot is not beyond it.
uint emitter_of(uint slot) {
    uint low = 0u;
    uint high = frame.counts.x;
    while (high - low > 1u) {
        uint middle = (low + high) / 2u;
        if (emitters[middle].slots.x <= slot) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

// The share of full opacity at a fraction of life: in over the first tenth, out over the last half.
float life_fade(float u) {
    return smoothstep(0.0, 0.1, u) * (1.0 - smoothstep(0.5, 1.0, u));
}

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= frame.counts.z) {
        return;
    }
    if (index >= frame.counts.y) {
        keys[index] = uvec2(particle_not_drawn, index);
        return;
    }
    GpuEmitter emitter = emitters[emitter_of(index)];
    uint slot = index - emitter.slots.x;
    uint births_ago = slot <= emitter.slots.w ? emitter.slots.w - slot : emitter.slots.w + emitter.slots.y - slot;
    uint birth = emitter.slots.z - births_ago;
    float age_s = emitter.wave_phase.w + float(births_ago) * emitter.forces.w;
    float life = age_s / emitter.origin_lifetime.w;

    vec4 r0 = particle_random(birth, emitter.seed.x, 0u);
    vec4 r1 = particle_random(birth, emitter.seed.x, 1u);
    vec3 offset = (2.0 * r0.xyz - 1.0) * emitter.box_start_radius.xyz;
    vec3 velocity = emitter.velocity_end_radius.xyz + (2.0 * r1.xyz - 1.0) * emitter.spread_opacity.xyz;
    float drag = emitter.forces.y * age_s;
    vec3 travel = velocity * (age_s * phi1(drag));
    travel.y += emitter.forces.x * age_s * age_s * phi2(drag);
    // Particles born side by side move together but for half a radian.
    travel += emitter.forces.z * turbulence(offset, emitter.wave_phase.xyz + 0.5 * r0.w, age_s);
    vec3 position = emitter.origin_lifetime.xyz + offset + travel;
    float radius = mix(emitter.box_start_radius.w, emitter.velocity_end_radius.w, clamp(life, 0.0, 1.0));

    vec3 view = (frame.view_from_render * vec4(position, 1.0)).xyz;
    float depth_m = -view.z;
    float alpha = life < 1.0 ? emitter.spread_opacity.w * life_fade(life) : 0.0;
    // What comes within its own radius of the near plane fades, so that nothing pops as the camera passes through it.
    alpha *= smoothstep(0.0, 1.0, (depth_m - frame.near_size.x) / (radius + 0.1));

    bool drawn = alpha > 0.0 && radius > 0.0;
    for (int i = 0; i < 4; ++i) {
        drawn = drawn && dot(frame.frustum[i].xyz, view) + frame.frustum[i].w > -radius;
    }
    particles[index].position_radius = vec4(position, radius);
    particles[index].albedo_alpha = vec4(emitter.albedo_noise.rgb, alpha);
    particles[index].taken = emitter.taken;
    particles[index].look = vec4(6.2831853 * r1.w + (r0.w - 0.5) * age_s, 64.0 * r1.xy, emitter.albedo_noise.w);
    keys[index] = uvec2(drawn ? particle_depth_key(depth_m) : particle_not_drawn, index);
}
