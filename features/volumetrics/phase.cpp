#include "features/volumetrics/phase.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tyndall::volumetrics {
namespace {

template <typename Property>
double weighted_mean(const PhaseLobes& phase, Property property) {
    double sum = 0.0;
    double weights = 0.0;
    for (const PhaseLobe& lobe : phase.all()) {
        sum += static_cast<double>(lobe.weight) * property(lobe);
        weights += static_cast<double>(lobe.weight);
    }
    return sum / weights;
}

} // namespace

double mean_cosine(const PhaseLobe& lobe) {
    const double g = static_cast<double>(lobe.g);
    switch (lobe.function) {
    case PhaseFunction::henyey_greenstein: return g;
    case PhaseFunction::schlick:
        // Near 0 by the first terms of its series, where the closed form cancels.
        return std::abs(g) < 0.02 ? g * (2.0 / 3.0 + g * g * (2.0 / 15.0))
                                  : 1.0 / g - (1.0 / (g * g) - 1.0) * std::atanh(g);
    case PhaseFunction::cornette_shanks: return g * 3.0 * (4.0 + g * g) / (5.0 * (2.0 + g * g));
    case PhaseFunction::isotropic:
    case PhaseFunction::rayleigh: break;
    }
    return 0.0;
}

double mean_cosine(const PhaseLobes& phase) {
    return weighted_mean(phase, [](const PhaseLobe& lobe) { return mean_cosine(lobe); });
}

double peak(const PhaseLobe& lobe) {
    const double a = std::abs(static_cast<double>(lobe.g));
    const double isotropic = 0.25 * std::numbers::inv_pi;
    const double henyey_greenstein = isotropic * (1.0 + a) / ((1.0 - a) * (1.0 - a));
    switch (lobe.function) {
    case PhaseFunction::rayleigh: return 1.5 * isotropic;
    case PhaseFunction::henyey_greenstein: return henyey_greenstein;
    case PhaseFunction::schlick: return isotropic * (1.0 + a) / (1.0 - a);
    case PhaseFunction::cornette_shanks: return henyey_greenstein * 3.0 / (2.0 + a * a);
    case PhaseFunction::isotropic: break;
    }
    return isotropic;
}

double peak(const PhaseLobes& phase) {
    return weighted_mean(phase, [](const PhaseLobe& lobe) { return peak(lobe); });
}

double steepness(const PhaseLobe& lobe) {
    const double a = std::abs(static_cast<double>(lobe.g));
    const double rayleigh = std::numbers::sqrt2 / 2.0; // largest of sin(2 theta) / (1 + cos^2(theta))
    const double henyey_greenstein = 3.0 * a / (1.0 - a * a);
    switch (lobe.function) {
    case PhaseFunction::rayleigh: return rayleigh;
    case PhaseFunction::henyey_greenstein: return henyey_greenstein;
    case PhaseFunction::schlick: return 2.0 * a / std::sqrt(1.0 - a * a);
    case PhaseFunction::cornette_shanks: return henyey_greenstein + rayleigh;
    case PhaseFunction::isotropic: break;
    }
    return 0.0;
}

double steepness(const PhaseLobes& phase) {
    double largest = 0.0;
    for (const PhaseLobe& lobe : phase.all()) {
        largest = std::max(largest, steepness(lobe));
    }
    return largest;
}

PhaseForm phase_form(const PhaseLobe& lobe) {
    const double a = std::abs(static_cast<double>(lobe.g));
    const double isotropic = 0.25 * std::numbers::inv_pi;
    const double peaked = isotropic * (1.0 - a * a);
    const double cornette_shanks = peaked * 1.5 / (2.0 + a * a);
    switch (lobe.function) {
    case PhaseFunction::rayleigh: return {.constant = 0.75 * isotropic, .squared = 0.75 * isotropic};
    case PhaseFunction::henyey_greenstein: return {.constant = peaked, .spread = (1.0 - a) * (1.0 - a), .chord = a};
    case PhaseFunction::schlick: return {.constant = peaked, .spread = 1.0 - a, .chord = 0.5 * a};
    case PhaseFunction::cornette_shanks: return {cornette_shanks, cornette_shanks, (1.0 - a) * (1.0 - a), a};
    case PhaseFunction::isotropic: break;
    }
    return {.constant = isotropic};
}

std::uint32_t packed_functions(const PhaseLobes& phase) {
    std::uint32_t packed = 0;
    for (std::uint32_t i = 0; i < phase.count; ++i) {
        packed |= static_cast<std::uint32_t>(phase.lobes[i].function) << (4 * i);
    }
    return packed;
}

} // namespace tyndall::volumetrics
