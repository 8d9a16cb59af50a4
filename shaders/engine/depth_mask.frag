// Leaves out what a mask material does not cover.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "engine/material.glsl"

layout(location = 0) in vec4 surface_uv;
layout(location = 1) in float surface_alpha;

void main() {
    float alpha = material.base_color.a * surface_alpha;
    if (has_texture(base_color_slot)) {
        alpha *= texture(base_color_texture, slot_uv(base_color_slot, surface_uv)).a;
    }
    if (alpha < material.emission_cutoff.w) {
        discard;
    }
}
