// glTF 2.0's metallic-roughness reflection with KHR_materials_specular: Lambert below a GGX microfacet layer.
#ifndef TYNDALL_SHADERS_ENGINE_BRDF_GLSL
#define TYNDALL_SHADERS_ENGINE_BRDF_GLSL

const float inverse_pi = 0.318309886;

// What a point reflects with, view-independent.
struct Reflection {
    vec3 diffuse;        // albedo of the Lambert layer, before what the layer above takes
    vec3 f0;             // reflectance at normal incidence
    float f90;           // at grazing incidence
    vec2 dielectric_f;   // largest component of the dielectric part's reflectance: at normal, at grazing incidence
    float alpha;         // roughness squared
};

// Schlick 1994.
float schlick_weight(float cosine) {
    float m = clamp(1.0 - cosine, 0.0, 1.0);
    float m2 = m * m;
    return m2 * m2 * m;
}

// Outgoing radiance toward `to_eye` for a unit of irradiance on a surface that faces the light, the cosine included.
vec3 reflect_light(Reflection r, vec3 normal, vec3 to_eye, float n_v, vec3 to_light) {
    float n_l = dot(normal, to_light);
    if (n_l <= 0.0) {
        return vec3(0.0);
    }
    vec3 between = to_light + to_eye;
    vec3 half_vector = between * inversesqrt(max(dot(between, between), 1e-12));
    float n_h = clamp(dot(normal, half_vector), 0.0, 1.0);
    float weight = schlick_weight(dot(to_light, half_vector));
    vec3 f = r.f0 + (r.f90 - r.f0) * weight;
    float transmitted = 1.0 - mix(r.dielectric_f.x, r.dielectric_f.y, weight);
    // GGX (Walter et al. 2007); the visibility term is Smith's, height-correlated (Heitz 2014), with the reflection's
    // 1 / (4 n_l n_v) in it.
    float a2 = r.alpha * r.alpha;
    float d = (n_h * a2 - n_h) * n_h + 1.0;
    float visibility =
        0.5 / (n_l * sqrt(n_v * n_v * (1.0 - a2) + a2) + n_v * sqrt(n_l * n_l * (1.0 - a2) + a2));
    float specular = a2 * inverse_pi / (d * d) * visibility;
    return (r.diffuse * (inverse_pi * transmitted) + f * specular) * n_l;
}

// Share of an even surrounding radiance that the microfacet layer sends to the eye is f0 x + f90 y: an analytic fit to
// the split-sum table (Karis, Physically Based Shading on Mobile, 2014, after Lazarov 2013).
vec2 environment_reflection(float roughness, float n_v) {
    vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    float a = min(r.x * r.x, exp2(-9.28 * n_v)) * r.x + r.y;
    return vec2(-1.04, 1.04) * a + r.zw;
}

#endif
