// Sun visibility of a slice of the ray: by the exponential shadow map, or from the texels of the cascades themselves.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_SLICE_VISIBILITY_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_SLICE_VISIBILITY_GLSL

#include "common/sun_shadow.h"
#include "volumetrics/esm.glsl"
#include "volumetrics/ray_segment.glsl"

// As SunVisibility of features/volumetrics/lighting_settings.hpp.
const uint one_tap = 0u;
const uint n_taps = 1u;
const uint prefiltered = 2u;
const uint lit_fraction = 3u;

// A segment of the ray in a cascade's space: uv and depth, 0 at the light.
struct ShadowSegment {
    vec3 near;
    vec3 far;
    float layer; // of the cascade; -1 outside all of them
};

// Where a point of render space lies in a cascade: uv and depth in xyz, the layer in w, and in `along` what a metre of
// ray, `direction`, is there; unchanged where another cascade has the point already, or where it lies outside this one.
void try_cascade(mat4 shadow_from_render, float layer, float split_depth_m, vec3 position, float depth_m,
                 vec3 direction, inout vec4 place, inout vec3 along) {
    if (place.w < 0.0 && depth_m <= split_depth_m) {
        vec3 p = (shadow_from_render * vec4(position, 1.0)).xyz;
        if (all(equal(p.xy, clamp(p.xy, 0.0, 1.0)))) {
            place = vec4(p, layer);
            along = (shadow_from_render * vec4(direction, 0.0)).xyz;
        }
    }
}

// 1 where the texel's occluder does not lie before the point. The air needs no bias: nothing shadows itself.
float tap_visibility(sampler2DArray cascades, vec3 p, float layer, float size) {
    float occluder = texelFetch(cascades, ivec3(clamp(p.xy * size, 0.0, size - 1.0), layer), 0).r;
    return clamp(p.z, 0.0, 1.0) <= occluder ? 1.0 : 0.0;
}

// The mean of `count` taps at even distances along the segment, the first at `offset` of a distance from its near end;
// those beside the map count nothing. A long slice reaches beyond the cascade that its sample lies in, and were lit there
// the light would leak into closed rooms.
float taps_visibility(sampler2DArray cascades, ShadowSegment segment, float size, uint count, float offset) {
    float sum = 0.0;
    float taken = 0.0;
    for (uint i = 0u; i < count; ++i) {
        vec3 p = mix(segment.near, segment.far, (float(i) + offset) / float(count));
        if (all(equal(p.xy, clamp(p.xy, 0.0, 1.0)))) {
            sum += tap_visibility(cascades, p, segment.layer, size);
            taken += 1.0;
        }
    }
    return taken > 0.0 ? sum / taken : 1.0;
}

// The part of an interval over which depth goes from a to b that does not lie behind `occluder`.
float part_before(float occluder, float a, float b) {
    float low = min(a, b);
    float span = max(a, b) - low;
    return span > 0.0 ? clamp((occluder - low) / span, 0.0, 1.0) : (low <= occluder ? 1.0 : 0.0);
}

