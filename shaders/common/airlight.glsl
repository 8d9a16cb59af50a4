// Light of single lights that the fog scatters toward the eye along the ray of one pixel.
//
// Seen from the light, a point of the ray lies at the angle w from the direction toward the eye's side of the ray; with h
// the light's distance from the ray, dt / d^2 = dw / h (Kulla and Fajardo 2012, "Importance Sampling Techniques for Path
// Tracing in Participating Media"), which takes the pole out of the integrand. The ray is cut at the point nearest to the
// light, where a spot's cone ends and where it begins to fade, and where it enters the source; on each piece the substitution x = w / (w + peak) flattens
// the peak of the phase function, and four Gauss-Legendre nodes do: within 0.3 % for asymmetries of -0.999 to 0.999, rms.
// The four nodes are the components of a vector.
//
// Where a light casts shadows, LOCAL_SHADOW 1, its map is asked eight times on each piece; the lit parts of the piece weigh
// the polynomial through the four nodes. The caller declares local_shadow_maps and local_shadows first, as
// local_shadow.glsl describes.
//
// A caller in a stage with four uniform blocks or more defines AIRLIGHT_SKIPS 0: see far_field.glsl about branches there.
#ifndef TYNDALL_SHADERS_COMMON_AIRLIGHT_GLSL
#define TYNDALL_SHADERS_COMMON_AIRLIGHT_GLSL

#include "airlight.h"
#include "lights.glsl"
#include "scattering_volume.glsl"
#include "small_angles.glsl"

#ifndef AIRLIGHT_SKIPS
#define AIRLIGHT_SKIPS 1
#endif
#if AIRLIGHT_SKIPS
#define AIRLIGHT_IF(condition) if (condition)
#else
#define AIRLIGHT_IF(condition)
#endif

// From the including file: `airlight_features`, a specialization constant of bits of airlight.h.
const uint airlight_count = airlight_features & ((1u << TYNDALL_AIRLIGHT_COUNT_BITS) - 1u);
const bool airlight_has_height_fog = (airlight_features & TYNDALL_AIRLIGHT_HEIGHT_BIT) != 0u;
const uint airlight_lobes = (airlight_features >> TYNDALL_AIRLIGHT_LOBES_SHIFT) & 7u;
const int airlight_pieces = (airlight_features & TYNDALL_AIRLIGHT_SPOT_BIT) != 0u ? 3 : 2;

const vec4 gauss_places = vec4(0.06943184, 0.33000948, 0.66999052, 0.93056816); // of [0, 1]
const vec4 gauss_weights = vec4(0.17392742, 0.32607258, 0.32607258, 0.17392742);

// The ray of a pixel up to what it sees, view space.
struct PixelPath {
    vec3 start;
    vec3 ray; // unit
    float length_m;
    float height; // of `start` above the base of the height fog, m
    float climb;  // of the ray, per metre
    vec3 render_start; // the same as start and ray in render space, where shadow maps are asked
    vec3 render_ray;
    float offset; // in [0, 1), of this pixel's places to ask at from the beginnings of their steps
};

// Jimenez 2014, "Next Generation Post Processing in Call of Duty: Advanced Warfare": neighbours differ much.
float interleaved_noise(vec2 pixel) { return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))); }

PixelPath pixel_path(ScatteringVolume volume, vec2 uv, float depth_m, vec3 render_start, vec3 render_ray, float offset) {
    vec3 slope = vec3(uv * volume.slope.xy + volume.slope.zw, -1.0);
    float stretch = length(slope);
    vec3 start = vec3(uv * volume.origin.xy + volume.origin.zw, 0.0);
    vec3 ray = slope / stretch;
    return PixelPath(start, ray, clamp(depth_m * stretch, 0.0, 1e30), dot(volume.beyond.up.xyz, start) + volume.beyond.up.w,
                     dot(volume.beyond.up.xyz, ray), render_start, render_ray, offset);
}

// Squared chords from the direction straight on, and straight back, of four angles.
vec4 phase_of_chords(PhaseTerms terms, int lobe, vec4 forward, vec4 backward) {
    vec4 cosine = 0.25 * (backward - forward);
    vec4 root = inversesqrt(terms.spread[lobe] + terms.forward[lobe] * forward + terms.backward[lobe] * backward);
    vec4 peak = root * root * root * mix(vec4(1.0), root, terms.steep[lobe]);
    return (terms.constant[lobe] + terms.squared[lobe] * cosine * cosine) * peak;
}

