// Where a vertex is. The depth pre-pass and the forward passes share these expressions, so that their depths agree to the
// bit.
#ifndef TYNDALL_SHADERS_ENGINE_GEOMETRY_GLSL
#define TYNDALL_SHADERS_ENGINE_GEOMETRY_GLSL

#include "engine/renderer_interop.h"

layout(set = 0, binding = 1, std430) readonly restrict buffer Instances { GpuInstance instances[]; };

vec3 render_position(vec3 object_position) {
    GpuInstance instance = instances[gl_InstanceIndex];
    vec4 p = vec4(object_position, 1.0);
    return vec3(dot(instance.render_from_object[0], p), dot(instance.render_from_object[1], p),
                dot(instance.render_from_object[2], p));
}

#endif
