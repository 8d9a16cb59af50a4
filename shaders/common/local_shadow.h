// Shadow maps of point and spot lights: layers of one square D32_SFLOAT array. A spot light has one layer, a perspective
// view along its axis that holds its cone; a point light has six, one a side of a cube along the axes of render space.
// A texel holds near / z of the nearest caster, z being the distance along the view's axis: 1 at and before the near
// distance, 0 where there is none. It is affine along every line of the map, and floating point holds it as exactly far
// from the light as beside it.
#ifndef TYNDALL_SHADERS_COMMON_LOCAL_SHADOW_H
#define TYNDALL_SHADERS_COMMON_LOCAL_SHADOW_H

#include "interop.h"

TYNDALL_INTEROP_BEGIN

// Number n of the array belongs to the lights with GpuLight::cone.z = n + 1.
struct LocalShadow {
    vec4 row_x; // xyz . p + w: the render-space point p in the light's space, m: z along a spot's axis, x and y across;
    vec4 row_y; // the axes of render space for a point light
    vec4 row_z;
    vec4 lens;  // x: uv - 0.5 of a point with x / z = 1; y: near distance, m, within which nothing casts a shadow; z: its
                // first layer; w: 1 for a cube of six layers, in the order +x -x +y -y +z -z, 0 for one layer. u and v of
                // a side grow with the axes that follow its own: y and z, z and x, x and y
    vec4 texel; // x: width of a texel at a distance of 1 m, m; y: texels of a side; z: 1 / y; w 0
};

TYNDALL_INTEROP_END

#endif
