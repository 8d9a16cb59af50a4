// Cheap trigonometry of what geometry makes, of known accuracy on every driver.
#ifndef TYNDALL_SHADERS_COMMON_SMALL_ANGLES_GLSL
#define TYNDALL_SHADERS_COMMON_SMALL_ANGLES_GLSL

// atan(y, x) for y > 0, to 8e-7: Chebyshev fit of atan(r) / r on [0, 1] in r^2.
float positive_atan(float y, float x) {
    float ax = abs(x);
    float r = min(ax, y) / max(ax, y);
    float s = r * r;
    float p = r * (0.99999923 + s * (-0.33325678 + s * (0.19872040 + s * (-0.13447864 +
                                          s * (0.08312645 + s * (-0.03636043 + s * 0.00764835))))));
    p = y > ax ? 1.57079633 - p : p;
    return x < 0.0 ? 3.14159265 - p : p;
}

// sin(x) for |x| <= pi / 2, to 4e-6: its Taylor series.
float sine(float x) {
    float s = x * x;
    return x * (1.0 - s * (1.0 / 6.0 - s * (1.0 / 120.0 - s * (1.0 / 5040.0 - s * (1.0 / 362880.0)))));
}
vec4 sine(vec4 x) {
    vec4 s = x * x;
    return x * (1.0 - s * (1.0 / 6.0 - s * (1.0 / 120.0 - s * (1.0 / 5040.0 - s * (1.0 / 362880.0)))));
}

#endif
