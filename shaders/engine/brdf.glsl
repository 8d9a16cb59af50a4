// glTF 2.0's metallic-roughness reflection with KHR_materials_specular: Lambert below a GGX microfacet layer.
#ifndef TYNDALL_SHADERS_ENGINE_BRDF_GLSL
#define TYNDALL_SHADERS_ENGINE_BRDF_GLSL

const float pi = 3.14159265;
const float inverse_pi = 0.318309886;

// What a point reflects with, seen from the eye.
struct Reflection {
    vec3 diffuse;     // albedo of the Lambert layer over pi, before what the layer above takes
    vec3 f0;          // reflectance at normal incidence
    vec3 f_rise;      // what grazing incidence adds to it
    vec2 transmitted; // x + y weight: what the dielectric layer lets through at Schlick's weight
    float a2;         // roughness^4
    float n_v;        // cosine toward the eye, above 0
    float smith_v;    // of the eye's direction
};

// Smith's height-correlated term for one direction (Heitz 2014).
float smith(float cosine, float a2) { return sqrt(cosine * cosine * (1.0 - a2) + a2); }

// Outgoing radiance toward `to_eye` for a unit of irradiance on a surface that faces the light, the cosine n_l > 0
// included. GGX (Walter et al. 2007) and Schlick 1994 by the length q^(1/2) of `to_light + to_eye`, which is not
// normalised: n_h = (n_l + n_v) / q^(1/2), l_h = q^(1/2) / 2.
vec3 reflect_light(Reflection r, vec3 to_eye, vec3 to_light, float n_l) {
    float q = max(2.0 + 2.0 * dot(to_light, to_eye), 1e-6);
    float m = max(1.0 - 0.5 * sqrt(q), 0.0);
    float m2 = m * m;
    float weight = m2 * m2 * m;
    float n_sum = n_l + r.n_v;
    float d = max(q - n_sum * n_sum * (1.0 - r.a2), q * r.a2); // q times GGX's (n_h^2 (a2 - 1) + 1)
    float visibility = n_l * r.smith_v + r.n_v * smith(n_l, r.a2);
    float specular = 0.5 * inverse_pi * r.a2 * q * q / (d * d * visibility);
    return (r.diffuse * (r.transmitted.x + r.transmitted.y * weight) + (r.f0 + r.f_rise * weight) * specular) * n_l;
}

// Share of an even surrounding radiance that the microfacet layer sends to the eye is f0 x + f90 y: an analytic fit to
// the split-sum table (Karis, Physically Based Shading on Mobile, 2014, after Lazarov 2013).
vec2 environment_reflection(float roughness, float n_v) {
    vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    float a = min(r.x * r.x, exp2(-9.28 * n_v)) * r.x + r.y;
    return vec2(-1.04, 1.04) * a + r.zw;
}

#endif
