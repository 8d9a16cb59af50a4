// Densities from textures: the map over the ground and the grids of local volumes.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_DENSITY_TEXTURES_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_DENSITY_TEXTURES_GLSL

layout(set = 0, binding = 5) uniform sampler3D density_map; // one texel deep
layout(set = 0, binding = 6) uniform sampler3D grid_1;
layout(set = 0, binding = 7) uniform sampler3D grid_2;
layout(set = 0, binding = 8) uniform sampler3D grid_3;
layout(set = 0, binding = 9) uniform sampler3D grid_4;

// What the map leaves of the fog at a render-space point.
float map_density(vec3 p) {
    vec2 uv = p.xz * u.map_place.xy + u.map_place.zw;
    vec2 depth_in = vec2(p.y - u.map_profile.x, u.map_profile.z - p.y) * u.map_profile.y;
    vec2 inside = clamp(depth_in, 0.0, 1.0);
    return textureLod(density_map, vec3(uv, 0.5), 0.0).r * inside.x * inside.y;
}

// Its mean from `a` to `b`, twice a texel and at both ends of a profile's fading.
float mean_map_density(vec3 a, vec3 b) {
    vec3 way = b - a;
    float steps = max(length(way.xz) * u.map_profile.w, 4.0 * abs(way.y) * u.map_profile.y);
    float taps = clamp(ceil(2.0 * steps), 2.0, 16.0);
    float sum = 0.0;
    for (float i = 0.5; i < taps; i += 1.0) {
        sum += map_density(a + (i / taps) * way);
    }
    return sum / taps;
}

float grid_density(float grid, vec3 q) {
    vec3 uvw = 0.5 + 0.5 * q;
    if (grid < 1.5) {
        return textureLod(grid_1, uvw, 0.0).r;
    }
    if (grid < 2.5) {
        return textureLod(grid_2, uvw, 0.0).r;
    }
    return grid < 3.5 ? textureLod(grid_3, uvw, 0.0).r : textureLod(grid_4, uvw, 0.0).r;
}

float edge_weight(GpuLocalVolume volume, vec3 q);

// Mean weight of a volume with a grid from q to q + way, in the space where its shape reaches from -1 to 1, by two taps
// a texel.
float mean_grid_weight(GpuLocalVolume volume, vec3 q, vec3 way) {
    float taps = clamp(ceil(length(way * volume.grid.xyz)), 3.0, 24.0);
    float sum = 0.0;
    for (float i = 0.5; i < taps; i += 1.0) {
        vec3 at = q + (i / taps) * way;
        float edge = volume.edge_shape_blend.x > 0.0 ? edge_weight(volume, at) : 1.0;
        sum += edge * grid_density(volume.grid.w, at);
    }
    return sum / taps;
}

#endif
