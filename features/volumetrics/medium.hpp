// The medium that fills the scene. Every value has a documented domain, which `validate` holds; inside it every stored
// value is finite.
#pragma once

#include <glm/vec3.hpp>
#include <tl/expected.hpp>

#include "features/volumetrics/error.hpp"

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

/// The first value outside its domain, by its key in the fog file ("phase.g must be ...").
[[nodiscard]] tl::expected<void, Error> validate(const Medium& medium);

} // namespace tyndall::volumetrics
