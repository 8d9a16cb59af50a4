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

/// The part of froxel (x, y, slice) that the slit's sun lights: the mean over `samples` points to the cube, on the way
/// that the sampled point takes through the grid.
double lit_part(const Scene& scene, glm::uvec3 froxel, int samples) {
    const GridSettings& grid = scene.inputs.settings.grid;
    const double shape_m = static_cast<double>(grid.shape_m);
    const double log_ratio = std::log1p(static_cast<double>(grid.range_m) / shape_m);
    const auto boundary_m = [&](double k) { return shape_m * std::expm1(k / grid.slices * log_ratio); };
    const double near_m = boundary_m(froxel.z);
    const double far_m = boundary_m(froxel.z + 1.0);
    int lit = 0;
    for (int i = 0; i < samples * samples * samples; ++i) {
        const glm::dvec3 place(glm::ivec3(i % samples, i / samples % samples, i / samples / samples));
        const glm::dvec3 p = (place + 0.5) / static_cast<double>(samples);
        const double depth_m = near_m + p.z * (far_m - near_m);
        const double u = (froxel.x + p.x - 0.5) / (grid.width - 1.0);
        const glm::dvec4 render((2.0 * u - 1.0) * tan_x * depth_m, 0.0, -depth_m, 1.0);
        const glm::dvec4 shadow = glm::dmat4(scene.cascades.shadow_from_render[0]) * render;
        const auto texel = [&](double at) { return static_cast<std::size_t>(at * scene.cascade_size); };
        lit += scene.cascade_depths[texel(shadow.y) * scene.cascade_size + texel(shadow.x)] > 0.5F ? 1 : 0;
    }
    return static_cast<double>(lit) / (samples * samples * samples);
}

TEST_F(Temporal, StaticSceneConvergesToTheMeanOverEachFroxel) {
    Scene scene = temporal_scene();
    scene.inputs.settings.grid = {.width = 40, .height = 23, .slices = 16, .range_m = 64.0F, .shape_m = 16.0F};
    scene.inputs.settings.temporal.new_frame_weight = 0.001F; // the mean of all frames
    scene.inputs.settings.storage = StorageFormat::fp16;
    add_slit(scene, 140.0F);
    Result result;
    for (int i = 0; i < 256; ++i) {
        result = render(scene);
    }
    const double full = 10.0 / (4.0 * std::numbers::pi) * static_cast<double>(radiance_scale_for(scene.inputs));
    double squares = 0.0;
    double bias = 0.0;
    double sum = 0.0;
    int count = 0;
    for (unsigned z = 2; z < 15; z += 3) {
        for (unsigned x = 1; x < 39; ++x) {
            const double exact = lit_part(scene, {x, 11, z}, 24);
            const double found = static_cast<double>(result.in_scattered[(z * 23 + 11) * 40 + x].r) / full;
            squares += (found - exact) * (found - exact);
            bias += found - exact;
            sum += exact;
            ++count;
        }
    }
    std::printf("after 256 frames: rms %.4f, bias %.4f of a mean of %.3f\n", std::sqrt(squares / count), bias / count,
                sum / count);
    EXPECT_LE(std::sqrt(squares / count), 0.02);
    EXPECT_LE(std::abs(bias), 0.005 * sum);
}

