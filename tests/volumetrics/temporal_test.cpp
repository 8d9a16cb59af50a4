// History: a running mean that converges and does not stall, poison that is gone in the next frame, reprojection that
// follows the world, cuts that start anew.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>

#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

Scene temporal_scene() {
    Scene scene = plain_scene();
    scene.image = {16, 8};
    scene.inputs.settings.temporal = {.enabled = true, .new_frame_weight = 0.05F, .jitter = true};
    scene.inputs.medium.homogeneous = {.extinction_per_m = 0.01F, .albedo = glm::vec3(1.0F)};
    return scene;
}

/// The sun from above through a slit: lit for |x - 0.3 y| small, so that visibility varies within froxels.
void add_slit(Scene& scene, float extent_m) {
    scene.inputs.sun =
        Sun{.direction = {0.0F, -1.0F, 0.0F}, .illuminance_lux = glm::vec3(10.0F), .casts_shadows = true};
    scene.cascade_size = 256;
    scene.cascade_depths.assign(std::size_t{4} * 256 * 256, 0.0F);
    for (std::size_t i = 0; i < scene.cascade_depths.size(); ++i) {
        if ((i % 256 + i / 256 % 256) % 64 < 32) {
            scene.cascade_depths[i] = 1.0F;
        }
    }
    glm::mat4 shadow(0.0F);
    shadow[0][0] = 1.0F / extent_m;
    shadow[2][1] = 1.0F / extent_m;
    shadow[1][2] = -1.0F / extent_m;
    shadow[3] = glm::vec4(0.5F, 0.5F, 0.5F, 1.0F);
    for (glm::mat4& cascade : scene.cascades.shadow_from_render) {
        cascade = shadow;
    }
    scene.cascades.split_depth_m = glm::vec4(64.0F);
    scene.cascades.direction_count = {0.0F, -1.0F, 0.0F, 4.0F};
}

double rms_difference(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double d = static_cast<double>(a[i].r - b[i].r);
        sum += d * d;
    }
    return std::sqrt(sum / static_cast<double>(a.size()));
}

class Temporal : public FogTest {};

TEST_F(Temporal, StaticSceneConvergesAsARunningMean) {
    Scene scene = temporal_scene();
    scene.inputs.settings.grid = {.width = 40, .height = 23, .slices = 16, .range_m = 64.0F, .shape_m = 16.0F};
    scene.inputs.settings.temporal.new_frame_weight = 0.001F; // the mean of all frames
    add_slit(scene, 140.0F);
    std::vector<Result> frames;
    for (int i = 0; i < 256; ++i) {
        Result frame = render(scene);
        EXPECT_EQ(frame.in_scattered[7].a, static_cast<float>(i + 1)); // age
        if (i == 0 || i == 7 || i == 63 || i == 255) {
            frames.push_back(std::move(frame));
        }
    }
    const double after_1 = rms_difference(frames[0].in_scattered, frames[3].in_scattered);
    const double after_8 = rms_difference(frames[1].in_scattered, frames[3].in_scattered);
    const double after_64 = rms_difference(frames[2].in_scattered, frames[3].in_scattered);
    std::printf("distance to 256 frames after 1, 8, 64: %.4f %.4f %.4f\n", after_1, after_8, after_64);
    EXPECT_GT(after_1, 0.02);
    EXPECT_LT(after_8, after_1 / 2.8); // better than independent samples, whose error falls as 1 / sqrt(n)
    EXPECT_LT(after_64, after_1 / 12.0);
}

TEST_F(Temporal, ConstantInputDoesNotStallInHalfPrecision) {
    Scene scene = temporal_scene();
    scene.inputs.settings.storage = StorageFormat::fp16;
    scene.inputs.settings.grid = {.width = 16, .height = 8, .slices = 8, .range_m = 64.0F, .shape_m = 16.0F};
    scene.inputs.medium.ambient_radiance = glm::vec3(1.0F);
    add_slit(scene, 140.0F);
    scene.inputs.sun->illuminance_lux = glm::vec3(static_cast<float>(0.37 * 4.0 * std::numbers::pi));
    std::fill(scene.cascade_depths.begin(), scene.cascade_depths.end(), 0.0F); // all of it shadow
    for (int i = 0; i < 30; ++i) {
        (void)render(scene);
    }
    std::fill(scene.cascade_depths.begin(), scene.cascade_depths.end(),
              1.0F); // geometry: no change of the light itself
    Result result;
    for (int i = 0; i < 200; ++i) {
        result = render(scene);
    }
    const double scale = static_cast<double>(radiance_scale_for(scene.inputs));
    double mean = 0.0;
    for (const glm::vec4& v : result.in_scattered) {
        const double radiance = static_cast<double>(v.r) / scale;
        EXPECT_NEAR(radiance, 1.37, 0.005);
        mean += radiance / static_cast<double>(result.in_scattered.size());
    }
    // Round-to-nearest stops half a unit over the weight short: 0.7 %; a truncating store 1.4 %.
    EXPECT_NEAR(mean, 1.37, 0.001);
}

