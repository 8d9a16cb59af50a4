// What the renderer tells its shaders; the same structs in GLSL and C++.
#ifndef TYNDALL_SHADERS_ENGINE_RENDERER_INTEROP_H
#define TYNDALL_SHADERS_ENGINE_RENDERER_INTEROP_H

#include "../common/interop.h"
#include "../common/light_medium.h"

TYNDALL_INTEROP_BEGIN

// One view at one time. Colours are radiance, cd/m^2.
struct FrameParameters {
    mat4 clip_from_render; // y down, reverse z
    vec4 depth_row;        // view depth of a point p is dot(xyz, p) + w, m
    vec4 to_eye;           // from a point p to the eye: xyz - w p, not of unit length
    vec4 ray_origin;       // xyz: direction through uv = 0; w: largest radiance that is written
    vec4 ray_u;            // xyz: change of that direction over the image's width
    vec4 ray_v;            // xyz: over its height
    vec4 size;             // xy: image, px; zw: reciprocals
    vec4 ambient_up;       // rgb: radiance from above; w: number of fill lights
    vec4 ambient_down;     // rgb: radiance from below; w: number of local lights
    vec4 sky_zenith;       // rgb, background
    vec4 sky_horizon;      // rgb
    vec4 sky_ground;       // rgb
    vec4 sun_direction;    // xyz: unit, in which it travels
    vec4 sun_illuminance;  // rgb lux; 0 without a sun
    LightMedium medium;    // that light comes through
    vec4 fill_direction[3];
    vec4 fill_illuminance[3];
};

// An instance's place. Rows of affine matrices.
struct GpuInstance {
    vec4 render_from_object[3];
    vec4 normal_from_object[3]; // xyz: rows of the cofactor matrix up to a factor; w of the first: 1, mirrored -1
};

// Texture slots: 0 base colour, 1 metallic-roughness, 2 normal, 3 occlusion, 4 emission, 5 specular, 6 specular colour.
struct GpuMaterial {
    vec4 base_color;
    vec4 emission_cutoff; // rgb radiance; w: alpha below which there is nothing (mask)
    vec4 surface;         // x metallic, y roughness, z normal scale, w occlusion strength
    vec4 specular;        // rgb colour factor, w factor
    vec4 uv_rows[14];     // of each slot: u' = dot(row.xyz, (u, v, 1)), v' likewise; w of the first: uv set
};

TYNDALL_INTEROP_END

#endif
