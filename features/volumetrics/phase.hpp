// Into which directions the fog scatters light.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace tyndall::volumetrics {

/// Of integral 1 over the sphere; formulas and sources in shaders/volumetrics/phase.glsl.
enum class PhaseFunction : std::uint8_t { isotropic, rayleigh, henyey_greenstein, schlick, cornette_shanks };

/// A part of the light is scattered so. `g` > 0 scatters forward; isotropic and Rayleigh ignore it.
struct PhaseLobe {
    PhaseFunction function = PhaseFunction::isotropic;
    float g = 0.0F;      ///< asymmetry of Henyey-Greenstein and Cornette-Shanks, k of Schlick; [-0.999, 0.999]
    float weight = 1.0F; ///< [0, 1]; of all lobes together more than 0, and divided by their sum
};

/// Up to four lobes.
struct PhaseLobes {
    static constexpr std::uint32_t most = 4;
    std::array<PhaseLobe, most> lobes{};
    std::uint32_t count = 0;

    [[nodiscard]] std::span<const PhaseLobe> all() const { return std::span(lobes).first(count); }
};

/// Mean cosine of the angle of scattering: the first coefficient of the function's Legendre series over the zeroth.
[[nodiscard]] double mean_cosine(const PhaseLobe& lobe);
/// Weighted by the lobes' weights.
[[nodiscard]] double mean_cosine(const PhaseLobes& phase);

/// Largest value, per steradian.
[[nodiscard]] double peak(const PhaseLobe& lobe);
[[nodiscard]] double peak(const PhaseLobes& phase);

/// A bound of how fast the function's logarithm changes with the angle, 1/rad.
[[nodiscard]] double steepness(const PhaseLobe& lobe);
[[nodiscard]] double steepness(const PhaseLobes& phase);

/// A lobe's function as (constant + squared cos^2(theta)) s^-p with s = spread + chord c^2, where c is the chord from
/// the function's peak and p is 2 for Schlick and 3/2 for the others.
struct PhaseForm {
    double constant = 0.0;
    double squared = 0.0;
    double spread = 1.0;
    double chord = 0.0;
};
[[nodiscard]] PhaseForm phase_form(const PhaseLobe& lobe);

/// What shaders/volumetrics/phase.glsl is specialised to.
[[nodiscard]] std::uint32_t packed_functions(const PhaseLobes& phase);

} // namespace tyndall::volumetrics
