// What light has changed since the frame before, so that history does not show it any longer: pure functions.
#pragma once

#include <vector>

#include "features/volumetrics/frame_inputs.hpp"
#include "shaders/volumetrics/interop.h"

namespace tyndall::volumetrics {

struct FrameMemory;

/// A light as it was and as it is, both in this frame's render space. One that came or went is paired with itself at
/// intensity 0.
struct LightChange {
    gpu::GpuLight before;
    gpu::GpuLight now;
};

/// The lights that differ, at most TYNDALL_LIGHT_CHANGE_COUNT pairs: where more do, the last pair stands for all the
/// rest, a light that goes out and reaches whatever they reach. A world position counts as equal within what single
/// precision makes of the way to the camera.
[[nodiscard]] std::vector<LightChange> light_changes(const FrameInputs& frame, const FrameMemory& before);

/// How much the light that a froxel scatters may have changed everywhere, in parts of itself, [0, 1]: sun, ambient and
/// phase function.
[[nodiscard]] float change_everywhere(const FrameInputs& frame, const FrameMemory& before);

} // namespace tyndall::volumetrics
