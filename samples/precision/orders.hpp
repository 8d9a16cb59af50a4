// The integrators' orders of convergence, by their double-precision twins, in a smooth and varied medium: extinction
// d (2 + 1.6 sin 7t) per metre, source function 1 + 0.5 cos 5t, t in [0, 1] m, with d the density.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "samples/precision/integrator_twin.hpp"

namespace tyndall::samples {

inline constexpr std::array integrators{volumetrics::Integrator::euler, volumetrics::Integrator::half_slice,
                                        volumetrics::Integrator::exponential,
                                        volumetrics::Integrator::exponential_quadratic};
inline constexpr std::array integrator_names{"euler", "half_slice", "exponential", "exponential_quadratic"};
inline constexpr std::array integrator_orders{1.0, 2.0, 2.0, 4.0}; ///< that theory gives

/// Radiance toward t = 0, to 1e-12 of it.
[[nodiscard]] double smooth_radiance(double density);

/// What a column of `count` slices holds, the last `growth` times as long as the first: samples at the middles of the
/// slices; for the parabola the extinction's mean by Simpson's rule.
[[nodiscard]] std::vector<TwinSlice> smooth_column(volumetrics::Integrator integrator, int count, double growth,
                                                   double density);

/// Of the column's radiance to `exact`.
[[nodiscard]] double smooth_error(volumetrics::Integrator integrator, int count, double growth, double density,
                                  double exact);

/// Of errors at numbers of slices that double: the mean of two successive slopes that agree within 0.1, beginning at
/// the finest whose error is above rounding; -1 where none do.
[[nodiscard]] double fitted_order(std::span<const double> errors);

/// Errors at 16 to 4,096 slices and the order that fits them, of each integrator, for densities 1 and 20, slices of
/// equal length and such of which the last is four times as long as the first.
struct OrderRow {
    static constexpr int least_slices = 16; ///< of the first error; the next has twice as many
    const char* integrator = "";
    double density = 1.0;
    double growth = 1.0;
    std::vector<double> errors;
    double expected = 0.0;
    double order = 0.0;
};
[[nodiscard]] std::vector<OrderRow> measured_orders();

[[nodiscard]] std::string to_table(std::span<const OrderRow> rows);

} // namespace tyndall::samples
