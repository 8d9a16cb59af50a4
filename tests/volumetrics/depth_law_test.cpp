// Where the depth laws put their slices, and that the picture does not depend on them.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

GridSettings grid_of(DepthLawKind law, std::vector<float> curve_m = {}) {
    return {.width = 40,
            .height = 24,
            .slices = 64,
            .range_m = 64.0F,
            .shape_m = 16.0F,
            .law = law,
            .curve_m = std::move(curve_m)};
}

/// View depth of boundary k, in double, from the law's definition.
double boundary_m(const GridSettings& grid, double k) {
    const double t = k / grid.slices;
    const double range_m = grid.range_m;
    const double shape_m = grid.shape_m;
    switch (grid.law) {
    case DepthLawKind::shaped: return shape_m * std::expm1(t * std::log1p(range_m / shape_m));
    case DepthLawKind::linear: return range_m * t;
    case DepthLawKind::scene:
    case DepthLawKind::curve: break;
    }
    const double at = t * static_cast<double>(grid.curve_m.size());
    const std::size_t piece = std::min(static_cast<std::size_t>(at), grid.curve_m.size() - 1);
    const double first = piece == 0 ? 0.0 : static_cast<double>(grid.curve_m[piece - 1]);
    return first + (static_cast<double>(grid.curve_m[piece]) - first) * (at - static_cast<double>(piece));
}

/// Fog that varies along every ray, lit by a sun, ambient with a direction and a lamp.
Scene varied_scene() {
    Scene scene = plain_scene();
    scene.image = {80, 45};
    FrameInputs& in = scene.inputs;
    in.medium.homogeneous = {.extinction_per_m = 0.01F, .albedo = {0.9F, 0.8F, 0.7F}};
    in.medium.height.extinction_per_m = 0.04F;
    in.medium.height.falloff_per_m = 0.1F;
    in.medium.height.base_height_m = -3.0F;
    in.medium.ambient_radiance = glm::vec3(0.5F);
    in.medium.phase_g = 0.3F;
    in.sun = Sun{.direction = glm::normalize(glm::vec3(0.3F, -0.5F, 0.8F)), .illuminance_lux = glm::vec3(3.0F)};
    scene.lights = {{.position_range = {8.0F, 9.0F, -20.0F, 40.0F},
                     .intensity_type = glm::vec4(glm::vec3(30.0F), 0.0F),
                     .direction_radius = {0.0F, -1.0F, 0.0F, 0.02F},
                     .cone = {0.0F, 1.0F, 0.0F, 0.0F}}};
    scene.depth_m = [](std::uint32_t x, std::uint32_t y) {
        return 0.3 * std::pow(300.0, ((x * 37 + y * 101) % 509) / 508.0);
    };
    return scene;
}

std::vector<GridSettings> all_laws() {
    return {grid_of(DepthLawKind::shaped), grid_of(DepthLawKind::linear), grid_of(DepthLawKind::curve, {64.0F}),
            grid_of(DepthLawKind::curve, {2.0F, 10.0F, 30.0F, 64.0F}),
            // Slices that shrink again, and more pieces than divide the slices.
            grid_of(DepthLawKind::curve, {4.0F, 16.0F, 20.0F, 24.0F, 36.0F, 50.0F, 64.0F})};
}

class DepthLaws : public FogTest {};

TEST_F(DepthLaws, BoundariesLieWhereTheLawSays) {
    Scene scene = plain_scene();
    scene.image = {16, 8};
    scene.inputs.medium.homogeneous.extinction_per_m = 0.02F;
    for (const GridSettings& grid : all_laws()) {
        for (const Integrator integrator : {Integrator::exponential, Integrator::exponential_quadratic}) {
            scene.inputs.settings.grid = grid;
            scene.inputs.settings.integrator = integrator;
            const Result result = render(scene);
            const double slope_x = (2.0 * 20.0 / 39.0 - 1.0) * tan_x;
            const double slope_y = (1.0 - 2.0 * 12.0 / 23.0) * tan_y;
            const double stretch = std::sqrt(1.0 + slope_x * slope_x + slope_y * slope_y);
            for (std::size_t k = 0; k <= grid.slices; ++k) {
                const double tau = static_cast<double>(result.accumulated[(k * 24 + 12) * 40 + 20].a);
                const double exact = 0.02 * stretch * boundary_m(grid, static_cast<double>(k));
                ASSERT_NEAR(tau, exact, 1e-5 * exact) << "boundary " << k;
            }
        }
    }
}

