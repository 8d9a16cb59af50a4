// The medium that fills the scene and how finely it is computed. Every value has a documented domain, which `validate`
// holds; inside it every stored value is finite.
#pragma once

#include <array>
#include <cstdint>

#include <glm/vec3.hpp>
#include <tl/expected.hpp>

#include "features/volumetrics/error.hpp"
#include "features/volumetrics/lighting_settings.hpp"

namespace tyndall::volumetrics {

/// The same density everywhere.
struct HomogeneousFog {
    float extinction_per_m = 0.0F; ///< [0, 1e6]
    glm::vec3 albedo{1.0F};        ///< part of the extinction that is scattered, each in [0, 1]
};

/// Extinction at and below the base, falling off above it as e^(-falloff (y - base)), y up.
struct HeightFog {
    float extinction_per_m = 0.0F; ///< at the base, [0, 1e6]
    glm::vec3 albedo{1.0F};        ///< each in [0, 1]
    float base_height_m = 0.0F;    ///< world height, [-1e6, 1e6]
    float falloff_per_m = 0.1F;    ///< [0, 1e3]
};

/// One octave of gradient noise by which the density of all fog is multiplied: 1 + amplitude * noise, noise in [-1, 1].
struct DensityNoise {
    float amplitude = 0.0F;   ///< [0, 1]; 0: no noise
    float scale_m = 4.0F;     ///< size of a noise cell, [1e-3, 1e6]
    glm::vec3 wind_m_s{0.0F}; ///< velocity with which the pattern moves, each in [-1e3, 1e3]
};

struct Medium {
    HomogeneousFog homogeneous;
    HeightFog height;
    DensityNoise noise;
    float phase_g = 0.0F;             ///< Henyey-Greenstein asymmetry, [-0.999, 0.999]; > 0 scatters forward
    glm::vec3 ambient_radiance{0.0F}; ///< cd/m^2 from every direction, each in [0, 1e9]
};

/// Neither scatters nor absorbs anywhere.
[[nodiscard]] bool is_empty(const Medium& medium);

enum class StorageFormat : std::uint8_t { fp16, fp32 };

/// The froxel grid: columns over the image, slices over view depth (see shaders/common/depth_law.h).
struct GridSettings {
    std::uint32_t width = 160; ///< [1, 1024]
    std::uint32_t height = 90; ///< [1, 1024]
    std::uint32_t slices = 64; ///< [1, 512]
    float range_m = 64.0F;     ///< view depth of the last boundary, [1e-2, 1e7]
    float shape_m = 16.0F;     ///< small: slices gather at the eye; large: evenly spread; [1e-4, 100] times the range
};

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
    bool error_estimate = false; ///< the integrator's own, beside the image (StageResources::error_estimate)
    bool clusters = true;        ///< false: every froxel visits every light
    bool async_compute = false;  ///< the compute passes ask for async compute; else the scheduler decides
};

/// The first value outside its domain, by its key in the fog file ("grid.range_m must be ...").
[[nodiscard]] tl::expected<void, Error> validate(const Medium& medium);
[[nodiscard]] tl::expected<void, Error> validate(const Settings& settings);

} // namespace tyndall::volumetrics
