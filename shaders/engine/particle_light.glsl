// The light that a particle sends to the eye per unit of albedo where there is no scattering volume: what arrives from
// sun, lights and ambient, scattered alike in all directions. Included by particle.vert, whose `frame` it reads.
#ifndef TYNDALL_SHADERS_ENGINE_PARTICLE_LIGHT_GLSL
#define TYNDALL_SHADERS_ENGINE_PARTICLE_LIGHT_GLSL

#if SUN_SHADOW
#include "common/sun_shadow.h"
layout(set = 0, binding = 4) uniform Sun { SunCascades sun; };
layout(set = 0, binding = 5) uniform sampler2DArray cascades; // depth, nearest
#endif
#if LIGHTS
#include "common/lights.glsl"
layout(set = 0, binding = 6, std430) readonly restrict buffer Lights { GpuLight lights[]; };
#endif
#if LOCAL_SHADOW
#include "common/local_shadow.glsl"
layout(set = 0, binding = 7) uniform sampler2DArray local_shadow_maps; // depth, nearest, clamps
layout(set = 0, binding = 8, std430) readonly restrict buffer LocalShadows { LocalShadow local_shadows[]; };
#endif

const float isotropic_phase = 0.0795774715; // 1 / (4 pi), per steradian

#if SUN_SHADOW
// Share of the four nearest texels whose occluder does not lie before the point; 1 where no cascade holds the point. The
// first cascade that reaches the depth and contains the point decides. The air needs no bias: nothing shadows itself.
float particle_sun_visibility(vec3 position, float depth_m) {
    for (int cascade = 0; cascade < int(sun.direction_count.w); ++cascade) {
        vec3 p = (sun.shadow_from_render[cascade] * vec4(position, 1.0)).xyz;
        bool inside = all(greaterThanEqual(p.xy, vec2(0.0))) && all(lessThanEqual(p.xy, vec2(1.0)));
        if (depth_m <= sun.split_depth_m[cascade] && inside) {
            vec4 occluders = textureGather(cascades, vec3(p.xy, cascade));
            return dot(vec4(greaterThanEqual(occluders, vec4(clamp(p.z, 0.0, 1.0)))), vec4(0.25));
        }
    }
    return 1.0;
}
#endif

vec3 particle_light(vec3 position, float depth_m) {
    float visibility = 1.0;
#if SUN_SHADOW
    visibility = particle_sun_visibility(position, depth_m);
#endif
    vec3 irradiance = frame.sun_illuminance.rgb * visibility;
#if LIGHTS
    for (uint i = 0u; i < frame.counts.w; ++i) {
        vec3 to_light;
        vec3 arriving = light_irradiance_normal(lights[i], position, to_light);
#if LOCAL_SHADOW
        if (casts_local_shadow(lights[i].cone)) {
            arriving *= local_visibility(local_shadows[local_shadow_index(lights[i].cone)], local_shadow_maps, position);
        }
#endif
        irradiance += arriving;
    }
#endif
    return irradiance * isotropic_phase + frame.ambient.rgb;
}

#endif