TEST_F(DepthLaws, PictureDoesNotDependOnTheLaw) {
    Scene scene = varied_scene();
    scene.inputs.settings.grid = grid_of(DepthLawKind::shaped);
    scene.inputs.settings.grid.slices = 512;
    const Result fine = render(scene);
    for (const Integrator integrator : {Integrator::exponential, Integrator::exponential_quadratic}) {
        for (const GridSettings& grid : all_laws()) {
            scene.inputs.settings.grid = grid;
            scene.inputs.settings.integrator = integrator;
            const Result result = render(scene);
            double squares = 0.0;
            double total = 0.0;
            for (std::size_t i = 0; i < fine.color.size(); ++i) {
                const double exact = static_cast<double>(fine.color[i].g);
                squares += std::pow(static_cast<double>(result.color[i].g) - exact, 2.0);
                total += exact * exact;
            }
            std::printf("law %d, %zu pieces: %.2e\n", static_cast<int>(grid.law), grid.curve_m.size(),
                        std::sqrt(squares / total));
            EXPECT_LE(std::sqrt(squares / total), 1e-3);
        }
    }
}

TEST_F(DepthLaws, PictureDoesNotDependOnRangeAndShape) {
    Scene scene = varied_scene();
    scene.lights.clear(); // the light of lamps ends at the range
    scene.inputs.settings.grid = grid_of(DepthLawKind::shaped);
    scene.inputs.settings.grid.slices = 512;
    const Result fine = render(scene);
    for (const float range_m : {20.0F, 100.0F, 400.0F}) {
        for (const float relative_shape : {0.02F, 0.25F, 3.0F, 1e3F}) {
            if (range_m * relative_shape > 300.0F && range_m > 100.0F) {
                continue; // slices of 6 m right before the eye
            }
            GridSettings& grid = scene.inputs.settings.grid;
            grid = grid_of(DepthLawKind::shaped);
            grid.range_m = range_m;
            grid.shape_m = relative_shape * range_m;
            const Result result = render(scene);
            double worst = 0.0;
            for (std::size_t i = 0; i < fine.color.size(); ++i) {
                worst = std::max(worst, std::abs(static_cast<double>(result.color[i].g / fine.color[i].g) - 1.0));
            }
            std::printf("range %g m, shape %g of it: %.2e\n", static_cast<double>(range_m),
                        static_cast<double>(relative_shape), worst);
            EXPECT_LE(worst, 2e-2);
        }
    }
}

TEST_F(DepthLaws, ShapeFarBeyondTheRangeIsLinear) {
    Scene scene = varied_scene();
    scene.inputs.settings.grid = grid_of(DepthLawKind::linear);
    const Result linear = render(scene);
    scene.inputs.settings.grid = grid_of(DepthLawKind::shaped);
    scene.inputs.settings.grid.shape_m = 101.0F * 64.0F;
    EXPECT_EQ(render(scene).color, linear.color);
}

TEST_F(DepthLaws, HistoryIsFoundAlongACurve) {
    Scene scene = varied_scene();
    scene.lights.clear();
    scene.inputs.sun.reset();
    scene.inputs.medium.phase_g = 0.0F;
    scene.inputs.settings.temporal = {.enabled = true, .new_frame_weight = 0.05F, .jitter = false};
    // Light that varies with the height above the ground only: a lamp far away.
    scene.lights = {{.position_range = {0.0F, 60.0F, -20.0F, 400.0F},
                     .intensity_type = glm::vec4(glm::vec3(3000.0F), 0.0F),
                     .direction_radius = {0.0F, -1.0F, 0.0F, 4.0F},
                     .cone = {0.0F, 1.0F, 0.0F, 0.0F}}};
    scene.inputs.settings.grid = grid_of(DepthLawKind::curve, {2.0F, 10.0F, 30.0F, 64.0F});
    (void)render(scene);
    scene.inputs.camera.origin_m = {0.0, 0.0, -2.0};
    scene.lights[0].position_range.z += 2.0F;
    const Result moved = render(scene);
    scene.inputs.cut = true;
    const Result fresh = render(scene);
    double worst = 0.0;
    std::size_t reused = 0;
    for (std::size_t i = 0; i < fresh.in_scattered.size(); ++i) {
        if (moved.in_scattered[i].a > 1.5F && i / (40 * 24) > 1) {
            ++reused;
            worst =
                std::max(worst, std::abs(static_cast<double>(moved.in_scattered[i].r / fresh.in_scattered[i].r) - 1.0));
        }
    }
    EXPECT_GT(reused, fresh.in_scattered.size() * 7 / 10);
    EXPECT_LE(worst, 2e-3);
}

} // namespace
} // namespace tyndall::volumetrics::test
