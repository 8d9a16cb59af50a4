// The depth law `scene`: what range and shape it chooses, that it does not waver, and that the picture is the better.
#include <cmath>
#include <cstdio>

#include "features/volumetrics/depth_range.hpp"
#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

FrameInputs view_of(double nearest_m, double farthest_m) {
    FrameInputs frame;
    frame.camera.clip_from_view = test_projection();
    frame.settings.grid.law = DepthLawKind::scene;
    frame.medium.homogeneous.extinction_per_m = 0.01F;
    frame.visible_depth_m = DepthSpan{nearest_m, farthest_m};
    return frame;
}

/// What remains of a frame that was fitted so.
FrameMemory memory(FrameInputs frame, const FittedRange& fitted) {
    frame.settings.grid.range_m = fitted.range_m;
    frame.settings.grid.shape_m = fitted.shape_m;
    return memory_of(frame, volumetric_parameters(frame, std::nullopt));
}

TEST(FittedRange, ReachesBehindWhatIsVisibleAndNotMuchFarther) {
    for (double farthest_m = 1.0; farthest_m < 60.0; farthest_m *= 1.07) {
        const FittedRange fitted = fitted_range(view_of(0.0, farthest_m), std::nullopt);
        EXPECT_GE(static_cast<double>(fitted.range_m), std::max(farthest_m, 1.0));
        EXPECT_LE(static_cast<double>(fitted.range_m), std::min(1.05 * std::sqrt(2.0) * farthest_m, 64.0) * 1.00001);
        EXPECT_FLOAT_EQ(fitted.shape_m, 0.25F * fitted.range_m);
    }
    EXPECT_EQ(fitted_range(view_of(0.0, 1e4), std::nullopt).range_m, 64.0F);
    EXPECT_EQ(fitted_range(view_of(0.0, 1e-3), std::nullopt).range_m, 1.0F);
    EXPECT_FLOAT_EQ(fitted_range(view_of(12.0, 20.0), std::nullopt).shape_m, 12.0F); // nothing near to spend slices on
    EXPECT_FLOAT_EQ(fitted_range(view_of(500.0, 600.0), std::nullopt).shape_m, 64.0F);
}

TEST(FittedRange, IsThatOfLightsVolumesAndShadowsToo) {
    FrameInputs frame = view_of(0.0, 4.0);
    const float range_m = fitted_range(frame, std::nullopt).range_m;
    frame.lights = {{.position_range = {0.0F, 0.0F, -20.0F, 8.0F}}};
    EXPECT_GE(fitted_range(frame, std::nullopt).range_m, 22.0F);
    frame.lights.clear();
    frame.medium.volumes = {{.center_m = {0.0F, 0.0F, -30.0F}, .half_size_m = glm::vec3(2.0F)}};
    EXPECT_GE(fitted_range(frame, std::nullopt).range_m, 33.0F);
    frame.camera.origin_m.z = -27.0; // beside it
    EXPECT_LE(fitted_range(frame, std::nullopt).range_m, 12.0F);
    frame = view_of(0.0, range_m / 1.1);
    EXPECT_EQ(fitted_range(frame, std::nullopt).range_m, range_m);
    frame.sun = Sun{.illuminance_lux = glm::vec3(1.0F), .casts_shadows = true};
    EXPECT_GT(fitted_range(frame, std::nullopt).range_m, range_m);
}

TEST(FittedRange, IsTheWholeRangeWhereTheFarFieldKnowsLess) {
    FrameInputs frame = view_of(0.0, 4.0);
    frame.medium.noise.amplitude = 0.5F;
    EXPECT_EQ(fitted_range(frame, std::nullopt).range_m, 64.0F);
    frame = view_of(0.0, 4.0);
    frame.medium.height.emission_per_m = glm::vec3(1.0F);
    EXPECT_EQ(fitted_range(frame, std::nullopt).range_m, 64.0F);
    frame = view_of(0.0, 4.0);
    frame.medium.map.texels = *DensityTexels::create({1, 1, 1}, {255});
    EXPECT_EQ(fitted_range(frame, std::nullopt).range_m, 64.0F);
    frame = view_of(0.0, 4.0);
    frame.visible_depth_m.reset();
    EXPECT_EQ(fitted_range(frame, std::nullopt).range_m, 64.0F);
}

