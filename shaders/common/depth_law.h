// How view depth is spread over slices: z(t) = s (2^(t log2(1 + R / s)) - 1), t in [0, 1], with range R and shape s in
// metres. z(0) = 0 whatever the near plane; nearly linear for large s.
#ifndef TYNDALL_SHADERS_COMMON_DEPTH_LAW_H
#define TYNDALL_SHADERS_COMMON_DEPTH_LAW_H

#include "interop.h"

TYNDALL_INTEROP_BEGIN

struct DepthLaw {
    vec4 range_shape; // x: R, m; y: s, m (s / R in [1e-4, 100]); z: ln(1 + R / s); w: 1 / z
};

TYNDALL_INTEROP_END

#endif
