#include "features/volumetrics/settings.hpp"

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

namespace tyndall::volumetrics {
namespace {

std::string text_of(double value) {
    char digits[32];
    const std::to_chars_result end =
        std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, 6);
    return {digits, end.ptr};
}

/// Keeps the first complaint.
class Checker {
public:
    void in_range(std::string_view key, double value, double low, double high) {
        const bool inside = std::isfinite(value) && value >= low && value <= high;
        if (!inside && !error_) {
            error_ = Error{std::string(key) + " must be between " + text_of(low) + " and " + text_of(high) + ", not " +
                           text_of(value) + "."};
        }
    }
    void in_range(std::string_view key, const glm::vec3& value, double low, double high) {
        for (int i = 0; i < 3; ++i) {
            in_range(std::string(key) + "[" + std::to_string(i) + "]", value[i], low, high);
        }
    }
    [[nodiscard]] tl::expected<void, Error> result() const {
        if (error_) {
            return tl::unexpected(*error_);
        }
        return {};
    }

private:
    std::optional<Error> error_;
};

} // namespace

bool is_empty(const Medium& medium) {
    return medium.homogeneous.extinction_per_m <= 0.0F && medium.height.extinction_per_m <= 0.0F;
}

tl::expected<void, Error> validate(const Medium& medium) {
    Checker check;
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

tl::expected<void, Error> validate(const Settings& settings) {
    Checker check;
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