vec4 airlight_phase(PhaseTerms terms, vec4 forward, vec4 backward) {
    vec4 sum = phase_of_chords(terms, 0, forward, backward);
    if (airlight_lobes > 1u) {
        sum += phase_of_chords(terms, 1, forward, backward);
    }
    if (airlight_lobes > 2u) {
        sum += phase_of_chords(terms, 2, forward, backward);
    }
    if (airlight_lobes > 3u) {
        sum += phase_of_chords(terms, 3, forward, backward);
    }
    return sum;
}

// Heights above the base of the height fog, and its part there of what it is at the base.
struct HeightFogAt {
    vec4 height;
    vec4 profile;
};

HeightFogAt height_fog_at(FarField far, vec4 height) {
    return HeightFogAt(height, exp(-far.sun_illuminance.w * max(height, 0.0)));
}

// Of straight ways of length_m between two heights: homogeneous and height fog. The latter's integral over height is
// linear below the base and changes by that of the profile over the falloff above it.
vec4 closed_optical_depth(FarField far, HeightFogAt a, HeightFogAt b, vec4 length_m) {
    vec4 tau = far.homogeneous.w * length_m;
    if (airlight_has_height_fog) {
        float falloff = far.sun_illuminance.w;
        vec4 rise = b.height - a.height;
        bvec4 level = lessThan(falloff * abs(rise), vec4(0.02)); // where the difference cancels: 3e-5 off
        vec4 integral = min(b.height, 0.0) - min(a.height, 0.0) + (a.profile - b.profile) / max(falloff, 1e-20);
        tau += far.height.w * length_m * mix(integral / mix(rise, vec4(1.0), level), 0.5 * (a.profile + b.profile), level);
    }
    return tau;
}

// Where four points of the ray lie as one light sees them: distances from the eye and from the light, m.
struct LightWays {
    vec4 from_eye_m;
    vec4 from_light_m;
};

// What reaches the eye of light that is scattered with `weight` at four points: the sum over them, per scattering
// coefficient's unit.
vec3 scattered_sum(FarField far, vec4 shape, PixelPath path, HeightFogAt eye, HeightFogAt light, LightWays ways,
                   vec4 weight) {
    HeightFogAt here = height_fog_at(far, path.height + ways.from_eye_m * path.climb);
    vec4 tau = closed_optical_depth(far, eye, here, ways.from_eye_m) +
               shape.z * closed_optical_depth(far, light, here, ways.from_light_m);
    weight *= exp(-tau);
    vec3 sum = far.homogeneous.rgb * (far.homogeneous.w * dot(weight, vec4(1.0)));
    if (airlight_has_height_fog) {
        sum += far.height.rgb * (far.height.w * dot(weight, here.profile));
    }
    return sum;
}

// The angle w that belongs to the angle under which the light itself sees a point: the same outside the source. Within it
// the light's distance h from the ray is held at the radius.
float angle_outside(float seen, float h, float true_h) {
    seen = clamp(seen, 1e-6, 1.57079633);
    return h > true_h ? positive_atan(h * sine(seen), true_h * sine(1.57079633 - seen)) : seen;
}

// Of a ray, the places s before (sign -1) or behind (1) its point nearest to a light, at the light's angle w.
float place_of_angle(float h, float sign, float w) { return sign * h * sine(1.57079633 - w) / sine(w); }

#if LOCAL_SHADOW
// Weights of the four nodes where only parts of the piece x_a + x_length * [0, 1] are lit: each of eight steps weighs the
// polynomial that is 1 at one node and 0 at the others.
vec4 lit_weights(LocalShadow shadow, PixelPath path, float nearest_m, float h, float sign, float x_a, float x_length,
                 float peak) {
    vec4 sum = vec4(0.0);
    vec4 before = vec4(0.0);
    [[dont_unroll]] for (float i = 0.0; i < 8.0; i += 1.0) {
        float rest = 1.0 - (x_a + x_length * 0.125 * (i + path.offset));
        float w = clamp(peak / rest - peak, 1e-7, 1.57079633);
        float t = max(nearest_m + place_of_angle(h, sign, w), 0.0);
        float e = 0.125 * (i + 1.0);
        vec4 after = e * (vec4(1.52678813, -0.81363245, 0.40076152, -0.11391720) +
                          e * (vec4(-4.27301180, 6.90358346, -3.70853521, 1.07796355) +
                               e * (vec4(4.77528612, -10.46274079, 8.33270862, -2.64525395) +
                                    e * vec4(-1.85513502, 4.69886235, -4.69886235, 1.85513502))));
        sum += (after - before) * local_visibility(shadow, local_shadow_maps, path.render_start + t * path.render_ray);
        before = after;
    }
    return sum;
}
#endif

