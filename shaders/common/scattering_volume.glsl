// Look-ups in the scattering volume: the one place where fog on opaque surfaces, on transparents and on particles, and
// the light that particles receive, are read.
//
// Bindings that the caller makes: a uniform buffer that begins with a ScatteringVolume, `accumulated` (2D array, N + 1
// layers, rgb radiance, a optical depth; where extinction is coloured, N + 1 more, rgb optical depth of each channel) and `in_scattered` (3D, N slices), both with a linear sampler that clamps.
#ifndef TYNDALL_SHADERS_COMMON_SCATTERING_VOLUME_GLSL
#define TYNDALL_SHADERS_COMMON_SCATTERING_VOLUME_GLSL

#include "depth_law.glsl"
#include "far_field.glsl"
#include "scattering_volume.h"

#ifndef COLORED_EXTINCTION
#define COLORED_EXTINCTION false // a constant: each channel has an extinction of its own
#endif

// View-space xy of uv's column at depth z (m).
vec2 column_xy(ScatteringVolume volume, vec2 uv, float depth_m) {
    return (uv * volume.slope.xy + volume.slope.zw) * depth_m + uv * volume.origin.xy + volume.origin.zw;
}

// uv of a view-space point at depth z > 0: the inverse of column_xy.
vec2 column_uv(ScatteringVolume volume, vec2 xy, float depth_m) {
    return (xy - volume.slope.zw * depth_m - volume.origin.zw) / (volume.slope.xy * depth_m + volume.origin.xy);
}

// Metres of ray per metre of view depth in uv's column.
float column_stretch(ScatteringVolume volume, vec2 uv) {
    vec2 slope = uv * volume.slope.xy + volume.slope.zw;
    return sqrt(1.0 + dot(slope, slope));
}

// uv of column (x, y), which may be fractional.
vec2 uv_of_column(ScatteringVolume volume, vec2 column) { return column / (volume.grid.xy - 1.0); }

// Where uv lies in the textures.
vec2 texture_uv(ScatteringVolume volume, vec2 uv) {
    return min((uv * (volume.grid.xy - 1.0) + 0.5) / volume.grid.xy * volume.area.xy, volume.area.zw);
}

// How density changes over a slice of optical depth x, from that of a neighbour of optical depth x_neighbour at
// `direction` 1 (behind) or -1 (in front): half the relative change, positive where density falls away from the eye,
// limited so that optical depth stays monotone. The neighbour is `length_ratio` times as long as the slice.
float density_tilt(float x, float x_neighbour, float length_ratio, float direction) {
    float slope = direction * (x_neighbour / length_ratio - x) * 2.0 / (1.0 + length_ratio);
    return x > 0.0 ? clamp(-0.5 * slope / x, -0.9, 0.9) : 0.0;
}

// Optical depth between the eye and a point at fraction f of a slice, from those of the slice's boundaries and of the
// neighbour's outer one (x), and the part of the slice's radiance that lies in front of it (y); see scattering_lookup.
vec2 part_of_slice(float near, float far, float outer, float f, float length_ratio, float direction) {
    float x = max(far - near, 0.0);
    float x_neighbour = max(direction < 0.0 ? near - outer : outer - far, 0.0);
    float g = f + density_tilt(x, x_neighbour, length_ratio, direction) * f * (1.0 - f);
    return vec2(near + g * x, g * phi1(g * x) / phi1(x));
}

