// Lights -> a bit mask per cluster. Conservative: a light may be listed where it does not reach, never the other way.
// Spheres against the box around the cluster in view space, spot cones against the sphere around that box. PARTICLES 1:
// particles of fog in the place of lights.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "common/light_clusters.glsl"
#include "common/lights.glsl"
#include "volumetrics/froxel.glsl"
#include "volumetrics/interop.h"
#if PARTICLES
#include "volumetrics/fog_particle.h"
#endif

layout(local_size_x_id = 0, local_size_y_id = 1, local_size_z_id = 2) in;

layout(set = 0, binding = 0) uniform Parameters { VolumetricParameters u; };
layout(set = 0, binding = 1) uniform ClusterParameters { LightClusters clusters; };
#if PARTICLES
layout(set = 0, binding = 2, std430) readonly restrict buffer Particles { GpuFogParticle particles[]; };
#else
layout(set = 0, binding = 2, std430) readonly restrict buffer Lights { GpuLight lights[]; };
layout(set = 0, binding = 4, std430) writeonly restrict buffer CompactLights { GpuLight compact_lights[]; };
#endif
layout(set = 0, binding = 3, std430) writeonly restrict buffer Masks { uint masks[]; };

struct ClusterColumn {
    vec2 uv_min;
    vec2 uv_max;
};

struct Cluster {
    ClusterColumn column;
    float near_m;
    float far_m;
    bool last_slab;
};

// A sphere of lights or particles beside a cluster, in view space.
struct Approach {
    vec3 centre;
    vec3 low; // box around the cluster
    vec3 high;
    float slack;
    bool meets;
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

Approach approach(vec3 render_position, float range, Cluster cluster) {
    Approach made;
    made.centre = transpose(mat3(u.render_from_view)) * render_position;
    // The last slab has no end of its own: the sphere's reach ends it.
    float far_end_m = cluster.last_slab ? max(cluster.near_m, range - made.centre.z) : cluster.far_m;
    column_box(cluster.column, cluster.near_m, far_end_m, made.low, made.high);
    // Rounding of positions and of the depth law on both sides.
    made.slack = 1e-3 * far_end_m + 1e-5 * (length(made.centre) + range);
    made.meets = sphere_meets_box(made.centre, range + made.slack, made.low, made.high);
    return made;
}

#if PARTICLES
bool reaches(uint index, Cluster cluster) {
    vec4 sphere = particles[index].position_radius;
    return approach(sphere.xyz, sphere.w, cluster).meets;
}
#else
bool reaches(uint index, Cluster cluster) {
    GpuLight light = lights[index];
    float range = light.position_range.w;
    Approach near = approach(light.position_range.xyz, range, cluster);
    if (!near.meets) {
        return false;
    }
    if (light.intensity_type.w < 0.5 || light.cone.x <= 0.0) {
        return true;
    }
    float cos_angle = clamp(-light.cone.y / light.cone.x, 0.0, 1.0);
    vec3 axis = transpose(mat3(u.render_from_view)) * light.direction_radius.xyz;
    float radius = 0.5 * length(near.high - near.low) + near.slack + 1e-3 * range;
    return cone_meets_sphere(near.centre, axis, cos_angle, range, 0.5 * (near.low + near.high), radius);
}
#endif

// One invocation a word of a mask, a row of them a slab; the first ones also copy the lights for the passes that read
// them as uniforms.
void main() {
    uvec2 id = gl_GlobalInvocationID.xy;
#if !PARTICLES
    if (id.y == 0u && id.x < min(clusters.grid.w, TYNDALL_COMPACT_LIGHT_COUNT)) {
        compact_lights[id.x] = lights[id.x];
    }
#endif
    uint word = id.x % clusters.block.w;
    uint column_index = id.x / clusters.block.w;
    uvec3 counts = clusters.counts.xyz;
    if (column_index >= counts.x * counts.y) {
        return;
    }
    uvec3 c = uvec3(column_index % counts.x, column_index / counts.x, id.y);
    uvec3 first = c * clusters.block.xyz;
    uvec3 end = min(first + clusters.block.xyz, clusters.grid.xyz);
    // A column reaches half way to its neighbours.
    ClusterColumn column = ClusterColumn(uv_of_column(u.volume, vec2(first.xy) - 0.5),
                                         uv_of_column(u.volume, vec2(end.xy) - 0.5));
    Cluster cluster = Cluster(column, boundary_depth(u.volume, float(first.z)), boundary_depth(u.volume, float(end.z)),
                              c.z + 1u == counts.z);

    uint mask = 0u;
    uint base = 32u * word;
    uint count = min(32u, clusters.grid.w - base);
    for (uint i = 0u; i < count; ++i) {
        if (reaches(base + i, cluster)) {
            mask |= 1u << i;
        }
    }
    masks[(id.y * counts.x * counts.y + column_index) * clusters.block.w + word] = mask;
}
