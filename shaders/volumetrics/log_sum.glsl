// Filtering exponential shadow maps by their logarithms: ln sum w_i e^(l_i) = m + ln sum w_i e^(l_i - m), m = max l_i,
// so that every exponent is at most 0; a plain fp32 exponential overflows at 88.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_LOG_SUM_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_LOG_SUM_GLSL

// Weights that sum to 1, at least one of them positive where its logarithm is the largest.
float log_weighted_sum(vec4 logs, vec4 weights) {
    float m = max(max(logs.x, logs.y), max(logs.z, logs.w));
    return m + log(max(dot(weights, exp(logs - m)), 1e-30));
}

#endif