// Radiance scattered toward the eye in front of a point, and the transmittance from it to the eye. `depth_m` is the
// point's view depth. Beyond the range the ray goes on in closed form, so that both are continuous there; in front of
// the eye there is no fog.
//
// Between boundary k and k + 1, at fraction f of the slice with x = tau_{k+1} - tau_k:
//   tau = tau_k + g x,  L = L_k + (L_{k+1} - L_k) g phi1(g x) / phi1(x),
// exact for a source that is constant over the slice. g is the fraction of the slice's optical depth that lies in front
// of the point: f where the slice is homogeneous, f + tilt f (1 - f) where density changes linearly over it, as the next
// slice toward the eye shows. The sampler filters in xy only.
void scattering_lookup(ScatteringVolume volume, sampler2DArray accumulated, vec2 uv, float depth_m, out vec3 radiance,
                       out vec3 transmittance) {
    float slices = volume.grid.z;
    float position = min(t_from_depth(volume.law, depth_m), 1.0) * slices;
    float k = min(floor(position), slices - 1.0);
    float near_m = depth_from_t(volume.law, k / slices);
    float length_m = depth_from_t(volume.law, (k + 1.0) / slices) - near_m;
    float f = clamp((depth_m - near_m) / length_m, 0.0, 1.0);

    vec2 p = texture_uv(volume, uv);
    float direction = k > 0.0 ? -1.0 : 1.0;
    float outer = k > 0.0 ? k - 1.0 : 2.0;
    float outer_m = depth_from_t(volume.law, outer / slices);
    float neighbour_m = k > 0.0 ? near_m - outer_m : outer_m - near_m - length_m;
    vec4 near = textureLod(accumulated, vec3(p, k), 0.0);
    vec4 far = textureLod(accumulated, vec3(p, k + 1.0), 0.0);
    float ratio = neighbour_m / length_m;
    vec3 share;
    if (COLORED_EXTINCTION) {
        float first = slices + 1.0;
        vec3 tau_near = textureLod(accumulated, vec3(p, first + k), 0.0).rgb;
        vec3 tau_far = textureLod(accumulated, vec3(p, first + k + 1.0), 0.0).rgb;
        vec3 tau_outer = textureLod(accumulated, vec3(p, first + outer), 0.0).rgb;
        vec2 r = part_of_slice(tau_near.r, tau_far.r, tau_outer.r, f, ratio, direction);
        vec2 g = part_of_slice(tau_near.g, tau_far.g, tau_outer.g, f, ratio, direction);
        vec2 b = part_of_slice(tau_near.b, tau_far.b, tau_outer.b, f, ratio, direction);
        share = vec3(r.y, g.y, b.y);
        transmittance = exp(-vec3(r.x, g.x, b.x));
    } else {
        float tau_outer = textureLod(accumulated, vec3(p, outer), 0.0).a;
        vec2 part = part_of_slice(near.a, far.a, tau_outer, f, ratio, direction);
        share = vec3(part.y);
        transmittance = vec3(exp(-part.x));
    }
    radiance = (near.rgb + (far.rgb - near.rgb) * share) * volume.scale.y;

    float range_m = volume.law.range_shape.x;
    vec3 slope = vec3(uv * volume.slope.xy + volume.slope.zw, -1.0);
    vec3 start = vec3(column_xy(volume, uv, range_m), -range_m);
    float beyond_m = max(depth_m - range_m, 0.0);
    if (COLORED_EXTINCTION) {
        ColoredFarFog beyond = colored_far_fog(volume.beyond, start, slope, beyond_m);
        radiance += transmittance * beyond.radiance;
        transmittance *= beyond.transmittance;
    } else {
        FarFog beyond = far_fog(volume.beyond, start, slope, beyond_m);
        radiance += transmittance * beyond.radiance;
        transmittance *= beyond.transmittance;
    }
}

// Light that a particle at a point sends to the eye per unit of albedo: radiance in-scattered there per unit of
// scattering coefficient, summed over sun, lights and ambient as phase function times what arrives. For a particle of
// albedo a, C = a * in_scattered. Points outside the volume get the nearest value in it.
vec3 in_scattered_lookup(ScatteringVolume volume, sampler3D in_scattered, vec2 uv, float depth_m) {
    vec3 p = vec3(texture_uv(volume, uv), t_from_depth(volume.law, depth_m));
    return textureLod(in_scattered, p, 0.0).rgb * volume.scale.y;
}

#endif
