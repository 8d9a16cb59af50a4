// How the fog of a medium is computed. Every value has a documented domain, which `validate`
// holds; inside it every stored value is finite.
#pragma once

#include <array>
#include <cstdint>

#include <tl/expected.hpp>

#include "features/volumetrics/error.hpp"
#include "features/volumetrics/grid_settings.hpp"
#include "features/volumetrics/lighting_settings.hpp"
#include "features/volumetrics/medium.hpp"

namespace tyndall::volumetrics {

enum class StorageFormat : std::uint8_t { fp16, fp32 };

struct ShadowSettings {
    std::array<float, 4> esm_exponent{400.0F, 400.0F, 400.0F, 400.0F}; ///< per cascade and unit of depth, [1, 1000]
    std::uint32_t esm_size = 256; ///< texels of a side; halved until it is at most half of a cascade's; [16, 2048]
};

struct TemporalSettings {
    bool enabled = true;
    float new_frame_weight = 0.05F; ///< steady weight of a new frame; until then the mean of all frames; [0.001, 1]
    bool jitter = true;             ///< sample at a place in the froxel that changes each frame, else at its centre
};

struct Settings {
    GridSettings grid;
    ShadowSettings shadow;
    TemporalSettings temporal;
    StorageFormat storage = StorageFormat::fp16;
    Integrator integrator = Integrator::exponential;
    VisibilitySettings visibility;
    AirlightSettings airlight;
    LightPath light_path = LightPath::closed_form;
    std::uint32_t light_path_steps = 8; ///< of march along each way, [1, 64]
    bool error_estimate = false;        ///< the integrator's own, beside the image (StageResources::error_estimate)
    bool clusters = true;               ///< false: every froxel visits every light
    bool async_compute = false;         ///< the compute passes ask for async compute; else the scheduler decides
};

/// The first value outside its domain, by its key in the fog file ("grid.range_m must be ...").
[[nodiscard]] tl::expected<void, Error> validate(const Settings& settings);

} // namespace tyndall::volumetrics
