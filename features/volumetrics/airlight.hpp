// Lights that shine into rays near them more finely than a grid of froxels can hold, and are integrated along the ray
// of each pixel instead: which ones, and what the shaders are told of them. Pure functions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "features/volumetrics/frame_inputs.hpp"
#include "shaders/volumetrics/interop.h"

namespace tyndall::volumetrics {

struct FrameMemory;

struct AirlightChoice {
    std::vector<std::uint32_t>
        lights;          ///< places in FrameInputs::lights, ascending; AirlightSettings::max_lights at most
    std::string why_not; ///< the other lights stay in the froxels; empty where there is none
};

/// The brightest, as the eye sees them through the fog, of those that have a ray of the view within a few froxels'
/// widths; a spot counts as much nearer as its cone is narrow. A light that was chosen before stays so until it is
/// half as far outside again, or another is half as bright again. None in a medium without a closed form, with noise or
/// local volumes, or whose extinction differs between the channels.
[[nodiscard]] AirlightChoice choose_airlights(const FrameInputs& frame, const std::optional<FrameMemory>& before);

/// The lights as the froxels see them: those that they leave out are dark.
[[nodiscard]] std::vector<gpu::GpuLight> froxel_lights(const FrameInputs& frame, const AirlightChoice& choice);

[[nodiscard]] gpu::Airlights airlights(const FrameInputs& frame, const AirlightChoice& choice);

/// VolumetricParameters::kept_lights.
void write_kept_lights(const AirlightChoice& choice, gpu::VolumetricParameters& u);

/// What the pipelines that add their light are specialised to (shaders/common/airlight.h): 0 where no light is chosen.
[[nodiscard]] std::uint32_t airlight_features(const FrameInputs& frame, const AirlightChoice& choice);

} // namespace tyndall::volumetrics