vec3 airlight_of(GpuLight light, FarField far, vec4 shape, PixelPath path) {
    vec3 to_light = light.position_range.xyz - path.start;
    float nearest_m = dot(to_light, path.ray); // along the ray
    vec3 offset = nearest_m * path.ray - to_light;
    float offset_squared = dot(offset, offset);
    float range_m = light.position_range.w;
    float reach_m = sqrt(max(range_m * range_m - offset_squared, 0.0));
    // The lit part of the ray, from its point nearest to the light.
    float begin_m = max(-nearest_m, -reach_m);
    float end_m = min(path.length_m - nearest_m, reach_m);
    vec3 sum = vec3(0.0);
    AIRLIGHT_IF (end_m > begin_m) {
        float radius_m = max(light.direction_radius.w, smallest_light_radius_m);
        float true_h = sqrt(offset_squared);
        float h = max(true_h, radius_m);
        // The cone is an interval of angles around `middle`: direction . axis = along cos(w - middle).
        vec2 axis = vec2(dot(offset, light.direction_radius.xyz) * inversesqrt(max(offset_squared, 1e-20)),
                         dot(path.ray, light.direction_radius.xyz));
        float along_squared = dot(axis, axis);
        float middle = 1.57079633 + atan(axis.y, axis.x + (axis.x < 0.0 ? -1e-20 : 1e-20));
        float spot = light.intensity_type.w;
        float outer_cosine = -light.cone.y / max(light.cone.x, 1e-20);
        float inner_cosine = outer_cosine + 1.0 / max(light.cone.x, 1e-20);
        float outer = positive_atan(sqrt(max(along_squared - outer_cosine * outer_cosine, 1e-20)), outer_cosine);
        float inner = positive_atan(sqrt(max(along_squared - inner_cosine * inner_cosine, 1e-20)), inner_cosine);
        float meets = mix(1.0, float(along_squared > outer_cosine * outer_cosine || outer_cosine < 0.0), spot);
        float source = positive_atan(h, sqrt(max(radius_m * radius_m - offset_squared, 0.0))); // where the ray enters it
        HeightFogAt at_eye = height_fog_at(far, vec4(path.height));
        HeightFogAt at_light = height_fog_at(far, vec4(path.height + dot(far.up.xyz, to_light)));

        // Before the nearest point w is the angle from straight on, behind it the angle from straight back.
        [[dont_unroll]] for (int side = 0; side < 2; ++side) {
            float sign = side == 0 ? -1.0 : 1.0;
            float near_m = side == 0 ? -end_m : begin_m;
            float far_m = side == 0 ? -begin_m : end_m;
            float low = positive_atan(h, far_m);
            float high = min(positive_atan(h, near_m), 1.57079633);
            float cone_middle = side == 0 ? middle : 3.14159265 - middle;
            low = mix(low, max(low, angle_outside(cone_middle - outer, h, true_h)), spot);
            high = mix(high, min(high, angle_outside(cone_middle + outer, h, true_h)), spot);
            vec2 cuts = mix(vec2(source, high),
                            vec2(angle_outside(cone_middle - inner, h, true_h),
                                 angle_outside(cone_middle + inner, h, true_h)), spot);
            cuts = clamp(cuts, low, max(high, low));
            float peak = side == 0 ? shape.x : shape.y;
            AIRLIGHT_IF (high > low) {
                [[dont_unroll]] for (int piece = 0; piece < airlight_pieces; ++piece) {
                    float a = piece == 0 ? low : piece == 1 ? cuts.x : cuts.y;
                    float b = piece == 0 ? cuts.x : piece == 1 ? cuts.y : high;
                    AIRLIGHT_IF (b > a) {
                    float x_a = a / (a + peak);
                    float x_length = b / (b + peak) - x_a;
                    vec4 rest = 1.0 - (x_a + x_length * gauss_places);
                    vec4 w = clamp(peak / rest - peak, 1e-7, 1.57079633);
                    vec4 weight = gauss_weights;
#if LOCAL_SHADOW
                    AIRLIGHT_IF (casts_local_shadow(light.cone)) {
                        vec4 lit = lit_weights(local_shadows[local_shadow_index(light.cone)], path, nearest_m, h, sign,
                                               x_a, x_length, peak);
                        weight = mix(weight, lit, bvec4(casts_local_shadow(light.cone)));
                    }
#endif
                    weight *= (x_length * peak) / (rest * rest);
                    vec4 sine_w = sine(w);
                    vec4 s = h * sine(1.57079633 - w) / sine_w; // from the nearest point
                    vec4 d_squared = h * h / (sine_w * sine_w);
                    // The angle that the light itself sees; its chord from the peak without cancelling there.
                    vec4 true_squared = offset_squared + s * s;
                    vec4 inverse = inversesqrt(max(true_squared, 1e-20));
                    vec4 sine_seen = true_h * inverse;
                    vec4 cosine_seen = s * inverse;
                    vec4 from_peak = 2.0 * sine_seen * sine_seen / (1.0 + cosine_seen);
                    vec4 from_back = 4.0 - from_peak;
                    weight *= side == 0 ? airlight_phase(far.phase, from_peak, from_back)
                                        : airlight_phase(far.phase, from_back, from_peak);
                    // Within the source the distance is held at its radius.
                    weight *= d_squared / max(true_squared, radius_m * radius_m);
                    vec4 x = true_squared / (range_m * range_m);
                    weight *= clamp(1.0 - x * x, 0.0, 1.0);
                    vec4 cosine = axis.x * sine_seen + axis.y * (sign * cosine_seen);
                    vec4 cone = clamp(cosine * light.cone.x + light.cone.y, 0.0, 1.0);
                    weight *= mix(vec4(1.0), cone * cone, spot);
                    LightWays ways = LightWays(max(nearest_m + sign * s, 0.0), sqrt(true_squared));
                    weight = mix(vec4(0.0), weight, bvec4(b > a));
                    sum += scattered_sum(far, shape, path, at_eye, at_light, ways, weight);
                    }
                }
            }
        }
        sum = max(sum, 0.0) * light.intensity_type.rgb * (meets / h);
    }
    return mix(vec3(0.0), sum, bvec3(end_m > begin_m));
}

