// Soft spheres of fog in a slice of the ray, by their exact mean over it: what is thinner than the slice keeps its
// optical depth.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_FOG_PARTICLE_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_FOG_PARTICLE_GLSL

#include "fog_particle.h"

// Mean of (1 - (d / radius)^2)^2, 0 beyond the radius, over `length_m` of a ray of unit direction, `to_centre` leading
// from its beginning to the sphere's centre. In radii from the point of the ray nearest to the centre the profile is
// (inside - s^2)^2, a polynomial for which three nodes of Gauss-Legendre are exact; unlike its antiderivative they lose
// no digits where the way is short.
float mean_fog_particle_weight(vec3 to_centre, float radius_m, vec3 direction, float length_m) {
    float nearest_m = dot(to_centre, direction);
    vec3 offset = (to_centre - nearest_m * direction) / radius_m;
    float inside = 1.0 - dot(offset, offset);
    if (inside <= 0.0) {
        return 0.0;
    }
    float reach = sqrt(inside);
    float enter = max(-nearest_m / radius_m, -reach);
    float leave = min((length_m - nearest_m) / radius_m, reach);
    if (leave <= enter) {
        return 0.0;
    }
    float middle = 0.5 * (enter + leave);
    float node = 0.387298335 * (leave - enter);
    vec3 s = vec3(middle - node, middle, middle + node);
    vec3 root = max(inside - s * s, 0.0);
    return dot(root * root, vec3(5.0, 8.0, 5.0) / 18.0) * (leave - enter) * radius_m / length_m;
}

#endif
