// phi1(x) = (1 - e^-x) / x, the weight of a constant source over a slice of optical depth x; phi1(0) = 1.
#ifndef TYNDALL_SHADERS_COMMON_PHI1_GLSL
#define TYNDALL_SHADERS_COMMON_PHI1_GLSL

// Below 0.25 by its Taylor series (first term left out: x^6 / 5040, 5e-8 of the value), where 1 - e^-x cancels.
// `attenuation` is e^-x, for callers that have it.
float phi1(float x, float attenuation) {
    float series =
        1.0 - x * (1.0 / 2.0 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x * (1.0 / 120.0 - x * (1.0 / 720.0)))));
    return mix((1.0 - attenuation) / x, series, abs(x) < 0.25);
}

vec3 phi1(vec3 x, vec3 attenuation) {
    return vec3(phi1(x.r, attenuation.r), phi1(x.g, attenuation.g), phi1(x.b, attenuation.b));
}

float phi1(float x) { return phi1(x, exp(-x)); }

#endif
