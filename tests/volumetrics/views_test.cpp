// Several views of one feature: each as if it were alone.
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

class Views : public FogTest {};

Scene view_of(double x_m, double yaw) {
    Scene scene = sunlit_scene(140.0F);
    scene.image = {32, 18};
    scene.inputs.settings.grid = {.width = 40, .height = 24, .slices = 32, .range_m = 64.0F, .shape_m = 16.0F};
    scene.inputs.settings.temporal = {.enabled = true, .new_frame_weight = 0.05F, .jitter = true};
    scene.inputs.medium.height.extinction_per_m = 0.02F;
    scene.inputs.medium.phase_g = 0.2F;
    scene.inputs.camera.origin_m.x = x_m;
    scene.inputs.camera.view_from_render = glm::rotate(glm::dmat4(1.0), yaw, glm::dvec3(0.0, 1.0, 0.0));
    for (std::size_t i = 0; i < scene.cascade_depths.size(); ++i) {
        scene.cascade_depths[i] = i % 7 < 3 ? 0.0F : 1.0F;
    }
    scene.lights.assign(2, {.position_range = {2.0F, 1.0F, -9.0F, 12.0F},
                            .intensity_type = glm::vec4(glm::vec3(40.0F), 0.0F),
                            .direction_radius = {0.0F, -1.0F, 0.0F, 0.02F},
                            .cone = {0.0F, 1.0F, 0.0F, 0.0F}});
    scene.lights[1].position_range.x = -3.0F;
    for (gpu::GpuLight& light : scene.lights) { // they stand in the world
        light.position_range.x -= static_cast<float>(x_m);
    }
    return scene;
}

/// Two cameras that move, by frame.
std::vector<Scene> scenes_at(int frame) {
    std::vector<Scene> scenes{view_of(0.1 * frame, 0.0), view_of(5.0 - 0.2 * frame, 0.05 * frame)};
    scenes[1].inputs.settings.grid.width = 48;
    return scenes;
}

TEST_F(Views, InOneFrameEqualEachAlone) {
    constexpr int frames = 4;
    std::vector<Result> together[2];
    for (int i = 0; i < frames; ++i) {
        std::vector<Result> results = render_views(scenes_at(i));
        for (std::size_t view = 0; view < 2; ++view) {
            together[view].push_back(std::move(results[view]));
        }
    }
    EXPECT_GT(together[1].back().in_scattered[20000].a, 2.0F) << "the second view has a history";
    for (std::size_t view = 0; view < 2; ++view) {
        for (int i = 0; i < frames; ++i) {
            Scene scene = scenes_at(i)[view];
            scene.inputs.cut = i == 0;
            const Result alone = render(scene);
            const Result& beside = together[view][static_cast<std::size_t>(i)];
            EXPECT_EQ(alone.color, beside.color) << "view " << view << ", frame " << i;
            EXPECT_EQ(alone.in_scattered, beside.in_scattered);
            EXPECT_EQ(alone.accumulated, beside.accumulated);
            EXPECT_EQ(alone.masks, beside.masks);
        }
    }
}

TEST_F(Views, ACutOfOneLeavesTheOtherItsHistory) {
    (void)render_views(scenes_at(0));
    (void)render_views(scenes_at(1));
    std::vector<Scene> scenes = scenes_at(2);
    scenes[0].inputs.cut = true;
    const std::vector<Result> results = render_views(scenes);
    EXPECT_EQ(results[0].in_scattered[20000].a, 1.0F);
    EXPECT_GT(results[1].in_scattered[20000].a, 1.5F);
}

TEST_F(Views, APartOfTheImagesHoldsTheSameAsAllOfSmallerOnes) {
    for (int i = 0; i < 2; ++i) {
        std::vector<Scene> scenes = scenes_at(i);
        scenes[1] = scenes[0];
        scenes[1].inputs.allocated_columns = {64, 30};
        const std::vector<Result> results = render_views(scenes);
        // The last column is sampled a 128th of a column before its middle.
        for (std::size_t pixel = 0; pixel < results[0].color.size(); ++pixel) {
            ASSERT_NEAR(results[0].color[pixel].g, results[1].color[pixel].g, 2e-3F * results[0].color[pixel].g);
        }
        ASSERT_EQ(results[1].in_scattered.size(), 64U * 30U * 32U);
        for (std::size_t froxel = 0; froxel < results[0].in_scattered.size(); ++froxel) {
            const std::size_t x = froxel % 40;
            const std::size_t y = froxel / 40 % 24;
            const std::size_t z = froxel / (40 * 24);
            const float expected = results[0].in_scattered[froxel].g;
            ASSERT_NEAR(results[1].in_scattered[(z * 30 + y) * 64 + x].g, expected, 2e-3F * expected);
        }
    }
    FrameInputs inputs = view_of(0.0, 0.0).inputs;
    inputs.allocated_columns = {64, 20};
    const auto refused = feature().begin_frame(inputs);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().message, "allocated_columns must be between the grid's width and height and 1024.");
}

TEST_F(Views, HaveALimit) {
    FrameInputs inputs = view_of(0.0, 0.0).inputs;
    inputs.view = Feature::most_views;
    const auto refused = feature().begin_frame(inputs);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().message, "view must be less than 64.");
    EXPECT_FALSE(feature().volume(Feature::most_views));
    EXPECT_TRUE(feature().bindings(7).empty());
}

} // namespace
} // namespace tyndall::volumetrics::test
