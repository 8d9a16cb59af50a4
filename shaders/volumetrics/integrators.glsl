// Weights of one slice of fog. The schemes differ in what they make of the source within the slice; optical depth and
// transmittance at its ends are the same in all: tau += x, T *= e^-x.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_INTEGRATORS_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_INTEGRATORS_GLSL

#include "common/phi1.glsl"

// Optical depth, extinction and transmittance: one value, or with COLORED 1 one a channel.
#if COLORED
#define SPECTRUM vec3
#else
#define SPECTRUM float
#endif

float choose(bool condition, float yes, float no) { return condition ? yes : no; }
vec3 choose(bvec3 condition, vec3 yes, vec3 no) { return mix(no, yes, condition); }
vec3 choose(bool condition, vec3 yes, vec3 no) { return condition ? yes : no; }
bool is_below(float x, float limit) { return x < limit; }
bvec3 is_below(vec3 x, float limit) { return lessThan(x, vec3(limit)); }

// As Integrator of features/volumetrics/lighting_settings.hpp.
const uint euler = 0u;
const uint half_slice = 1u;
const uint exponential = 2u;
const uint exponential_quadratic = 3u;

// A slice of optical depth x: e^-x, and the mean over the slice of the transmittance since its near side.
struct Attenuation {
    SPECTRUM across;
    SPECTRUM mean; // phi1(x)
};

// Where phi1 is a series, e^-x is taken from it: the steps of a march are then rounded, not biased as some processors'
// exp is, and the weights of the march add up to 1 less the transmittance that is left.
Attenuation attenuation_of(SPECTRUM x) {
    SPECTRUM across = exp(-x);
    SPECTRUM mean = phi1(x, across);
    return Attenuation(choose(is_below(x, 0.25), 1.0 - x * mean, across), mean);
}

// That mean as the scheme sees it. Only phi1 is a convex weight: x times it is at most 1.
SPECTRUM mean_transmittance(uint scheme, SPECTRUM x, Attenuation attenuation) {
    if (scheme == euler) {
        return SPECTRUM(1.0);
    }
    return scheme == half_slice ? exp(-0.5 * x) : attenuation.mean;
}

// A slice as a point of the parabola.
struct SliceNode {
    vec3 source;      // radiance gained per metre, times density_scale
    SPECTRUM extinction; // mean over the slice, 1/m, times density_scale
    SPECTRUM x;          // optical depth of the slice
    SPECTRUM middle;     // and from its near side to the middle of its length
};

// Optical depth from a slice's near side to its middle: half of it, less what a linear change of density moves beyond
// the middle. `before` and `after` are the neighbours' densities, each slice is `ratio` times as long as the one before.
// Off by the fourth power of the length; at least an eighth of x and at most seven.
SPECTRUM optical_depth_of_middle(SPECTRUM before, SPECTRUM here, SPECTRUM after, float ratio, float dt) {
    float to_before = 0.5 * (1.0 + 1.0 / ratio); // distances of the middles, in lengths of the slice
    float to_after = 0.5 * (1.0 + ratio);
    SPECTRUM change = ((here - before) * (to_after / to_before) + (after - here) * (to_before / to_after)) /
                   (to_before + to_after);
    return dt * (0.5 * here - 0.125 * clamp(change, -3.0 * here, 3.0 * here));
}

// First two moments of optical depth t in [0, x] under the weight e^-t, normalised: 1 - B and 2 (1 - B) - x B with
// Bernoulli's B = x / (e^x - 1); below 1 by series, whose first terms left out are 4e-8 of the sum.
struct Moments {
    SPECTRUM first;
    SPECTRUM second;
};

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

#if COLORED
Moments moments_of(vec3 x, vec3 attenuation) {
    vec2 r = attenuated_moments(x.r, attenuation.r);
    vec2 g = attenuated_moments(x.g, attenuation.g);
    vec2 b = attenuated_moments(x.b, attenuation.b);
    return Moments(vec3(r.x, g.x, b.x), vec3(r.y, g.y, b.y));
}
#else
Moments moments_of(float x, float attenuation) {
    vec2 moments = attenuated_moments(x, attenuation);
    return Moments(moments.x, moments.y);
}
#endif

bool is_within_fourfold(float a, float b) { return a <= 4.0 * b && b <= 4.0 * a; }
bvec3 is_within_fourfold(vec3 a, vec3 b) {
    return bvec3(is_within_fourfold(a.r, b.r), is_within_fourfold(a.g, b.g), is_within_fourfold(a.b, b.b));
}

// The source function j / sigma_t of a neighbour, or `here`'s own where the density changes more than fourfold between
// them: no parabola fits an edge, and beside emission in thin air the quotient has no bound.
vec3 source_function(SliceNode node, SliceNode here, vec3 own) {
    return choose(is_within_fourfold(node.extinction, here.extinction), node.source / node.extinction, own);
}

// Mean radiance gained per metre over a slice under the weight e^-t, from the parabola in optical depth t, measured from
// the slice's near side, through the source functions at three middles: `here`'s, `first`'s at t = a and `last`'s at
// t = c. Limited to the span of the three, so that the march stays a convex combination of sources. In air too thin to
// divide by, the source at the middle.
vec3 mean_source(SliceNode here, SliceNode first, SPECTRUM a, SliceNode last, SPECTRUM c, SPECTRUM attenuation) {
    vec3 s = here.source / here.extinction;
    vec3 s_first = source_function(first, here, s);
    vec3 s_last = source_function(last, here, s);
    SPECTRUM b = here.middle;
    Moments moment = moments_of(here.x, attenuation);
    vec3 slope = (s - s_first) / (b - a);
    vec3 bend = ((s_last - s) / (c - b) - slope) / (c - a);
    vec3 mean = s + (moment.first - b) * slope + (moment.second - (a + b) * moment.first + a * b) * bend;
    vec3 low = min(s, min(s_first, s_last));
    vec3 high = max(s, max(s_first, s_last));
    return choose(is_below(here.x, 1e-12), here.source, clamp(mean, low, high) * here.extinction);
}

#endif
