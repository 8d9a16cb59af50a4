// Density and in-scattered radiance -> radiance toward the eye (rgb) and optical depth (a) at the N + 1 slice
// boundaries, the eye's own (0, 0) included. Serial along each column.
//
// Per slice of ray length dt, with mean extinction sigma_t and source j: x = sigma_t dt,  L += T dt j w(x),  T *= e^-x,
// tau += x. The default, w = phi1, is exact for a constant medium, divides by no sigma and is a convex combination, so
// bounded by the brightest source whatever x. The others are in integrators.glsl.
//
// COLORED 1: each channel has an extinction of its own, read from the second half of `density`; N + 1 more layers hold the
// optical depth of each (rgb), the first ones' a the largest.
//
// EMISSION 1: the medium emits, too. L is then no more than the smaller of the brightest j / sigma_t and the sum of j dt.
//
// ESTIMATE 1: what another scheme makes of the same samples is summed beside, and the difference at the last boundary
// stored: against exponential_quadratic, and of that itself against exponential.
#version 460
#extension GL_GOOGLE_include_directive : require

layout(constant_id = 4) const bool has_depth_curve = false;
#define DEPTH_CURVE has_depth_curve

#if COLORED
#define COLORED_EXTINCTION true
#endif
#include "volumetrics/froxel.glsl"
#include "volumetrics/integrators.glsl"
#include "volumetrics/interop.h"
#include "volumetrics/storage.glsl"

layout(local_size_x_id = 0, local_size_y_id = 1, local_size_z_id = 2) in;
layout(constant_id = 3) const uint integrator = exponential;

layout(set = 0, binding = 0) uniform Parameters { VolumetricParameters u; };
layout(set = 0, binding = 1, VOLUME_FORMAT) uniform readonly restrict image3D density;
layout(set = 0, binding = 2, VOLUME_FORMAT) uniform readonly restrict image3D in_scattered;
layout(set = 0, binding = 3, VOLUME_FORMAT) uniform writeonly restrict image2DArray accumulated;
#if EMISSION
layout(set = 0, binding = 5, VOLUME_FORMAT) uniform readonly restrict image3D emitted;
#endif
#if ESTIMATE
layout(set = 0, binding = 4, rgba32f) uniform writeonly restrict image2D error_estimate;
const bool needs_parabola = true;
#else
const bool needs_parabola = integrator == exponential_quadratic;
#endif
const uint companion = integrator == exponential_quadratic ? exponential : exponential_quadratic;

#if COLORED
vec3 extinction_of(ivec2 column, int k, vec4 medium) {
    return imageLoad(density, ivec3(column, k + int(u.volume.grid.z))).rgb;
}
#else
float extinction_of(ivec2 column, int k, vec4 medium) { return medium.a; }
#endif

SPECTRUM density_of(ivec2 column, int k) { return extinction_of(column, k, imageLoad(density, ivec3(column, k))); }

void store(ivec2 column, int boundary, vec3 radiance, SPECTRUM tau) {
#if COLORED
    float most = max(tau.r, max(tau.g, tau.b));
    imageStore(accumulated, ivec3(column, boundary + int(u.volume.grid.z) + 1), storable(vec4(tau, 0.0)));
#else
    float most = tau;
#endif
    imageStore(accumulated, ivec3(column, boundary), storable(vec4(radiance, most)));
}

// Radiance gained per metre in slice k of this scattering coefficient, times density_scale.
vec3 source_of(ivec2 column, int k, vec3 scattering) {
    vec3 source = scattering * imageLoad(in_scattered, ivec3(column, k)).rgb;
#if EMISSION
    source += imageLoad(emitted, ivec3(column, k)).rgb * u.emission_scale.y;
#endif
    return source;
}

// The length of slice k + steps, where that of slice k is dt. A curve's slices, other than those of one law, do not all
// grow by the same ratio.
float length_after(int k, float steps, float dt) {
    if (has_depth_curve) {
        float near_m = boundary_depth(u.volume, float(k));
        float next_m = boundary_depth(u.volume, float(k) + steps);
        return dt * slice_depth(u.volume, float(k) + steps, next_m) / slice_depth(u.volume, float(k), near_m);
    }
    float ratio = steps < 0.0 ? u.volume.slice.w : u.volume.slice.z;
    return dt * (abs(steps) > 1.0 ? ratio * ratio : ratio);
}

