#include "samples/stability/bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tyndall::samples {
namespace {

void check_density(const StageValues& stage, double tolerance, BoundsReport& report) {
    for (std::size_t i = 0; i + 3 < stage.values.size(); i += 4) {
        const double extinction = static_cast<double>(stage.values[i + 3]);
        report.negative += extinction < 0.0 ? 1 : 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double scattering = static_cast<double>(stage.values[i + c]);
            report.negative += scattering < 0.0 ? 1 : 0;
            report.over_extinction += scattering > extinction * (1.0 + tolerance) ? 1 : 0;
        }
    }
}

double brightest(const StageValues& stage) {
    float most = 0.0F;
    for (std::size_t i = 0; i + 3 < stage.values.size(); i += 4) {
        most = std::max({most, stage.values[i], stage.values[i + 1], stage.values[i + 2]});
    }
    return static_cast<double>(most);
}

void check_radiance(const StageValues& stage, BoundsReport& report) {
    for (std::size_t i = 0; i + 3 < stage.values.size(); i += 4) {
        report.negative += static_cast<std::size_t>(
            std::count_if(&stage.values[i], &stage.values[i] + 3, [](float v) { return v < 0.0F; }));
    }
}

/// `channel` of 4.
void check_depth(const StageValues& stage, std::size_t channel, BoundsReport& report) {
    const std::size_t layer = std::size_t{stage.width} * stage.height * 4;
    for (std::size_t i = layer + channel; i < stage.values.size(); i += 4) {
        report.falling_depth += stage.values[i] < stage.values[i - layer] ? 1 : 0;
    }
}

} // namespace

BoundsReport check_bounds(std::span<const StageValues> stages, std::span<const glm::dvec3> picture, double tolerance) {
    BoundsReport report;
    double source = 0.0;
    double toward_eye = 0.0;
    for (const StageValues& stage : stages) {
        report.not_finite += static_cast<std::size_t>(
            std::count_if(stage.values.begin(), stage.values.end(), [](float v) { return !std::isfinite(v); }));
        if (stage.name == "density") {
            check_density(stage, tolerance, report);
        } else if (stage.name == "lighting") {
            check_radiance(stage, report);
            source = brightest(stage);
        } else if (stage.name == "accumulated") {
            check_radiance(stage, report);
            check_depth(stage, 3, report);
            toward_eye = brightest(stage);
        } else if (stage.name == "accumulated of each channel") {
            for (std::size_t c = 0; c < 3; ++c) {
                check_depth(stage, c, report);
            }
        }
    }
    report.over_source = source > 0.0 ? toward_eye / source : (toward_eye > 0.0 ? HUGE_VAL : 0.0);
    for (const glm::dvec3& pixel : picture) {
        for (int c = 0; c < 3; ++c) {
            report.not_finite += std::isfinite(pixel[c]) ? 0 : 1;
            report.negative += pixel[c] < 0.0 ? 1 : 0;
        }
    }
    return report;
}

bool holds(const BoundsReport& report, double tolerance) {
    return to_text(report, tolerance).empty();
}

std::string to_text(const BoundsReport& report, double tolerance) {
    std::string text;
    const auto add = [&](std::size_t count, const char* what) {
        if (count > 0) {
            text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + what;
        }
    };
    add(report.not_finite, "values not finite");
    add(report.negative, "values below 0");
    add(report.over_extinction, "scattering coefficients above the extinction");
    add(report.falling_depth, "optical depths below the one before");
    if (report.over_source > 1.0 + tolerance) {
        text += (text.empty() ? "" : ", ") + std::to_string(report.over_source) + " times the brightest source";
    }
    return text;
}

double worst_relative_error(std::span<const glm::dvec3> found, std::span<const glm::dvec3> exact, double floor,
                            double least_mean) {
    double mean = 0.0;
    for (const glm::dvec3& pixel : exact) {
        mean += (pixel.r + pixel.g + pixel.b) / (3.0 * static_cast<double>(exact.size()));
    }
    mean = std::max(mean, least_mean);
    double worst = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            const double error = std::abs(found[i][c] - exact[i][c]);
            if (!std::isfinite(error)) {
                return std::numeric_limits<double>::infinity();
            }
            const double scale = std::max(exact[i][c], floor * mean);
            worst = std::max(worst, error > 0.0 ? error / scale : 0.0);
        }
    }
    return worst;
}

} // namespace tyndall::samples
