// How volumes are stored: STORAGE_FP16 = 1 gives rgba16f, 0 gives rgba32f.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_STORAGE_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_STORAGE_GLSL

#if STORAGE_FP16
#define VOLUME_FORMAT rgba16f
const float largest_storable = 65504.0;
#else
#define VOLUME_FORMAT rgba32f
const float largest_storable = 1e30;
#endif

// By exponent bits: no compiler option that assumes finite arithmetic removes it.
bool is_finite(vec4 v) {
    uvec4 exponent = floatBitsToUint(v) & 0x7f800000u;
    return all(notEqual(exponent, uvec4(0x7f800000u)));
}

// The nearest value that the format holds, finite. Software drivers truncate in imageStore; a value that is already
// representable passes unchanged.
vec4 storable(vec4 v) {
    v = clamp(v, -largest_storable, largest_storable);
#if STORAGE_FP16
    v = vec4(unpackHalf2x16(packHalf2x16(v.xy)), unpackHalf2x16(packHalf2x16(v.zw)));
#endif
    return v;
}

// Rounds up or down at random (`bits`, uniform), in proportion to the distance: a running mean stored so does not stall
// where its step is below half a unit of the last place. Age in alpha is a small whole number or a mean of such.
vec4 storable_unbiased(vec4 v, uint bits) {
#if STORAGE_FP16
    uvec3 noise = uvec3(bits, bits >> 10u, bits >> 19u) & 0x1fffu; // the 13 bits of mantissa that fp16 lacks
    v.rgb = uintBitsToFloat((floatBitsToUint(clamp(v.rgb, 0.0, largest_storable)) + noise) & 0xffffe000u);
#endif
    return storable(v);
}

#endif
