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

} // namespace tyndall::volumetrics
