#include "samples/tyndall/stability_series.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "samples/tyndall/stability_pictures.hpp"

namespace tyndall::samples {
namespace {

using Rows = tl::expected<std::vector<StabilityRow>, std::string>;

double total(std::span<const glm::dvec3> picture) {
    double sum = 0.0;
    for (const glm::dvec3& pixel : picture) {
        sum += pixel.r + pixel.g + pixel.b;
    }
    return sum;
}

StabilityRow row_of(const StabilityCase& test, const StabilityPicture& picture, std::string measure, double worst,
                    double bound) {
    const double tolerance = storage_tolerance(test);
    return {.name = test.name,
            .parameter = test.parameter,
            .measure = std::move(measure),
            .worst = worst,
            .bound = bound,
            .broken = to_text(check_bounds(picture.stages, picture.radiance, tolerance), tolerance)};
}

/// The sun a hundred times brighter a step: each picture as many times brighter, in every pixel.
Rows brighten(const engine::Device& device, bool quick) {
    std::vector<StabilityRow> rows;
    std::vector<glm::dvec3> before;
    for (const double lux : quick ? std::vector{1e-6, 1e6} : std::vector{1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6}) {
        StabilityCase test{.name = "monotone", .parameter = "sun of " + value_text(lux, "lux")};
        test.scene = fog_before_a_wall(0.05F);
        test.scene.sun = reference::DirectionalLight{glm::normalize(glm::dvec3(0.4, -1.0, -0.6)), glm::dvec3(lux)};
        const auto picture = take_picture(device, test);
        if (!picture) {
            return tl::unexpected(picture.error());
        }
        std::vector<glm::dvec3> per_lux;
        for (const glm::dvec3& pixel : picture->radiance) {
            per_lux.push_back(pixel / lux);
        }
        if (!before.empty()) {
            rows.push_back(
                row_of(test, *picture, "change of radiance per lux", worst_relative_error(per_lux, before), 1e-3));
        }
        before = std::move(per_lux);
    }
    return rows;
}

/// A wall within a froxel cannot be told from the air on both sides of it. What reads the shadow map's own texels lets
/// nothing through one of a whole froxel; the blur of the exponential map reaches farther.
double leak_bound(volumetrics::SunVisibility visibility, double froxels) {
    using volumetrics::SunVisibility;
    const bool along_slice = visibility == SunVisibility::n_taps || visibility == SunVisibility::lit_fraction;
    if (visibility == SunVisibility::prefiltered) {
        return froxels >= 2.0 ? 2e-4 : froxels >= 1.0 ? 1e-2 : froxels >= 0.5 ? 3e-2 : 0.2;
    }
    return froxels >= 1.0 ? 1e-6 : froxels >= 0.5 ? (along_slice ? 1e-2 : 2e-2) : (along_slice ? 7e-2 : 0.2);
}

/// A closed room in the fog, a hundred thousand times brighter outside.
Rows leak(const engine::Device& device, bool quick) {
    using volumetrics::SunVisibility;
    struct Method {
        const char* name;
        SunVisibility visibility;
        float exponent;
    };
    constexpr double outside = 1e5; // by inside
    std::vector<StabilityRow> rows;
    for (const Method& method : {Method{"ESM exponent 40", SunVisibility::prefiltered, 40.0F},
                                 {"ESM exponent 400", SunVisibility::prefiltered, 400.0F},
                                 {"ESM exponent 1000", SunVisibility::prefiltered, 1000.0F},
                                 {"one tap", SunVisibility::one_tap, 400.0F},
                                 {"n taps", SunVisibility::n_taps, 400.0F},
                                 {"lit fraction", SunVisibility::lit_fraction, 400.0F}}) {
        for (const double froxels : {0.1, 0.5, 1.0, 2.0, 4.0}) {
            if (quick && ((froxels != 0.1 && froxels != 2.0) || method.exponent == 40.0F)) {
                continue;
            }
            StabilityCase test{.name = "leak",
                               .parameter = "walls of " + value_text(froxels) + " froxels, " + method.name};
            test.scene = fog_before_a_wall(0.02F);
            volumetrics::Settings& settings = test.scene.fog.settings;
            settings.visibility.method = method.visibility;
            settings.shadow.esm_exponent.fill(method.exponent);
            const double shape_m = static_cast<double>(settings.grid.shape_m);
            const double growth =
                std::pow(1.0 + static_cast<double>(settings.grid.range_m) / shape_m, 1.0 / settings.grid.slices);
            const glm::dvec3 low(-8.0, -4.0, -20.0);
            const glm::dvec3 high(8.0, 4.0, 4.0);
            const glm::dvec3 wall(froxels * (shape_m - low.z) *
                                  (growth - 1.0)); // a slice at the far wall is one froxel
            test.scene.surfaces = {make_room(low, high, glm::dvec3(0.0)),
                                   make_box(low - wall, high + wall, glm::dvec3(0.0))};
            test.scene.fog.medium.ambient_radiance = glm::vec3(1.0F);
            test.scene.sun = reference::DirectionalLight{glm::normalize(glm::dvec3(0.3, -0.8, 0.6)),
                                                         glm::dvec3(4.0 * std::numbers::pi * outside)};
            const auto picture = take_picture(device, test);
            if (!picture) {
                return tl::unexpected(picture.error());
            }
            const std::vector<glm::dvec3> exact = exact_picture(test);
            double worst = 0.0;
            for (std::size_t i = 0; i < exact.size(); ++i) {
                worst = std::max(worst, (picture->radiance[i].r / exact[i].r - 1.0) / outside);
            }
            rows.push_back(row_of(test, *picture, "part of the light outside in it", worst,
                                  leak_bound(method.visibility, froxels)));
        }
    }
    return rows;
}

/// A light beside the view's middle moves by a tenth of a slice a step.
tl::expected<StabilityRow, std::string> move_light_of(const engine::Device& device, bool quick, bool in_froxels) {
    const int steps = quick ? 3 : 20;
    StabilityCase test{.name = "light_motion",
                       .parameter =
                           value_text(steps) + " steps of 0.1 slices" + (in_froxels ? ", froxels" : ", pixels")};
    double before = 0.0;
    double worst = 0.0;
    StabilityPicture last;
    for (int step = 0; step <= steps; ++step) {
        test.scene = fog_before_a_wall(1e-5F);
        if (in_froxels) {
            test.scene.fog.settings.airlight.max_lights = 0;
        }
        test.scene.lights = {{.position = {0.05, 0.0, -12.0 - 0.29 * step}, .intensity_cd = glm::dvec3(100.0)}};
        auto picture = take_picture(device, test);
        if (!picture) {
            return tl::unexpected(picture.error());
        }
        const double ratio = total(picture->radiance) / total(exact_picture(test));
        worst = step == 0 ? 0.0 : std::max(worst, std::max(ratio / before, before / ratio) - 1.0);
        before = ratio;
        last = std::move(*picture);
    }
    // Along a pixel's own ray there are no slices, and only single precision is left.
    return row_of(test, last, "change of light in the picture", worst, in_froxels ? 0.05 : 1e-5);
}

Rows move_light(const engine::Device& device, bool quick) {
    std::vector<StabilityRow> rows;
    for (const bool in_froxels : {true, false}) {
        auto row = move_light_of(device, quick, in_froxels);
        if (!row) {
            return tl::unexpected(row.error());
        }
        rows.push_back(std::move(*row));
    }
    return rows;
}

/// Jittered frames on end.
Rows run_long(const engine::Device& device, bool quick) {
    StabilityCase test{.name = "many_frames"};
    test.scene = fog_before_a_wall(0.05F);
    test.scene.fog.settings.grid.width = 16;
    test.scene.fog.settings.grid.height = 9;
    test.scene.fog.medium.ambient_radiance = glm::vec3(0.37F);
    test.scene.sun = reference::DirectionalLight{glm::normalize(glm::dvec3(0.4, -1.0, -0.6)), glm::dvec3(10.0)};
    const std::array<std::uint32_t, 3> frames = quick ? std::array{1U, 32U, 256U} : std::array{1U, 1000U, 10000U};
    const auto pictures = take_pictures(device, test, frames, [](std::uint32_t) { return 0.0; });
    if (!pictures) {
        return tl::unexpected(pictures.error());
    }
    const std::vector<glm::dvec3> exact = exact_picture(test);
    std::vector<StabilityRow> rows;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        test.parameter = "frame " + std::to_string(frames[i]);
        rows.push_back(row_of(test, (*pictures)[i], "relative error of the worst pixel",
                              worst_relative_error((*pictures)[i].radiance, exact), 5e-3));
    }
    const double drift = total((*pictures)[2].radiance) / total((*pictures)[1].radiance) - 1.0;
    test.parameter = "from frame " + std::to_string(frames[1]) + " to " + std::to_string(frames[2]);
    rows.push_back(row_of(test, (*pictures)[2], "drift of the picture's light", std::abs(drift), 1e-3));
    return rows;
}

/// Steps of time of nothing and of 30 years, with history, in noise that the wind moves.
Rows step_time(const engine::Device& device, bool /*quick*/) {
    std::vector<StabilityRow> rows;
    for (const double step_s : {0.0, 1e9}) {
        StabilityCase test{.name = "time_step", .parameter = value_text(step_s, "s")};
        test.scene = fog_before_a_wall(0.02F);
        test.scene.fog.medium.noise = {.amplitude = 0.5F, .scale_m = 16.0F, .wind_m_s = {0.5F, 0.25F, -0.5F}};
        test.scene.fog.medium.ambient_radiance = glm::vec3(0.5F);
        constexpr std::uint32_t frame = 4;
        const auto pictures =
            take_pictures(device, test, std::array{frame}, [&](std::uint32_t i) { return step_s * i; });
        if (!pictures) {
            return tl::unexpected(pictures.error());
        }
        test.scene.time_s = step_s * frame;
        rows.push_back(row_of(test, pictures->front(), "relative error of the worst pixel",
                              worst_relative_error(pictures->front().radiance, exact_picture(test)), 5e-2));
    }
    return rows;
}

constexpr std::array all_series{StabilitySeries{"monotone", brighten}, StabilitySeries{"leak", leak},
                                StabilitySeries{"light_motion", move_light}, StabilitySeries{"time_step", step_time},
                                StabilitySeries{"many_frames", run_long}};

} // namespace

std::span<const StabilitySeries> stability_series() {
    return all_series;
}

} // namespace tyndall::samples
