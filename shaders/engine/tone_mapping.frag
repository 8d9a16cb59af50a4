// Radiance -> exposed, tone mapped, sRGB-encoded, dithered to 8 bits. AUTOMATIC 1: the exposure comes from a buffer.
#version 460

layout(set = 0, binding = 0) uniform sampler2D scene_color; // texels are fetched
#if AUTOMATIC
layout(set = 0, binding = 1, std430) readonly restrict buffer Exposure { vec4 exposure; };
#else
layout(push_constant) uniform Push { float exposure; };
#endif

layout(location = 0) out vec4 color;

// Khronos PBR Neutral (Khronos Group 2024): leaves base colours below 0.8 as they are, compresses what is brighter toward
// 1 and desaturates it. Its constants are those of the specification.
vec3 pbr_neutral(vec3 c) {
    const float compression_start = 0.8 - 0.04;
    const float desaturation = 0.15;
    float smallest = min(c.r, min(c.g, c.b));
    c -= smallest < 0.08 ? smallest - 6.25 * smallest * smallest : 0.04; // the reflection of a surface of index 1.5
    float peak = max(c.r, max(c.g, c.b));
    if (peak < compression_start) {
        return c;
    }
    const float room = 1.0 - compression_start;
    float compressed = 1.0 - room * room / (peak + room - compression_start);
    float whitening = 1.0 - 1.0 / (desaturation * (peak - compressed) + 1.0);
    return mix(c * (compressed / peak), vec3(compressed), whitening);
}

// IEC 61966-2-1.
vec3 srgb_encode(vec3 c) {
    return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, lessThanEqual(c, vec3(0.0031308)));
}

// Interleaved gradient noise (Jimenez, Next Generation Post Processing in Call of Duty: Advanced Warfare, 2014): in
// [0, 1), evenly spread over every neighbourhood.
float gradient_noise(vec2 pixel) { return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))); }

void main() {
#if AUTOMATIC
    float scale = exposure.x;
#else
    float scale = exposure;
#endif
    vec3 radiance = texelFetch(scene_color, ivec2(gl_FragCoord.xy), 0).rgb * scale;
    vec3 encoded = srgb_encode(clamp(pbr_neutral(clamp(radiance, 0.0, 1e6)), 0.0, 1.0));
    // Half a step up or down before rounding: smooth gradients turn into fine noise instead of bands.
    color = vec4(encoded + (gradient_noise(gl_FragCoord.xy) - 0.5) / 255.0, 1.0);
}