// Slice k of length dt; at the column's ends the density goes on as it begins.
SliceNode slice_node(ivec2 column, int k, float dt) {
    int last = int(u.volume.grid.z) - 1;
    vec4 medium = imageLoad(density, ivec3(column, k));
    SPECTRUM here = extinction_of(column, k, medium);
    SPECTRUM before = k > 0 ? density_of(column, k - 1) : 2.0 * here - density_of(column, 1);
    SPECTRUM after = k < last ? density_of(column, k + 1) : 2.0 * here - density_of(column, last - 1);
    SliceNode node;
    node.source = source_of(column, k, medium.rgb);
    node.extinction = here;
    node.x = here * dt;
    float ratio = has_depth_curve ? length_after(k, k < last ? 1.0 : -1.0, 1.0) : u.volume.slice.z;
    node.middle = optical_depth_of_middle(before, here, after, k < last || !has_depth_curve ? ratio : 1.0 / ratio, dt);
    return node;
}

// `mean_source` of slice k of length dt: the parabola goes through the middles of its neighbours, at an end of the
// column through those of the next two slices.
vec3 parabolic_source(ivec2 column, int k, float dt, SliceNode before, SliceNode here, SliceNode after,
                      SPECTRUM attenuation) {
    int last = int(u.volume.grid.z) - 1;
    SPECTRUM a = before.middle - before.x;
    SPECTRUM c = here.x + after.middle;
    if (k == 0) {
        before = slice_node(column, 2, length_after(k, 2.0, dt));
        a = here.x + after.x + before.middle;
    } else if (k == last) {
        after = slice_node(column, last - 2, length_after(k, -2.0, dt));
        c = after.middle - after.x - before.x;
    }
    return mean_source(here, before, a, after, c, attenuation);
}

void main() {
    ivec2 column = ivec2(gl_GlobalInvocationID.xy);
    ivec3 grid = ivec3(u.volume.grid.xyz);
    if (any(greaterThanEqual(column, grid.xy))) {
        return;
    }
    vec2 uv = uv_of_column(u.volume, vec2(column));
    // Each slice is longer than the one before it by the same ratio, which is kept as its difference to 1: a product of
    // rounded ratios would drift.
    float dt = slice_depth(u.volume, 0.0, 0.0) * column_stretch(u.volume, uv) * u.density_scale.y;
    vec3 radiance = vec3(0.0);
    vec3 companion_radiance = vec3(0.0);
    SPECTRUM tau = SPECTRUM(0.0);
    SPECTRUM transmittance = SPECTRUM(1.0);
    store(column, 0, radiance, tau);
    SliceNode before;
    SliceNode here;
    if (needs_parabola) {
        here = slice_node(column, 0, dt);
        before = here;
    }
    for (int k = 0; k < grid.z; ++k) {
        vec3 source;
        vec3 parabola;
        SPECTRUM x;
        Attenuation attenuation;
        if (needs_parabola) {
            SliceNode after = here;
            if (k + 1 < grid.z) {
                after = slice_node(column, k + 1, length_after(k, 1.0, dt));
            }
            source = here.source;
            x = here.x;
            attenuation = attenuation_of(x);
            parabola = parabolic_source(column, k, dt, before, here, after, attenuation.across);
            before = here;
            here = after;
        } else {
            vec4 medium = imageLoad(density, ivec3(column, k));
            source = source_of(column, k, medium.rgb);
            x = extinction_of(column, k, medium) * dt;
            attenuation = attenuation_of(x);
        }
        SPECTRUM weight = transmittance * dt * mean_transmittance(integrator, x, attenuation);
        radiance += (integrator == exponential_quadratic ? parabola : source) * weight;
#if ESTIMATE
        SPECTRUM companion_weight = transmittance * dt * mean_transmittance(companion, x, attenuation);
        companion_radiance += (companion == exponential_quadratic ? parabola : source) * companion_weight;
#endif
        tau += x;
        transmittance *= attenuation.across;
        store(column, k + 1, radiance, tau);
        dt = has_depth_curve ? length_after(k, 1.0, dt) : dt + dt * u.volume.scale.z;
    }
#if ESTIMATE
    imageStore(error_estimate, column, vec4(abs(radiance - companion_radiance), 0.0));
#endif
}
