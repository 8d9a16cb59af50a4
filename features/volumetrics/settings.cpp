#include "features/volumetrics/settings.hpp"

#include "features/volumetrics/range_check.hpp"

namespace tyndall::volumetrics {

tl::expected<void, Error> validate(const Settings& settings) {
    RangeCheck check;
    check.in_range("grid.width", settings.grid.width, 2, 1024);
    check.in_range("grid.height", settings.grid.height, 2, 1024);
    check.in_range("grid.slices", settings.grid.slices, 8, 512);
    check.in_range("grid.range_m", settings.grid.range_m, 1e-2, 1e7);
    const double range_m = settings.grid.range_m;
    // The lower end admits what single precision makes of the bound itself.
    check.in_range("grid.shape_m (1e-4 to 100 times grid.range_m)", settings.grid.shape_m, 1e-4 * range_m * 0.999999,
                   100.0 * range_m);
    for (const float exponent : settings.shadow.esm_exponent) {
        check.in_range("shadow.esm_exponent", exponent, 1.0, 1000.0);
    }
    check.in_range("shadow.esm_size", settings.shadow.esm_size, 16, 2048);
    check.in_range("visibility.taps", settings.visibility.taps, 1, 64);
    check.in_range("temporal.new_frame_weight", settings.temporal.new_frame_weight, 0.001F, 1.0);
    return check.result();
}

} // namespace tyndall::volumetrics
