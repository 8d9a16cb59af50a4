// Sort keys of particles: ascending keys are back to front, ties by slot, those not drawn last.
#ifndef TYNDALL_SHADERS_ENGINE_PARTICLE_KEY_GLSL
#define TYNDALL_SHADERS_ENGINE_PARTICLE_KEY_GLSL

const uint particle_not_drawn = 0xffffffffu;

// A larger depth gives a smaller key; any finite depth, negative ones too. -0 counts as 0.
uint particle_depth_key(float depth_m) {
    uint bits = depth_m == 0.0 ? 0u : floatBitsToUint(depth_m);
    uint ascending = (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
    return ~ascending;
}

// Whether `a` is drawn before `b`; x: key, y: slot.
bool particle_precedes(uvec2 a, uvec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }

#endif
