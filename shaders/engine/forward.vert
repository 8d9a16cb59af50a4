#version 460
#extension GL_GOOGLE_include_directive : require

#include "engine/geometry.glsl"

layout(set = 0, binding = 0) uniform Frame { FrameParameters frame; };

layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal;
layout(location = 2) in vec4 tangent;
layout(location = 3) in vec4 uv; // both sets
layout(location = 4) in vec4 color;

layout(location = 0) out vec3 surface_position; // render space
layout(location = 1) out vec3 surface_normal;   // render space, not of unit length
layout(location = 2) out vec4 surface_tangent;  // w: sign of the bitangent
layout(location = 3) out vec4 surface_uv;
layout(location = 4) out vec4 surface_color;

invariant gl_Position;

void main() {
    vec3 p = render_position(position);
    gl_Position = frame.clip_from_render * vec4(p, 1.0);
    surface_position = p;
    GpuInstance instance = instances[gl_InstanceIndex];
    surface_normal = vec3(dot(instance.normal_from_object[0].xyz, normal.xyz),
                          dot(instance.normal_from_object[1].xyz, normal.xyz),
                          dot(instance.normal_from_object[2].xyz, normal.xyz));
    surface_tangent = vec4(dot(instance.render_from_object[0].xyz, tangent.xyz),
                           dot(instance.render_from_object[1].xyz, tangent.xyz),
                           dot(instance.render_from_object[2].xyz, tangent.xyz),
                           tangent.w * instance.normal_from_object[0].w);
    surface_uv = uv;
    surface_color = color;
}
