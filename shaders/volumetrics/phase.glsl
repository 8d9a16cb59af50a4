// The weighted sum of phase functions as the pipeline is specialised to it. The including file declares the block `u` first and passes its constants from id 9 on.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_PHASE_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_PHASE_GLSL

#include "common/phase_functions.glsl"

layout(constant_id = 9) const uint phase_lobe_count = 1;
layout(constant_id = 10) const uint phase_lobe_functions = 2; // 4 bits a lobe, the first lowest

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
