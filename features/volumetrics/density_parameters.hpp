// What the shaders read of noise and of the density map: pure functions.
#pragma once

#include "features/volumetrics/frame_inputs.hpp"
#include "shaders/volumetrics/interop.h"

namespace tyndall::volumetrics {

void write_noise(const FrameInputs& frame, gpu::VolumetricParameters& u);
void write_map(const FrameInputs& frame, gpu::VolumetricParameters& u);

} // namespace tyndall::volumetrics
