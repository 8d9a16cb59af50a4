// Phase functions, per steradian, each of integral 1 over the sphere, and their weighted sum as the pipeline is
// specialised to it. The including file declares the block `u` first and passes its constants from id 9 on.
//
// The angle comes as the squared chords between the direction in which the light travels and the one to the eye, and
// between the former and the latter's opposite: 2 - 2 cos(theta) and 2 + 2 cos(theta). The cosine itself would cancel
// near the peaks of functions that are nearly all forward or backward.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_PHASE_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_PHASE_GLSL

layout(constant_id = 9) const uint phase_lobe_count = 1;
layout(constant_id = 10) const uint phase_lobe_functions = 2; // 4 bits a lobe, the first lowest

// As PhaseFunction of features/volumetrics/phase.hpp.
const uint phase_isotropic = 0u;
const uint phase_rayleigh = 1u;
const uint phase_henyey_greenstein = 2u;
const uint phase_schlick = 3u;
const uint phase_cornette_shanks = 4u;

const float inverse_4_pi = 0.0795774715;

struct PhaseAngle {
    float forward_chord_squared;  // 0: straight on
    float backward_chord_squared; // 0: straight back
};

PhaseAngle phase_angle(vec3 travel, vec3 to_eye) {
    vec3 forward = travel - to_eye;
    vec3 backward = travel + to_eye;
    return PhaseAngle(dot(forward, forward), dot(backward, backward));
}

// The squared chord from the peak's direction.
float chord_from_peak(float g, PhaseAngle angle) {
    return g >= 0.0 ? angle.forward_chord_squared : angle.backward_chord_squared;
}

// Rayleigh 1871, light that is not polarised: 3 / (16 pi) (1 + cos^2).
float rayleigh(PhaseAngle angle) {
    float cosine = 0.25 * (angle.backward_chord_squared - angle.forward_chord_squared);
    return 0.0596831037 * (1.0 + cosine * cosine);
}

// Henyey and Greenstein 1941: (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^1.5). The denominator is (1 - |g|)^2 + |g| chord^2.
float henyey_greenstein(float g, PhaseAngle angle) {
    float a = abs(g);
    float spread = (1.0 - a) * (1.0 - a) + a * chord_from_peak(g, angle);
    return (1.0 - a) * (1.0 + a) / (12.566370614 * spread * sqrt(spread));
}

// Blasi, Le Saec and Schlick 1993: (1 - k^2) / (4 pi (1 - k cos)^2), no root to take. The denominator's term is
// 1 - |k| + |k| chord^2 / 2.
float schlick(float k, PhaseAngle angle) {
    float a = abs(k);
    float spread = 1.0 - a + 0.5 * a * chord_from_peak(k, angle);
    return inverse_4_pi * (1.0 - a) * (1.0 + a) / (spread * spread);
}

// Cornette and Shanks 1992: Henyey-Greenstein times 3 (1 + cos^2) / (2 (2 + g^2)); Rayleigh at g = 0.
float cornette_shanks(float g, PhaseAngle angle) {
    float cosine = 0.25 * (angle.backward_chord_squared - angle.forward_chord_squared);
    return henyey_greenstein(g, angle) * 1.5 * (1.0 + cosine * cosine) / (2.0 + g * g);
}

float phase_of_lobe(uint function, float g, PhaseAngle angle) {
    switch (function) {
    case phase_rayleigh: return rayleigh(angle);
    case phase_henyey_greenstein: return henyey_greenstein(g, angle);
    case phase_schlick: return schlick(g, angle);
    case phase_cornette_shanks: return cornette_shanks(g, angle);
    default: return inverse_4_pi;
    }
}

// Written out, so that what the constants leave out is gone from the pipeline.
float phase_function(PhaseAngle angle) {
    if (phase_lobe_count == 1u) {
        return phase_of_lobe(phase_lobe_functions & 15u, u.phase_asymmetry.x, angle);
    }
    float sum = u.phase_weight.x * phase_of_lobe(phase_lobe_functions & 15u, u.phase_asymmetry.x, angle);
    sum += u.phase_weight.y * phase_of_lobe((phase_lobe_functions >> 4u) & 15u, u.phase_asymmetry.y, angle);
    if (phase_lobe_count > 2u) {
        sum += u.phase_weight.z * phase_of_lobe((phase_lobe_functions >> 8u) & 15u, u.phase_asymmetry.z, angle);
    }
    if (phase_lobe_count > 3u) {
        sum += u.phase_weight.w * phase_of_lobe((phase_lobe_functions >> 12u) & 15u, u.phase_asymmetry.w, angle);
    }
    return sum;
}

#endif
