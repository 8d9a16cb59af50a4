// Density and in-scattered radiance -> radiance toward the eye (rgb) and optical depth (a) at the N + 1 slice
// boundaries, the eye's own (0, 0) included. Serial along each column.
//
// Per slice of ray length dt: x = sigma_t dt,  L += T dt j phi1(x),  T *= e^-x,  tau += x: exact for a constant
// medium, no division by sigma, and a convex combination, so bounded by the brightest source whatever x.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "volumetrics/froxel.glsl"
#include "volumetrics/interop.h"
#include "volumetrics/storage.glsl"

layout(local_size_x_id = 0, local_size_y_id = 1, local_size_z_id = 2) in;

layout(set = 0, binding = 0) uniform Parameters { VolumetricParameters u; };
layout(set = 0, binding = 1, VOLUME_FORMAT) uniform readonly restrict image3D density;
layout(set = 0, binding = 2, VOLUME_FORMAT) uniform readonly restrict image3D in_scattered;
layout(set = 0, binding = 3, VOLUME_FORMAT) uniform writeonly restrict image2DArray accumulated;

void main() {
    ivec2 column = ivec2(gl_GlobalInvocationID.xy);
    ivec3 grid = ivec3(u.volume.grid.xyz);
    if (any(greaterThanEqual(column, grid.xy))) {
        return;
    }
    vec2 uv = uv_of_column(u.volume, vec2(column));
    // Each slice is longer than the one before it by the same ratio.
    float dt = u.volume.slice.x * column_stretch(u.volume, uv) * u.density_scale.y;
    vec3 radiance = vec3(0.0);
    float tau = 0.0;
    float transmittance = 1.0;
    imageStore(accumulated, ivec3(column, 0), vec4(0.0));
    for (int k = 0; k < grid.z; ++k) {
        vec4 medium = imageLoad(density, ivec3(column, k));
        vec3 source = medium.rgb * imageLoad(in_scattered, ivec3(column, k)).rgb;
        float x = medium.a * dt;
        float attenuation = exp(-x);
        radiance += source * (transmittance * dt * phi1(x, attenuation));
        tau += x;
        transmittance *= attenuation;
        imageStore(accumulated, ivec3(column, k + 1), storable(vec4(radiance, tau)));
        dt *= u.volume.slice.z;
    }
}