TEST(FittedRange, ChangesSeldomWhileTheViewWavers) {
    std::optional<FrameMemory> before;
    int changes = 0;
    for (int i = 0; i < 400; ++i) {
        const double wave = std::sin(i * 0.7);
        const FrameInputs frame = view_of(5.0 + 1.5 * wave, 14.0 + 4.0 * wave);
        const FittedRange fitted = fitted_range(frame, before);
        EXPECT_GE(static_cast<double>(fitted.range_m), frame.visible_depth_m->farthest_m);
        if (before) {
            changes +=
                fitted.range_m != before->volume.law.range_shape.x || fitted.shape_m != before->volume.law.range_shape.y
                    ? 1
                    : 0;
        }
        before = memory(frame, fitted);
    }
    EXPECT_LE(changes, 2);
    // And is given up when the view is another one.
    EXPECT_LE(fitted_range(view_of(0.0, 2.0), before).range_m, 3.0F);
    FrameInputs shorter = view_of(0.0, 14.0);
    shorter.settings.grid.range_m = 10.0F;
    EXPECT_EQ(fitted_range(shorter, before).range_m, 10.0F);
}

class SceneLaw : public FogTest {};

TEST_F(SceneLaw, SpendsSlicesWhereTheViewIsAndSaysSo) {
    Scene scene = plain_scene();
    scene.image = {80, 45};
    scene.inputs.medium.height = {.extinction_per_m = 0.3F, .base_height_m = -4.0F, .falloff_per_m = 1.0F};
    scene.inputs.medium.ambient_radiance = glm::vec3(1.0F);
    scene.lights = {{.position_range = {0.5F, 1.0F, -3.0F, 6.0F},
                     .intensity_type = glm::vec4(glm::vec3(5.0F), 0.0F),
                     .direction_radius = {0.0F, -1.0F, 0.0F, 0.02F},
                     .cone = {0.0F, 1.0F, 0.0F, 0.0F}}};
    scene.depth_m = [](std::uint32_t, std::uint32_t) { return 5.0; };
    scene.inputs.visible_depth_m = DepthSpan{1.0, 5.0};
    const auto with = [&](DepthLawKind law, std::uint32_t slices) {
        scene.inputs.settings.grid = {.width = 160, .height = 90, .slices = slices, .law = law};
        scene.inputs.cut = true;
        return render(scene);
    };
    const Result exact = with(DepthLawKind::shaped, 512);
    const auto error = [&](const Result& result) {
        double squares = 0.0;
        double total = 0.0;
        for (std::size_t i = 0; i < exact.color.size(); ++i) {
            const auto value = static_cast<double>(exact.color[i].r);
            squares += std::pow(static_cast<double>(result.color[i].r) - value, 2.0);
            total += value * value;
        }
        return std::sqrt(squares / total);
    };
    const double whole = error(with(DepthLawKind::shaped, 32));
    const Result fitted = with(DepthLawKind::scene, 32);
    std::printf("32 slices to 64 m: %.2e, fitted to the view: %.2e\n", whole, error(fitted));
    EXPECT_LT(error(fitted), 0.5 * whole);
    const std::string said = "slices beyond 5.65685 m: nothing in the view is farther";
    EXPECT_NE(std::find(fitted.omissions.begin(), fitted.omissions.end(), said), fitted.omissions.end());
}

TEST_F(SceneLaw, ANewRangeStartsColdAndTheSameOneDoesNot) {
    Scene scene = plain_scene();
    scene.image = {16, 8};
    scene.inputs.settings.temporal = {.enabled = true, .new_frame_weight = 0.05F, .jitter = true};
    scene.inputs.settings.grid.law = DepthLawKind::scene;
    scene.inputs.medium.homogeneous.extinction_per_m = 0.01F;
    scene.inputs.medium.ambient_radiance = glm::vec3(1.0F);
    const auto age_with = [&](double farthest_m) {
        scene.inputs.visible_depth_m = DepthSpan{0.0, farthest_m};
        return render(scene).in_scattered[9].a;
    };
    EXPECT_EQ(age_with(20.0), 1.0F);
    EXPECT_EQ(age_with(18.0), 2.0F);
    EXPECT_EQ(age_with(21.0), 3.0F);
    EXPECT_EQ(age_with(40.0), 1.0F);
    EXPECT_EQ(age_with(30.0), 2.0F);
    EXPECT_EQ(age_with(5.0), 1.0F);
}

} // namespace
} // namespace tyndall::volumetrics::test
