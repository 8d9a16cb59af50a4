// Fog along the part of a ray that lies beyond the scattering volume's range: homogeneous and height fog, lit by the
// sun without shadow and by the ambient. What emits ends at the range: without extinction its light over an infinite
// path would be infinite.
//
// No branches, only choices between values: a branch on a value made from the fourth or a later uniform block of a
// stage lets lavapipe 22.3.6 write past the end of its table of uniforms worth inlining, and crash.
#ifndef TYNDALL_SHADERS_COMMON_FAR_FIELD_GLSL
#define TYNDALL_SHADERS_COMMON_FAR_FIELD_GLSL

#include "far_field.h"
#include "height_density.glsl"

struct FarFog {
    vec3 radiance; // toward the eye, at the beginning of the path
    float transmittance;
};

// Per steradian, for light that travels along `travel` and is seen from `to_eye`.
float phase_of_terms(PhaseTerms terms, vec3 travel, vec3 to_eye) {
    vec3 difference = travel - to_eye;
    vec3 sum = travel + to_eye;
    float forward = dot(difference, difference);
    float backward = dot(sum, sum);
    float cosine = 0.25 * (backward - forward);
    // At least 1e-6 for every phase function; 0 only where all terms are, as in a volume with nothing beyond it.
    vec4 s = max(terms.spread + terms.forward * forward + terms.backward * backward, 1e-12);
    vec4 root = 1.0 / sqrt(s);
    vec4 peaks = root * root * root * mix(vec4(1.0), root, terms.steep);
    return dot(terms.constant + terms.squared * (cosine * cosine), peaks);
}

// Optical depth of height fog from height a (m above the base), rising by `climb` per metre, over length_m.
float far_height_optical_depth(FarField far, float a, float climb, float length_m) {
    float falloff = far.sun_illuminance.w;
    // Nothing is left of the fog above 80 scale heights, and fp32 resolves the path below them.
    float end_m = max(80.0 - falloff * a, 0.0) / max(falloff * climb, 1e-30);
    length_m = mix(length_m, min(length_m, end_m), climb > 0.0);
    return far.height.w * length_m * mean_height_density(a, a + climb * length_m, falloff);
}

// 1 - e^-tau.
float scattered_part(float tau, float attenuation) {
    return mix(1.0 - attenuation, tau * phi1(tau, attenuation), tau < 0.25);
}

// Of a piece with these optical depths of the homogeneous and the height fog.
vec3 mean_albedo(FarField far, vec2 taus) {
    return mix(far.homogeneous.rgb, far.height.rgb, taus.y / max(taus.x + taus.y, 1e-30));
}

// The path from `start` (view space, m) in direction `slope`, along which view depth grows by 1, over depth_m > 0.
// Source and extinction are those of the froxels: L = J (1 - e^-tau), J constant along the path. Where the two fogs'
// albedos differ, J takes their mean weighted with optical depth over half an optical depth of the homogeneous fog, and
// that of the rest behind it.
FarFog far_fog(FarField far, vec3 start, vec3 slope, float depth_m) {
    float stretch = length(slope);
    vec3 ray = slope / stretch;
    float length_m = min(depth_m * stretch, 1e30);
    float height = dot(far.up.xyz, start) + far.up.w;
    float climb = dot(far.up.xyz, ray);
    float near_m = min(length_m, 0.5 / max(far.homogeneous.w, 1e-30));
    vec2 near = vec2(far.homogeneous.w * near_m, far_height_optical_depth(far, height, climb, near_m));
    vec2 all = vec2(far.homogeneous.w * length_m, far_height_optical_depth(far, height, climb, length_m));
    vec2 behind = max(all - near, 0.0);
    float tau = all.x + all.y;
    float phase = phase_of_terms(far.phase, far.sun_direction.xyz, -ray);
    vec3 directed = far.ambient_x.rgb * ray.x + far.ambient_y.rgb * ray.y + far.ambient_z.rgb * ray.z;
    vec3 arriving = far.ambient.rgb + directed + far.sun_illuminance.rgb * phase;
    float attenuation = exp(-tau);
    float near_tau = near.x + near.y;
    float near_attenuation = exp(-near_tau);
    float scattered = scattered_part(tau, attenuation);
    float scattered_near = min(scattered_part(near_tau, near_attenuation), scattered);
    vec3 albedo = mean_albedo(far, near) * scattered_near + mean_albedo(far, behind) * (scattered - scattered_near);
    return FarFog(albedo * arriving, attenuation);
}

#endif