// The part of the segment's length that is lit: exact for the shadow map's own geometry, each texel a column that ends at
// its occluder. Walks the texels that the segment crosses (Amanatides and Woo 1987, "A Fast Voxel Traversal Algorithm for
// Ray Tracing"); what lies beside the map is taken to be lit as the part in it.
float lit_part(sampler2DArray cascades, ShadowSegment segment, float size) {
    vec3 span = segment.far - segment.near;
    // The part inside the map.
    vec2 inverse = 1.0 / mix(span.xy, vec2(1e-20), lessThan(abs(span.xy), vec2(1e-20)));
    vec2 to_low = -segment.near.xy * inverse;
    vec2 to_high = (1.0 - segment.near.xy) * inverse;
    vec2 enter = min(to_low, to_high);
    vec2 leave = max(to_low, to_high);
    float t = clamp(max(enter.x, enter.y), 0.0, 1.0);
    float end = clamp(min(leave.x, leave.y), t, 1.0);
    float inside = end - t;

    vec2 start = clamp((segment.near.xy + t * span.xy) * size, 0.0, size);
    vec2 stop = clamp((segment.near.xy + end * span.xy) * size, 0.0, size);
    vec2 heading = vec2(greaterThan(inverse, vec2(0.0))) * 2.0 - 1.0;
    vec2 texel = clamp(floor(start), 0.0, size - 1.0);
    vec2 last = clamp(floor(stop), 0.0, size - 1.0);
    vec2 t_step = abs(inverse) / size;
    vec2 t_edge = ((texel + 0.5 + 0.5 * heading) / size - segment.near.xy) * inverse; // where it leaves the texel
    int crossings = int(abs(last.x - texel.x) + abs(last.y - texel.y));
    float lit = 0.0;
    for (int i = 0; i <= crossings; ++i) {
        bool in_x = t_edge.x < t_edge.y;
        float t_next = i == crossings ? end : clamp(in_x ? t_edge.x : t_edge.y, t, end);
        float occluder = texelFetch(cascades, ivec3(clamp(texel, 0.0, size - 1.0), segment.layer), 0).r;
        float depth = clamp(segment.near.z + t * span.z, 0.0, 1.0);
        float depth_next = clamp(segment.near.z + t_next * span.z, 0.0, 1.0);
        lit += (t_next - t) * part_before(occluder, depth, depth_next);
        t = t_next;
        texel += in_x ? vec2(heading.x, 0.0) : vec2(0.0, heading.y);
        t_edge += in_x ? vec2(t_step.x, 0.0) : vec2(0.0, t_step.y);
    }
    return inside > 0.0 ? min(lit / inside, 1.0) : 1.0;
}

// Visibility of the sun, 0 to 1, in a slice of the ray whose sample lies at `depth_m` of view depth. The first cascade
// that reaches the depth and contains the sample decides; outside all of them the sun is not shadowed. `map` holds the
// ESM or the cascades, as `method` wants; `size` is its side in texels and the reciprocal. Written out for `count` of
// four cascades, and a macro, since a matrix that is indexed at run time, or copied into a function, is fetched lane by
// lane.
#define SUN_VISIBILITY(cascades, count, map, exponents, size, method, taps, segment, depth_m, visibility)              \
    {                                                                                                                  \
        vec4 place = vec4(0.0, 0.0, 0.0, -1.0);                                                                        \
        vec3 along = vec3(0.0);                                                                                        \
        vec3 position = segment.position;                                                                              \
        vec3 direction = -segment.to_eye;                                                                              \
        try_cascade(cascades.shadow_from_render[0], 0.0, cascades.split_depth_m.x, position, depth_m, direction,       \
                    place, along);                                                                                     \
        if (count > 1) {                                                                                               \
            try_cascade(cascades.shadow_from_render[1], 1.0, cascades.split_depth_m.y, position, depth_m, direction,   \
                        place, along);                                                                                 \
        }                                                                                                              \
        if (count > 2) {                                                                                               \
            try_cascade(cascades.shadow_from_render[2], 2.0, cascades.split_depth_m.z, position, depth_m, direction,   \
                        place, along);                                                                                 \
        }                                                                                                              \
        if (count > 3) {                                                                                               \
            try_cascade(cascades.shadow_from_render[3], 3.0, cascades.split_depth_m.w, position, depth_m, direction,   \
                        place, along);                                                                                 \
        }                                                                                                              \
        float lit = 1.0;                                                                                               \
        if (method == prefiltered) {                                                                                   \
            vec4 chosen = vec4(equal(place.wwww, vec4(0.0, 1.0, 2.0, 3.0)));                                           \
            float k_receiver = dot(exponents, chosen) * clamp(place.z, 0.0, 1.0);                                      \
            lit = esm_visibility(map, place.xyw, k_receiver, size);                                                    \
        } else if (method == one_tap) {                                                                                \
            lit = tap_visibility(map, place.xyz, max(place.w, 0.0), size.x);                                           \
        } else {                                                                                                       \
            ShadowSegment shadow = ShadowSegment(place.xyz - along * segment.behind_m,                                 \
                                                 place.xyz + along * segment.ahead_m, max(place.w, 0.0));              \
            float offset = segment.behind_m / max(segment.behind_m + segment.ahead_m, 1e-20);                          \
            lit = method == lit_fraction ? lit_part(map, shadow, size.x)                                               \
                                         : taps_visibility(map, shadow, size.x, taps, offset);                         \
        }                                                                                                              \
        visibility = place.w >= 0.0 && place.w < cascades.direction_count.w ? lit : 1.0;                               \
    }

#endif