TEST_F(Temporal, PoisonInHistoryIsGoneInTheNextFrame) {
    for (const float value : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                              -std::numeric_limits<float>::infinity()}) {
        for (const double moved_m : {0.0, 0.5}) {
            Scene scene = temporal_scene();
            scene.inputs.settings.grid = {.width = 40, .height = 23, .slices = 16, .range_m = 64.0F, .shape_m = 16.0F};
            scene.inputs.medium.ambient_radiance = glm::vec3(2.0F);
            scene.inputs.cut = true;
            scene.poison = glm::vec4(1.0F, value, 1.0F, 5.0F);
            (void)render(scene);
            scene.inputs.cut = false; // the poison stays declared: another use of the image would make another image
            scene.inputs.camera.origin_m.x = moved_m; // sampled by filtering, and fetched
            const Result result = render(scene);
            for (const glm::vec4& v : result.in_scattered) {
                ASSERT_EQ(v, glm::vec4(2.0F, 2.0F, 2.0F, 1.0F));
            }
            for (const glm::vec4& v : result.color) {
                ASSERT_TRUE(std::isfinite(v.r) && std::isfinite(v.g) && std::isfinite(v.b));
            }
        }
    }
}

TEST_F(Temporal, CutEqualsTheFirstFrameOfANewRun) {
    Scene scene = temporal_scene();
    add_slit(scene, 140.0F);
    const Result first = render(scene);
    (void)render(scene);
    const Result third = render(scene);
    EXPECT_NE(first.in_scattered, third.in_scattered);
    scene.inputs.cut = true;
    EXPECT_EQ(render(scene).in_scattered, first.in_scattered);
}

TEST_F(Temporal, ChangeOfViewRangeOrGridStartsColdWithoutBeingTold) {
    const std::vector<std::function<void(FrameInputs&)>> changes{
        [](FrameInputs& in) { in.camera.clip_from_view[0][0] *= 1.1; },
        [](FrameInputs& in) { in.settings.grid.range_m = 50.0F; },
        [](FrameInputs& in) { in.settings.grid.shape_m = 8.0F; },
        [](FrameInputs& in) { in.settings.grid.width = 32; },
        [](FrameInputs& in) { in.settings.grid.slices = 12; },
    };
    for (const auto& change : changes) {
        Scene scene = temporal_scene();
        scene.inputs.settings.grid = {.width = 40, .height = 23, .slices = 16, .range_m = 64.0F, .shape_m = 16.0F};
        add_slit(scene, 140.0F);
        (void)render(scene);
        (void)render(scene);
        change(scene.inputs);
        const Result changed = render(scene);
        scene.inputs.cut = true;
        const Result new_run = render(scene);
        EXPECT_EQ(changed.in_scattered, new_run.in_scattered);
        EXPECT_EQ(changed.color, new_run.color);
    }
}

TEST_F(Temporal, ReprojectionFollowsTheWorldWhenTheCameraMovesAndTurns) {
    Scene scene = temporal_scene();
    scene.inputs.settings.temporal.jitter = false;
    scene.inputs.settings.temporal.new_frame_weight = 0.001F;
    // A field that is fixed to the world and smooth on the scale of a froxel.
    scene.lights = {{.position_range = {0.0F, 0.0F, 0.0F, 400.0F},
                     .intensity_type = glm::vec4(glm::vec3(500.0F), 0.0F),
                     .direction_radius = {0.0F, -1.0F, 0.0F, 4.0F},
                     .cone = {0.0F, 1.0F, 0.0F, 0.0F}}};
    const glm::dvec3 light_world(2.0, 3.0, -20.0);
    const auto look = [&](const glm::dvec3& eye, double yaw, bool cut) {
        scene.inputs.camera.origin_m = eye;
        scene.inputs.camera.view_from_render = glm::rotate(glm::dmat4(1.0), yaw, glm::dvec3(0.0, 1.0, 0.0));
        scene.lights[0].position_range = glm::vec4(light_world - eye, 400.0);
        scene.inputs.cut = cut;
        return render(scene);
    };
    const glm::dvec3 start(0.0, 1.0, 0.5);
    const glm::dvec3 end(0.4, 1.2, -0.6);
    (void)look(start, 0.0, true);
    const Result blended = look(end, 0.03, false);
    const Result fresh = look(end, 0.03, true);
    double worst = 0.0;
    std::size_t reused = 0;
    for (std::size_t i = 0; i < fresh.in_scattered.size(); ++i) {
        const std::size_t x = i % 160;
        const std::size_t slice = i / (160 * 90);
        if (blended.in_scattered[i].a > 1.5F && x > 0 && x < 159 && slice > 2 && slice < 62) {
            ++reused;
            // Half of the blended value is history.
            const double relative =
                std::abs(static_cast<double>(blended.in_scattered[i].r / fresh.in_scattered[i].r) - 1.0);
            worst = std::max(worst, 2.0 * relative);
        }
    }
    EXPECT_GT(reused, fresh.in_scattered.size() * 8 / 10);
    EXPECT_LE(worst, 0.06);
    const double without_motion = rms_difference(look(start, 0.0, true).in_scattered, fresh.in_scattered);
    EXPECT_GT(without_motion, 10.0 * rms_difference(blended.in_scattered, fresh.in_scattered));
}

TEST_F(Temporal, RadianceScaleChangesDoNotFlash) {
    Scene scene = temporal_scene();
    scene.inputs.settings.storage = StorageFormat::fp16;
    scene.inputs.settings.grid = {.width = 16, .height = 8, .slices = 8, .range_m = 64.0F, .shape_m = 16.0F};
    scene.inputs.medium.ambient_radiance = glm::vec3(30000.0F);
    (void)render(scene);
    scene.inputs.medium.homogeneous.emission_per_m = glm::vec3(100.0F); // leaves fp16's range: half the scale from here
    ASSERT_LT(radiance_scale_for(scene.inputs), 1.0F);
    const Result result = render(scene);
    for (const glm::vec4& v : result.in_scattered) {
        EXPECT_EQ(v.r, 30000.0F * radiance_scale_for(scene.inputs));
        EXPECT_EQ(v.a, 2.0F);
    }
}

} // namespace
} // namespace tyndall::volumetrics::test
