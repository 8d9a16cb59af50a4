// Fog along the part of a ray that lies beyond the scattering volume's range: homogeneous and height fog, lit by the
// sun without shadow and by the ambient. What emits ends at the range: without extinction its light over an infinite
// path would be infinite.
//
// No branches, only choices between values: a branch on a value made from the fourth or a later uniform block of a
// stage lets lavapipe 22.3.6 write past the end of its table of uniforms worth inlining, and crash.
#ifndef TYNDALL_SHADERS_COMMON_FAR_FIELD_GLSL
#define TYNDALL_SHADERS_COMMON_FAR_FIELD_GLSL

#include "far_field.h"
#include "light_attenuation.glsl"

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

// Where a way of length_m from height y, rising by `climb` per metre, enters and leaves the air between the heights; not
// in order where it misses it. A level way outside never enters.
vec2 part_between_heights(vec2 heights, float y, float climb, float length_m) {
    float away = mix(1e-12, -1e-12, y < heights.x);
    vec2 ends_m = (heights - y) / mix(climb, away, abs(climb) < 1e-12);
    return vec2(max(min(ends_m.x, ends_m.y), 0.0), min(max(ends_m.x, ends_m.y), length_m));
}

// Integral over a piece of optical depth tau of e^-t times the transmittance of the light's own way, whose optical depth
// goes from `light_start` to `light_end`: exact where it changes as the piece's own does, which it does in height fog.
float scattered_light(float tau, float light_start, float light_end) {
    float change = abs(light_end + tau - light_start);
    return tau * exp(-min(light_start, light_end + tau)) * phi1(change);
}

// The path from `start` (view space, m) in direction `slope`, along which view depth grows by 1, over depth_m > 0.
// Source and extinction are those of the froxels. The path has two pieces: what lies within half an optical depth of the
// homogeneous fog and 1.5 scale heights of the other, and the rest. In each the albedo is the mean weighted with optical
// depth. Only what lies between far.heights counts.
FarFog far_fog(FarField far, vec3 start, vec3 slope, float depth_m) {
    float stretch = length(slope);
    vec3 ray = slope / stretch;
    float climb = dot(far.up.xyz, ray);
    float y = dot(far.up.xyz, start);
    vec2 part_m = part_between_heights(far.heights.xy, y, climb, min(depth_m * stretch, 1e30));
    float length_m = max(part_m.y - part_m.x, 0.0);
    y = clamp(y + climb * part_m.x, far.heights.x, far.heights.y);
    float height = y + far.up.w;
    float scale_m = 1.5 / max(far.sun_illuminance.w * abs(climb), 1e-30); // over which the height fog changes
    float near_m = min(length_m, min(0.5 / max(far.homogeneous.w, 1e-30), scale_m));
    vec2 near = vec2(far.homogeneous.w * near_m, far_height_optical_depth(far, height, climb, near_m));
    vec2 all = vec2(far.homogeneous.w * length_m, far_height_optical_depth(far, height, climb, length_m));
    vec2 behind = max(all - near, 0.0);
    float near_tau = near.x + near.y;
    float behind_tau = behind.x + behind.y;
    float near_attenuation = exp(-near_tau);
    float attenuation = exp(-(all.x + all.y));

    vec3 sun_travel = vec3(0.0, dot(far.up.xyz, far.sun_direction.xyz), 0.0);
    vec4 air = vec4(0.0, far.height.w * far.sun_direction.w, far.sun_illuminance.w, far.up.w);
    float sun_start = air_optical_depth_to_sun(air, far.heights.xy, vec3(0.0, y, 0.0), sun_travel);
    float sun_middle = air_optical_depth_to_sun(air, far.heights.xy, vec3(0.0, y + climb * near_m, 0.0), sun_travel);
    float sun_end = air_optical_depth_to_sun(air, far.heights.xy, vec3(0.0, y + climb * length_m, 0.0), sun_travel);
    float phase = phase_of_terms(far.phase, far.sun_direction.xyz, -ray);
    vec3 sun = far.sun_illuminance.rgb * phase;
    vec3 ambient = far.ambient.rgb + far.ambient_x.rgb * ray.x + far.ambient_y.rgb * ray.y + far.ambient_z.rgb * ray.z;

    vec3 near_light = ambient * scattered_part(near_tau, near_attenuation) +
                      sun * scattered_light(near_tau, sun_start, sun_middle);
    vec3 behind_light = ambient * scattered_part(behind_tau, exp(-behind_tau)) +
                        sun * scattered_light(behind_tau, sun_middle, sun_end);
    vec3 radiance = mean_albedo(far, near) * near_light + mean_albedo(far, behind) * near_attenuation * behind_light;
    return FarFog(radiance, attenuation);
}

// The same where each channel has an extinction of its own.
struct ColoredFarFog {
    vec3 radiance;
    vec3 transmittance;
};

FarFog far_fog_of_channel(FarField far, vec2 color, vec3 start, vec3 slope, float depth_m) {
    far.homogeneous.w *= color.x;
    far.height.w *= color.y;
    return far_fog(far, start, slope, depth_m);
}

ColoredFarFog colored_far_fog(FarField far, vec3 start, vec3 slope, float depth_m) {
    vec3 even = far.homogeneous_color.rgb;
    vec3 low = far.height_color.rgb;
    FarFog r = far_fog_of_channel(far, vec2(even.r, low.r), start, slope, depth_m);
    FarFog g = far_fog_of_channel(far, vec2(even.g, low.g), start, slope, depth_m);
    FarFog b = far_fog_of_channel(far, vec2(even.b, low.b), start, slope, depth_m);
    return ColoredFarFog(vec3(r.radiance.r, g.radiance.g, b.radiance.b),
                         vec3(r.transmittance, g.transmittance, b.transmittance));
}

#endif
