// How light is integrated: along a slice, through shadows, and beside the brightest lights.
#pragma once

#include <cstdint>

namespace tyndall::volumetrics {

/// One slice of the ray (shaders/volumetrics/integrators.glsl). The order is that of the error in the length of a
/// slice, in a smooth medium.
enum class Integrator : std::uint8_t {
    euler,                 ///< Wronski 2014: the transmittance at the near side holds for the whole slice; order 1
    half_slice,            ///< Kosian 2020: the transmittance at half of the slice's optical depth; order 2
    exponential,           ///< Hillaire 2015: exact where medium and source are constant over the slice; order 2
    exponential_quadratic, ///< the source is a parabola in optical depth through neighbouring slices; order 4
};

/// How much of a slice of the ray the sun lights (shaders/volumetrics/slice_visibility.glsl).
enum class SunVisibility : std::uint8_t {
    one_tap,      ///< the cascade's texel at the froxel's sample
    n_taps,       ///< the mean of several such along the slice
    prefiltered,  ///< the exponential shadow map at the froxel's sample
    lit_fraction, ///< the part of the slice that is lit, from every texel that it crosses
};

/// What the medium takes from light on its way to a froxel or a surface (shaders/common/light_march.glsl).
enum class LightPath : std::uint8_t {
    none,        ///< nothing: all light arrives
    closed_form, ///< homogeneous and height fog, exactly; not their noise, and not the local volumes
    march,       ///< these and, by a march along the way, local volumes and noise
};

/// Lights that are integrated along the ray of each pixel and not in the froxels (airlight.hpp).
struct AirlightSettings {
    std::uint32_t max_lights = 4; ///< [0, 32]
};

struct VisibilitySettings {
    SunVisibility method = SunVisibility::one_tap;
    std::uint32_t taps = 4; ///< of n_taps, [1, 64]
};

} // namespace tyndall::volumetrics
