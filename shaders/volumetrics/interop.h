// What every volumetric pass reads of the frame: one uniform buffer, the same struct in GLSL and C++.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_INTEROP_H
#define TYNDALL_SHADERS_VOLUMETRICS_INTEROP_H

#include "../common/airlight.h"
#include "../common/interop.h"
#include "../common/light_clusters.h"
#include "../common/lights.h"
#include "../common/local_volume.h"
#include "../common/scattering_volume.h"

TYNDALL_INTEROP_BEGIN

// At most as many lights that have changed since the frame before.
#define TYNDALL_LIGHT_CHANGE_COUNT 16

// Only so many lights, the first ones, may be left out of the froxels.
#define TYNDALL_AIRLIGHT_CANDIDATES 4096

struct VolumetricParameters {
    ScatteringVolume volume; // first, so that those who only look up bind the same buffer
    Airlights airlights;     // the lights that the froxels leave out; they look these up, too
    // The column of uv is the set of render-space points  z (ray_u u + ray_v v + ray_0) + (eye_u u + eye_v v + eye_0),
    // z the view depth, m; the second part is 0 for a perspective view.
    vec4 ray_u;
    vec4 ray_v;
    vec4 ray_0;
    vec4 eye_u;
    vec4 eye_v;
    vec4 eye_0;
    mat4 render_from_view;
    mat4 previous_view_from_view; // where a point of this frame's view space was in the frame before's
    vec4 homogeneous;     // rgb albedo; w: extinction, 1/m, times density_scale
    vec4 height;          // rgb albedo; w: extinction at and below the base, 1/m, times density_scale
    vec4 homogeneous_color; // rgb: extinction of each channel in parts of that, where some medium is coloured
    vec4 height_color;      // the same of the height fog
    vec4 homogeneous_emission; // rgb, cd/m^3, times emission_scale.x; a 0
    vec4 height_emission;      // the same at and below the base
    vec4 height_law;      // x: base height above the camera, m; y: falloff, 1/m; zw 0
    vec4 air;             // see common/light_attenuation.glsl
    vec4 air_heights;     // xy: there, too; zw 0
    // Of noise as octaves, of noise as volumes:
    vec4 noise_origin;    // xyz: the camera in noise cells, wind included, in [0, 256); w: amplitude of the first octave.
                          // Volumes: in periods of the shape, in [0, 1); w: amplitude
    vec4 noise_cells;     // x: cells per metre; y: amplitude of an octave over that of the one before; zw 0.
                          // Volumes: x: periods of the shape per metre
    vec4 noise_detail;    // xyz: the camera in periods of the detail, its wind included, in [0, 1); w: periods per metre
    vec4 noise_cover;     // cover by the shape's value s: x s + y; z: what the detail takes at most; w: 1 / mean
    vec4 map_place;       // the density map's place of the render-space point p: p.xz xy + zw
    vec4 map_profile;     // x: bottom, render space, m; y: 1 / fade, 1/m; z: top; w: texels per metre, the more of x and z
    vec4 density_scale;   // x: stored coefficients are true ones (1/m) times x; y: 1 / x; zw 0
    vec4 march;           // see common/light_march.glsl
    vec4 emission_scale;  // x: stored emission is the true one (cd/m^3) times x; y: stored emission times y has the unit of
                          // a stored coefficient times stored radiance; zw 0
    vec4 phase;           // x: bound of the change of its logarithm, 1/rad; yzw 0
    vec4 phase_asymmetry; // g or k of each lobe
    vec4 phase_weight;    // of each lobe, of sum 1
    vec4 temporal;        // x: steady weight of a new frame; y: oldest age, frames; z: history's radiance times z is in
                          // this frame's scale; w: part by which the light of every froxel may have changed since
    vec4 motion;          // xyz: the frame before's eye, render space, m; w: its distance, 0 for an orthographic view
    vec4 jitter;          // xyz: this frame's offset in [0, 1); w: 0 samples the centre of each froxel
    vec4 ambient;         // rgb radiance from every direction
    vec4 ambient_x;       // rgb: what scattering leaves of the part of ambient radiance that is proportional to the x of
    vec4 ambient_y;       // its direction; the same of y and z
    vec4 ambient_z;
    vec4 sun_direction;   // xyz: unit direction in which it travels, render space
    vec4 sun_illuminance; // rgb lux
    vec4 esm_exponents;   // k of each cascade, per unit of shadow depth
    vec4 esm_size;        // x: texels of a side of the ESM; y: 1 / x; z: texels of a side of a cascade; w: 1 / z
    vec4 depth;           // view depth of device depth d: (x - d y) / (z + d w)
    vec4 sky;             // x: device depth of the far plane, where there is no surface; yzw 0
    uvec4 kept_lights[TYNDALL_AIRLIGHT_CANDIDATES / 128]; // a bit a light: 0 where the froxels leave it out
    uvec4 frame;          // x: frames since the last cut; y: lights; z: local volumes; w: pairs of changed_lights
    GpuLocalVolume volumes[TYNDALL_LOCAL_VOLUME_COUNT]; // the first frame.z
    GpuLight changed_lights[2 * TYNDALL_LIGHT_CHANGE_COUNT]; // the first frame.w pairs: before, now
};

// Lights that fit the smallest uniform buffer that Vulkan allows, 16 KiB.
#define TYNDALL_COMPACT_LIGHT_COUNT 256

TYNDALL_INTEROP_END

#endif
