// Visibility from the exponential shadow map.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_ESM_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_ESM_GLSL

// Visibility at a point of the shadow map's space: the bilinear mean of e^(k z), over e^(k receiver), at most 1. The
// sampler would filter the logarithms that `esm` holds, so four texels are fetched and combined here; taken relative to
// the receiver the exponents cannot overflow where it matters, and beyond e^60 the point is lit whatever the weight.
// `size` is the ESM's side in texels and the reciprocal.
float esm_visibility(sampler2DArray esm, vec3 uv_layer, float k_receiver, vec2 size) {
    vec2 p = uv_layer.xy * size.x - 0.5;
    vec2 corner = floor(p);
    vec2 f = p - corner;
    // At the corner that the four texels share, the gather is the same whatever the sampler's rounding.
    vec4 logs = textureGather(esm, vec3((corner + 1.0) * size.y, uv_layer.z)); // (0,1) (1,1) (1,0) (0,0)
    vec4 weights = vec4((1.0 - f.x) * f.y, f.x * f.y, f.x * (1.0 - f.y), (1.0 - f.x) * (1.0 - f.y));
    return min(dot(weights, exp(min(logs - k_receiver, 60.0))), 1.0);
}

#endif
