// The part of a ray that one froxel sees.
#ifndef TYNDALL_SHADERS_VOLUMETRICS_RAY_SEGMENT_GLSL
#define TYNDALL_SHADERS_VOLUMETRICS_RAY_SEGMENT_GLSL

// A sample on the ray, and how far the slice reaches on both sides of it.
struct RaySegment {
    vec3 position;  // render space
    vec3 to_eye;    // unit
    float behind_m; // from the sample toward the eye, >= 0
    float ahead_m;  // and away from it
};

#endif
