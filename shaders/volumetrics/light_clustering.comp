// Lights -> a bit mask per cluster. Conservative: a light may be listed where it does not reach, never the other way.
// Spheres against the box around the cluster in view space, spot cones against the sphere around that box.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "common/light_clusters.glsl"
#include "common/lights.glsl"
#include "volumetrics/froxel.glsl"
#include "volumetrics/interop.h"

layout(local_size_x_id = 0, local_size_y_id = 1, local_size_z_id = 2) in;

layout(set = 0, binding = 0) uniform Parameters { VolumetricParameters u; };
layout(set = 0, binding = 1) uniform ClusterParameters { LightClusters clusters; };
layout(set = 0, binding = 2, std430) readonly restrict buffer Lights { GpuLight lights[]; };
layout(set = 0, binding = 3, std430) writeonly restrict buffer Masks { uint masks[]; };
layout(set = 0, binding = 4, std430) writeonly restrict buffer CompactLights { GpuLight compact_lights[]; };

struct ClusterColumn {
    vec2 uv_min;
    vec2 uv_max;
};

// Box around the part of the column between two depths: its corners are those of the two end faces.
void column_box(ClusterColumn column, float near_m, float far_m, out vec3 low, out vec3 high) {
    vec2 a = column_xy(u.volume, column.uv_min, near_m);
    vec2 b = column_xy(u.volume, column.uv_max, near_m);
    vec2 c = column_xy(u.volume, column.uv_min, far_m);
    vec2 d = column_xy(u.volume, column.uv_max, far_m);
    low = vec3(min(min(a, b), min(c, d)), -far_m);
    high = vec3(max(max(a, b), max(c, d)), -near_m);
}

bool sphere_meets_box(vec3 centre, float radius, vec3 low, vec3 high) {
    vec3 d = centre - clamp(centre, low, high);
    return dot(d, d) <= radius * radius;
}

// Does the cone (apex, unit axis, half angle below 90 degrees, length) meet the sphere? Exact for the infinite cone up
// to the region behind its apex, where it errs on the side of yes.
bool cone_meets_sphere(vec3 apex, vec3 axis, float cos_angle, float length_m, vec3 centre, float radius) {
    vec3 d = centre - apex;
    float along = dot(d, axis);
    float across = sqrt(max(dot(d, d) - along * along, 0.0));
    float sin_angle = sqrt(max(1.0 - cos_angle * cos_angle, 0.0));
    float outside = cos_angle * across - sin_angle * along;
    return outside <= radius && along <= length_m + radius && along >= -radius;
}

bool light_reaches(GpuLight light, ClusterColumn column, float near_m, float far_m, bool last_slab) {
    vec3 centre = transpose(mat3(u.render_from_view)) * light.position_range.xyz;
    float range = light.position_range.w;
    // The last slab has no end of its own: the light's reach ends it.
    float far_end_m = last_slab ? max(near_m, range - centre.z) : far_m;
    vec3 low;
    vec3 high;
    column_box(column, near_m, far_end_m, low, high);
    // Rounding of positions and of the depth law on both sides.
    float slack = 1e-3 * far_end_m + 1e-5 * (length(centre) + range);
    if (!sphere_meets_box(centre, range + slack, low, high)) {
        return false;
    }
    if (light.intensity_type.w < 0.5 || light.cone.x <= 0.0) {
        return true;
    }
    float cos_angle = clamp(-light.cone.y / light.cone.x, 0.0, 1.0);
    vec3 axis = transpose(mat3(u.render_from_view)) * light.direction_radius.xyz;
    float radius = 0.5 * length(high - low) + slack + 1e-3 * range;
    return cone_meets_sphere(centre, axis, cos_angle, range, 0.5 * (low + high), radius);
}

// One invocation a word of a mask; the first ones also copy the lights for the passes that read them as uniforms.
void main() {
    if (gl_GlobalInvocationID.x < min(clusters.grid.w, TYNDALL_COMPACT_LIGHT_COUNT)) {
        compact_lights[gl_GlobalInvocationID.x] = lights[gl_GlobalInvocationID.x];
    }
    uint word = gl_GlobalInvocationID.x % clusters.block.w;
    uint cluster = gl_GlobalInvocationID.x / clusters.block.w;
    uvec3 counts = clusters.counts.xyz;
    if (cluster >= counts.x * counts.y * counts.z) {
        return;
    }
    uvec3 c = uvec3(cluster % counts.x, (cluster / counts.x) % counts.y, cluster / (counts.x * counts.y));
    uvec3 first = c * clusters.block.xyz;
    uvec3 end = min(first + clusters.block.xyz, clusters.grid.xyz);
    // A column reaches half way to its neighbours.
    ClusterColumn column = ClusterColumn(uv_of_column(u.volume, vec2(first.xy) - 0.5),
                                         uv_of_column(u.volume, vec2(end.xy) - 0.5));
    float near_m = boundary_depth(u.volume, float(first.z));
    float far_m = boundary_depth(u.volume, float(end.z));

    uint mask = 0u;
    uint base = 32u * word;
    uint count = min(32u, clusters.grid.w - base);
    for (uint i = 0u; i < count; ++i) {
        if (light_reaches(lights[base + i], column, near_m, far_m, c.z + 1u == counts.z)) {
            mask |= 1u << i;
        }
    }
    masks[gl_GlobalInvocationID.x] = mask;
}
