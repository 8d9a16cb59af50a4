#include "features/volumetrics/settings.hpp"

#include "features/volumetrics/range_check.hpp"
#include "shaders/common/airlight.h"

namespace tyndall::volumetrics {
namespace {

/// Each depth is at least a millionth of the range behind the one before.
void check_curve(const GridSettings& grid, RangeCheck& check) {
    check.in_range("The number of grid.curve_m's depths", static_cast<double>(grid.curve_m.size()), 1.0, 8.0);
    const double range_m = grid.range_m;
    double before_m = 0.0;
    for (std::size_t i = 0; i < grid.curve_m.size(); ++i) {
        const bool last = i + 1 == grid.curve_m.size();
        const std::string key = "grid.curve_m[" + std::to_string(i) + "]" + (last ? " (the last, grid.range_m)" : "");
        check.in_range(key, grid.curve_m[i], last ? range_m : before_m + 1e-6 * range_m, range_m);
        before_m = grid.curve_m[i];
    }
}

} // namespace

tl::expected<void, Error> validate(const Settings& settings) {
    RangeCheck check;
    check.in_range("grid.width", settings.grid.width, 2, 1024);
    check.in_range("grid.height", settings.grid.height, 2, 1024);
    check.in_range("grid.slices", settings.grid.slices, 8, 512);
    check.in_range("grid.range_m", settings.grid.range_m, 1e-2, 1e7);
    const double range_m = settings.grid.range_m;
    // The lower end admits what single precision makes of the bound itself.
    check.in_range("grid.shape_m (1e-4 to 1e6 times grid.range_m)", settings.grid.shape_m, 1e-4 * range_m * 0.999999,
                   1e6 * range_m);
    if (settings.grid.law == DepthLawKind::curve) {
        check_curve(settings.grid, check);
    }
    for (const float exponent : settings.shadow.esm_exponent) {
        check.in_range("shadow.esm_exponent", exponent, 1.0, 1000.0);
    }
    check.in_range("shadow.esm_size", settings.shadow.esm_size, 16, 2048);
    check.in_range("light_path_steps", settings.light_path_steps, 1, 64);
    check.in_range("airlight.max_lights", settings.airlight.max_lights, 0, TYNDALL_AIRLIGHT_COUNT);
    check.in_range("visibility.taps", settings.visibility.taps, 1, 64);
    check.in_range("temporal.new_frame_weight", settings.temporal.new_frame_weight, 0.001F, 1.0);
    return check.result();
}

} // namespace tyndall::volumetrics