TEST_F(Temporal, TurningTheCameraLeavesScatteringAsItWas) {
    Scene scene = temporal_scene();
    scene.inputs.settings.temporal.jitter = false;
    scene.inputs.settings.temporal.new_frame_weight = 0.001F;
    scene.inputs.medium.phase_g = 0.8F;
    scene.inputs.sun =
        Sun{.direction = glm::normalize(glm::vec3(0.3F, -0.4F, 0.8F)), .illuminance_lux = glm::vec3(5.0F)};
    const auto look = [&](double yaw, bool cut) {
        scene.inputs.camera.view_from_render = glm::rotate(glm::dmat4(1.0), yaw, glm::dvec3(0.2, 1.0, 0.0));
        scene.inputs.cut = cut;
        return render(scene);
    };
    for (int i = 0; i < 16; ++i) {
        (void)look(0.0, i == 0);
    }
    const Result turned = look(0.2, false);
    const Result fresh = look(0.2, true);
    const Result straight = look(0.0, true);
    std::size_t reused = 0;
    double worst = 0.0;
    double worst_unturned = 0.0;
    for (std::size_t i = 0; i < fresh.in_scattered.size(); ++i) {
        const std::size_t x = i % 160;
        if (turned.in_scattered[i].a > 16.0F && x > 0 && x < 159) { // 16 parts in 17 are history
            ++reused;
            const double exact = static_cast<double>(fresh.in_scattered[i].r);
            worst = std::max(worst, std::abs(static_cast<double>(turned.in_scattered[i].r) / exact - 1.0));
            worst_unturned =
                std::max(worst_unturned, std::abs(static_cast<double>(straight.in_scattered[i].r) / exact - 1.0));
        }
    }
    std::printf("history turned by 0.2: off by %.4f at most; not turned it would be %.2f\n", worst, worst_unturned);
    EXPECT_GT(reused, fresh.in_scattered.size() / 2);
    EXPECT_LE(worst, 0.01);
    EXPECT_GT(worst_unturned, 0.3);
}

TEST_F(Temporal, FastTranslationRaisesTheWeightOfTheNewFrameWhereTheAngleChanges) {
    Scene scene = temporal_scene();
    scene.inputs.settings.grid = {.width = 80, .height = 45, .slices = 32, .range_m = 64.0F, .shape_m = 16.0F};
    scene.inputs.settings.temporal.jitter = false;
    scene.inputs.settings.temporal.new_frame_weight = 0.001F;
    scene.inputs.sun =
        Sun{.direction = glm::normalize(glm::vec3(0.3F, -0.4F, 0.8F)), .illuminance_lux = glm::vec3(5.0F)};
    for (const float g : {0.0F, 0.8F}) {
        scene.inputs.medium.phase_g = g;
        const auto at = [&](double x_m, bool cut) {
            scene.inputs.camera.origin_m.x = x_m;
            scene.inputs.cut = cut;
            return render(scene);
        };
        for (int i = 0; i < 16; ++i) {
            (void)at(0.0, i == 0);
        }
        const Result moved = at(2.0, false);
        const Result fresh = at(2.0, true);
        double worst = 0.0;
        std::size_t forgotten = 0;
        for (std::size_t i = 0; i < fresh.in_scattered.size(); ++i) {
            const double exact = static_cast<double>(fresh.in_scattered[i].r);
            worst = std::max(worst, std::abs(static_cast<double>(moved.in_scattered[i].r) / exact - 1.0));
            forgotten += moved.in_scattered[i].a < 4.0F ? 1U : 0U;
        }
        std::printf("g %.1f, camera moved 2 m: off by %.3f at most\n", static_cast<double>(g), worst);
        EXPECT_LE(worst, 0.2); // where light falls off by e^2; history as it was would be off by several times
        const double part = static_cast<double>(forgotten) / static_cast<double>(fresh.in_scattered.size());
        std::printf("history of %.2f of the froxels nearly forgotten\n", part);
        if (g == 0.0F) {
            EXPECT_LT(part, 0.2); // evenly scattered light is the same from everywhere; what comes into view is new
        } else {
            EXPECT_GT(part, 0.5);
        }
    }
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
    const std::vector<std::function<void(Scene&)>> changes{
        [](Scene& s) { s.inputs.camera.clip_from_view[0][0] *= 1.1; },
        [](Scene& s) { s.inputs.settings.grid.range_m = 50.0F; },
        [](Scene& s) { s.inputs.settings.grid.shape_m = 8.0F; },
        [](Scene& s) { s.inputs.settings.grid.width = 32; },
        [](Scene& s) { s.inputs.settings.grid.slices = 12; },
        [](Scene& s) { s.image = {32, 16}; },
    };
    for (const auto& change : changes) {
        Scene scene = temporal_scene();
        scene.inputs.settings.grid = {.width = 40, .height = 23, .slices = 16, .range_m = 64.0F, .shape_m = 16.0F};
        add_slit(scene, 140.0F);
        (void)render(scene);
        (void)render(scene);
        change(scene);
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
