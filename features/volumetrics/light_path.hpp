// What weakens light on its way, and how it is computed: pure functions of medium and settings.
#pragma once

#include <cstdint>

#include "features/volumetrics/settings.hpp"
#include "shaders/common/light_medium.h"

namespace tyndall::volumetrics {

/// Whether light arrives weakened, so that a host's surfaces must be lit through the same air: see LightPath.
[[nodiscard]] bool weakens_light(const Medium& medium, const Settings& settings);

/// What shaders/common/light_march.glsl follows beyond the closed forms.
struct LightMarch {
    bool volumes = false;
    std::uint32_t octaves = 0; ///< of noise; that of baked volumes counts as its mean
    std::uint32_t steps = 1;   ///< along each way

    [[nodiscard]] bool is_needed() const { return volumes || octaves > 0; }
    friend bool operator==(const LightMarch&, const LightMarch&) = default;
};
[[nodiscard]] LightMarch light_march(const Medium& medium, const Settings& settings);

/// For a host's own lit surfaces, by shaders/common/light_march.glsl: the constants and the block that it wants.
struct LightWay {
    bool colored = false; ///< extinction differs between the channels
    LightMarch march;
    gpu::LightMedium medium; ///< in the view's render space
};

} // namespace tyndall::volumetrics
