// A material's factors and textures. Which textures there are is a specialization constant, so that a material pays for
// what it has.
#ifndef TYNDALL_SHADERS_ENGINE_MATERIAL_GLSL
#define TYNDALL_SHADERS_ENGINE_MATERIAL_GLSL

#include "engine/renderer_interop.h"

// Bit i: texture slot i is there. Others as in engine/scene_gpu.hpp.
layout(constant_id = 0) const uint features = 0u;

const uint base_color_slot = 0u;
const uint surface_slot = 1u;
const uint normal_slot = 2u;
const uint occlusion_slot = 3u;
const uint emission_slot = 4u;
const uint specular_slot = 5u;
const uint specular_color_slot = 6u;
const uint feature_unlit = 128u;
const uint feature_uv_transform = 256u; // some texture has a transform or the second set of coordinates
const uint feature_vertex_color = 512u;
const uint feature_additive = 1024u;

layout(set = 1, binding = 0) uniform Material { GpuMaterial material; };
layout(set = 1, binding = 1) uniform sampler2D base_color_texture;
layout(set = 1, binding = 2) uniform sampler2D surface_texture;
layout(set = 1, binding = 3) uniform sampler2D normal_texture;
layout(set = 1, binding = 4) uniform sampler2D occlusion_texture;
layout(set = 1, binding = 5) uniform sampler2D emission_texture;
layout(set = 1, binding = 6) uniform sampler2D specular_texture;
layout(set = 1, binding = 7) uniform sampler2D specular_color_texture;

bool has(uint feature) { return (features & feature) != 0u; }
bool has_texture(uint slot) { return has(1u << slot); }

// `uv` holds both sets of coordinates.
vec2 slot_uv(uint slot, vec4 uv) {
    if (!has(feature_uv_transform)) {
        return uv.xy;
    }
    vec4 row_u = material.uv_rows[2u * slot];
    vec3 p = vec3(row_u.w > 0.5 ? uv.zw : uv.xy, 1.0);
    return vec2(dot(row_u.xyz, p), dot(material.uv_rows[2u * slot + 1u].xyz, p));
}

#endif
