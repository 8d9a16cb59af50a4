// Weights of one slice of fog. The schemes differ in what they make of the source within the slice; optical depth and
// transmittance at its ends are the same in all: tau += x, T *= e^-x.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_INTEGRATORS_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_INTEGRATORS_GLSL

#include "common/phi1.glsl"

// As Integrator of features/volumetrics/lighting_settings.hpp.
const uint euler = 0u;
const uint half_slice = 1u;
const uint exponential = 2u;
const uint exponential_quadratic = 3u;

// A slice of optical depth x: e^-x, and the mean over the slice of the transmittance since its near side.
struct Attenuation {
    float across;
    float mean; // phi1(x)
};

// Where phi1 is a series, e^-x is taken from it: the steps of a march are then rounded, not biased as some processors'
// exp is, and the weights of the march add up to 1 less the transmittance that is left.
Attenuation attenuation_of(float x) {
    float across = exp(-x);
    float mean = phi1(x, across);
    return Attenuation(x < 0.25 ? 1.0 - x * mean : across, mean);
}

// That mean as the scheme sees it. Only phi1 is a convex weight: x times it is at most 1.
float mean_transmittance(uint scheme, float x, Attenuation attenuation) {
    if (scheme == euler) {
        return 1.0;
    }
    return scheme == half_slice ? exp(-0.5 * x) : attenuation.mean;
}

// A slice as a point of the parabola.
struct SliceNode {
    vec3 source;      // radiance gained per metre, times density_scale
    float extinction; // mean over the slice, 1/m, times density_scale
    float x;          // optical depth of the slice
    float middle;     // and from its near side to the middle of its length
};

// Optical depth from a slice's near side to its middle: half of it, less what a linear change of density moves beyond
// the middle. `before` and `after` are the neighbours' densities, each slice is `ratio` times as long as the one before.
// Off by the fourth power of the length; at least an eighth of x and at most seven.
float optical_depth_of_middle(float before, float here, float after, float ratio, float dt) {
    float to_before = 0.5 * (1.0 + 1.0 / ratio); // distances of the middles, in lengths of the slice
    float to_after = 0.5 * (1.0 + ratio);
    float change = ((here - before) * (to_after / to_before) + (after - here) * (to_before / to_after)) /
                   (to_before + to_after);
    return dt * (0.5 * here - 0.125 * clamp(change, -3.0 * here, 3.0 * here));
}

// First two moments of optical depth t in [0, x] under the weight e^-t, normalised: 1 - B and 2 (1 - B) - x B with
// Bernoulli's B = x / (e^x - 1); below 1 by series, whose first terms left out are 4e-8 of the sum.
vec2 attenuated_moments(float x, float attenuation) {
    if (x < 1.0) {
        float s = x * x;
        float first = 0.5 - x * (1.0 / 12.0 - s * (1.0 / 720.0 - s * (1.0 / 30240.0 - s * (1.0 / 1209600.0))));
        float even = 1.0 / 3.0 + s * (1.0 / 360.0 - s * (1.0 / 15120.0 - s * (1.0 / 604800.0)));
        float odd = 1.0 / 12.0 - s * (1.0 / 720.0 - s * (1.0 / 30240.0 - s * (1.0 / 1209600.0)));
        return vec2(x * first, s * (even - x * odd));
    }
    float b = x * attenuation / (1.0 - attenuation);
    return vec2(1.0 - b, 2.0 - (2.0 + x) * b);
}

// The source function j / sigma_t of a neighbour, or `here`'s own where the density changes more than fourfold between
// them: no parabola fits an edge, and beside emission in thin air the quotient has no bound.
vec3 source_function(SliceNode node, SliceNode here, vec3 own) {
    bool smooth_density = node.extinction <= 4.0 * here.extinction && here.extinction <= 4.0 * node.extinction;
    return smooth_density ? node.source / node.extinction : own;
}

// Mean radiance gained per metre over a slice under the weight e^-t, from the parabola in optical depth t, measured from
// the slice's near side, through the source functions at three middles: `here`'s, `first`'s at t = a and `last`'s at
// t = c. Limited to the span of the three, so that the march stays a convex combination of sources. In air too thin to
// divide by, the source at the middle.
vec3 mean_source(SliceNode here, SliceNode first, float a, SliceNode last, float c, float attenuation) {
    if (here.x < 1e-12) {
        return here.source;
    }
    vec3 s = here.source / here.extinction;
    vec3 s_first = source_function(first, here, s);
    vec3 s_last = source_function(last, here, s);
    float b = here.middle;
    vec2 moment = attenuated_moments(here.x, attenuation);
    vec3 slope = (s - s_first) / (b - a);
    vec3 bend = ((s_last - s) / (c - b) - slope) / (c - a);
    vec3 mean = s + (moment.x - b) * slope + (moment.y - (a + b) * moment.x + a * b) * bend;
    vec3 low = min(s, min(s_first, s_last));
    vec3 high = max(s, max(s_first, s_last));
    return clamp(mean, low, high) * here.extinction;
}

#endif
