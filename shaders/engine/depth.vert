// Depth alone: of the view (SHADOW 0), of one of the sun's cascades (SHADOW 1) or of a local light's shadow map (SHADOW 2).
// MASK 1 passes on what alpha needs.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "engine/geometry.glsl"

#if SHADOW == 2
#include "common/local_shadow.glsl"
layout(set = 0, binding = 0, std430) readonly restrict buffer LocalShadows { LocalShadow local_shadows[]; };
layout(push_constant) uniform Push { uint record; uint side; };
#elif SHADOW
#include "common/sun_shadow.h"
layout(set = 0, binding = 0) uniform Sun { SunCascades sun; };
layout(push_constant) uniform Push { uint cascade; };
#else
layout(set = 0, binding = 0) uniform Frame { FrameParameters frame; };
#endif

layout(location = 0) in vec3 position;
#if MASK
layout(location = 3) in vec4 uv;
layout(location = 4) in vec4 color;
layout(location = 0) out vec4 surface_uv;
layout(location = 1) out float surface_alpha;
#endif

invariant gl_Position;

void main() {
    vec3 p = render_position(position);
#if SHADOW == 2
    LocalShadow shadow = local_shadows[record];
    vec3 v = local_shadow_view(shadow, float(side), local_shadow_space(shadow, p));
    gl_Position = vec4(v.xy * (2.0 * shadow.lens.x), shadow.lens.y, v.z);
#elif SHADOW
    vec3 s = (sun.shadow_from_render[cascade] * vec4(p, 1.0)).xyz;
    gl_Position = vec4(s.xy * 2.0 - 1.0, s.z, 1.0);
#else
    gl_Position = frame.clip_from_render * vec4(p, 1.0);
#endif
#if MASK
    surface_uv = uv;
    surface_alpha = color.a;
#endif
}