// Adds what `airlights` bring to the radiance in front of the path's end. A macro, since a copy of an array
// that is indexed at run time would be fetched lane by lane.
#define ADD_AIRLIGHT(volume, airlights, path, radiance)                                                                \
    if (airlight_count > 0u) {                                                                                         \
        [[dont_unroll]] for (uint i = 0u; i < airlight_count; ++i) {                                                   \
            radiance += airlight_of(airlights.lights[i], volume.beyond, airlights.shape, path);                        \
        }                                                                                                              \
    }

// Light that a particle sends to the eye per unit of albedo, from the light alone: phase function times what arrives.
// Within a particle the mean of 1 / d^2 stands for it, 3 / radius^2 in the middle of a ball.
// `render_position` is where its shadow is asked for.
vec3 light_of_particle(GpuLight light, FarField far, vec4 shape, vec3 position, vec3 render_position, float radius_m) {
    vec3 d = position - light.position_range.xyz;
    float distance_squared = dot(d, d);
    vec3 travel = d * inversesqrt(max(distance_squared, 1e-20));
    float fade = light_window(light.position_range.w, distance_squared) *
                 mix(1.0, spot_cone(light.direction_radius.xyz, light.cone.xy, -travel), light.intensity_type.w);
#if LOCAL_SHADOW
    if (casts_local_shadow(light.cone)) {
        fade *= local_visibility(local_shadows[local_shadow_index(light.cone)], local_shadow_maps, render_position);
    }
#endif
    vec3 to_eye = -normalize(position + vec3(0.0, 0.0, -1e-10));
    float height = far.up.w + dot(far.up.xyz, position);
    float light_height = far.up.w + dot(far.up.xyz, light.position_range.xyz);
    float tau = closed_optical_depth(far, height_fog_at(far, vec4(light_height)), height_fog_at(far, vec4(height)),
                                     vec4(sqrt(distance_squared)))
                    .x;
    float size_m = max(light.direction_radius.w, smallest_light_radius_m);
    float falloff = 1.0 / max(distance_squared + radius_m * radius_m / 3.0, size_m * size_m);
    return light.intensity_type.rgb * (fade * falloff * exp(-tau * shape.z) *
                                       phase_of_terms(far.phase, travel, to_eye));
}

// Adds it, of all of `airlights`; position in view space.
#define ADD_LIGHT_OF_PARTICLE(volume, airlights, position, render_position, radius_m, light)                           \
    [[dont_unroll]] for (uint i = 0u; i < airlight_count; ++i) {                                                       \
        light += light_of_particle(airlights.lights[i], volume.beyond, airlights.shape, position, render_position,     \
                                   radius_m);                                                                          \
    }

#endif
