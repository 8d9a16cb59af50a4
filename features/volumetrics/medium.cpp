#include "features/volumetrics/medium.hpp"

#include "features/volumetrics/range_check.hpp"

namespace tyndall::volumetrics {

bool is_empty(const Medium& medium) {
    return medium.homogeneous.extinction_per_m <= 0.0F && medium.height.extinction_per_m <= 0.0F;
}

tl::expected<void, Error> validate(const Medium& medium) {
    RangeCheck check;
    check.in_range("medium.homogeneous.extinction_per_m", medium.homogeneous.extinction_per_m, 0.0, 1e6);
    check.in_range("medium.homogeneous.albedo", medium.homogeneous.albedo, 0.0, 1.0);
    check.in_range("medium.height.extinction_per_m", medium.height.extinction_per_m, 0.0, 1e6);
    check.in_range("medium.height.albedo", medium.height.albedo, 0.0, 1.0);
    check.in_range("medium.height.base_height_m", medium.height.base_height_m, -1e6, 1e6);
    check.in_range("medium.height.falloff_per_m", medium.height.falloff_per_m, 0.0, 1e3);
    check.in_range("medium.noise.amplitude", medium.noise.amplitude, 0.0, 1.0);
    check.in_range("medium.noise.scale_m", medium.noise.scale_m, 1e-3, 1e6);
    check.in_range("medium.noise.wind_m_s", medium.noise.wind_m_s, -1e3, 1e3);
    check.in_range("phase.g", medium.phase_g, -0.999F, 0.999F);
    check.in_range("ambient.radiance", medium.ambient_radiance, 0.0, 1e9);
    return check.result();
}

} // namespace tyndall::volumetrics
