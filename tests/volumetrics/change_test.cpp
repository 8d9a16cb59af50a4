// What history keeps of light that changes: at most 1 part in 100 after 8 frames of what went, all of what stays.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include <glm/gtc/matrix_transform.hpp>

#include "features/volumetrics/change.hpp"
#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

gpu::GpuLight lamp(const glm::vec3& position, float range_m, float candela) {
    return {.position_range = glm::vec4(position, range_m),
            .intensity_type = glm::vec4(glm::vec3(candela), 0.0F),
            .direction_radius = {0.0F, -1.0F, 0.0F, 0.02F},
            .cone = {0.0F, 1.0F, 0.0F, 0.0F}};
}

gpu::GpuLight spot(const glm::vec3& position, float range_m, const glm::vec3& direction, float cos_outer) {
    gpu::GpuLight light = lamp(position, range_m, 100.0F);
    light.intensity_type.w = 1.0F;
    light.direction_radius = glm::vec4(glm::normalize(direction), 0.02F);
    light.cone = {1000.0F, -cos_outer * 1000.0F, 0.0F, 0.0F}; // an edge as hard as can be described
    return light;
}

FrameMemory memory(const FrameInputs& frame) {
    return memory_of(frame, volumetric_parameters(frame, std::nullopt));
}

TEST(LightChanges, AreTheLightsThatDiffer) {
    FrameInputs before;
    before.camera.clip_from_view = test_projection();
    before.lights = {lamp({1, 2, -3}, 10, 5), lamp({4, 0, -9}, 20, 7), lamp({0, 0, -5}, 30, 9)};
    EXPECT_TRUE(light_changes(before, memory(before)).empty());

    FrameInputs frame = before;
    frame.lights[1].intensity_type.r = 8.0F;
    std::vector<LightChange> changes = light_changes(frame, memory(before));
    ASSERT_EQ(changes.size(), 1U);
    EXPECT_EQ(changes[0].before.intensity_type.r, 7.0F);
    EXPECT_EQ(changes[0].now.intensity_type.r, 8.0F);

    frame = before;
    frame.lights.erase(frame.lights.begin() + 1);
    changes = light_changes(frame, memory(before));
    ASSERT_EQ(changes.size(), 1U);
    EXPECT_EQ(changes[0].before.position_range, before.lights[1].position_range);
    EXPECT_EQ(changes[0].now.intensity_type, glm::vec4(0.0F));
    changes = light_changes(before, memory(frame)); // and back on
    ASSERT_EQ(changes.size(), 1U);
    EXPECT_EQ(changes[0].before.intensity_type, glm::vec4(0.0F));
    EXPECT_EQ(changes[0].now.intensity_type, before.lights[1].intensity_type);
}

TEST(LightChanges, AreThoseOfTheWorldNotOfTheCamera) {
    FrameInputs before;
    before.camera.clip_from_view = test_projection();
    before.camera.origin_m = {1000.3, 20.1, -400.7};
    const glm::dvec3 world(1003.1, 22.2, -431.9);
    before.lights = {lamp(glm::vec3(world - before.camera.origin_m), 10, 5)};
    FrameInputs frame = before;
    frame.camera.origin_m += glm::dvec3(0.173, -0.052, 7.31);
    frame.lights = {lamp(glm::vec3(world - frame.camera.origin_m), 10, 5)};
    EXPECT_TRUE(light_changes(frame, memory(before)).empty());
    frame.lights[0].position_range.x += 0.01F;
    const auto changes = light_changes(frame, memory(before));
    ASSERT_EQ(changes.size(), 1U);
    EXPECT_NEAR(glm::distance(changes[0].before.position_range, changes[0].now.position_range), 0.01F, 1e-4F);
}

TEST(LightChanges, StandInReachesWhatAllTheRestReach) {
    FrameInputs before;
    before.camera.clip_from_view = test_projection();
    FrameInputs frame = before;
    for (int i = 0; i < 40; ++i) {
        const glm::vec3 at(static_cast<float>(i % 7) * 3.0F, static_cast<float>(i % 5), -static_cast<float>(i));
        before.lights.push_back(lamp(at, 1.0F + static_cast<float>(i % 3), 5.0F));
        frame.lights.push_back(lamp(at + glm::vec3(0.0F, 2.0F, 0.0F), 2.0F, 5.0F));
    }
    const auto changes = light_changes(frame, memory(before));
    ASSERT_EQ(changes.size(), std::size_t{TYNDALL_LIGHT_CHANGE_COUNT});
    const glm::vec4 all = changes.back().before.position_range;
    for (std::size_t i = TYNDALL_LIGHT_CHANGE_COUNT - 1; i < before.lights.size(); ++i) {
        for (const glm::vec4& one : {before.lights[i].position_range, frame.lights[i].position_range}) {
            EXPECT_LE(glm::distance(glm::vec3(all), glm::vec3(one)) + one.w, all.w * 1.00001F);
        }
    }
}

TEST(LightChanges, EverywhereInPartsOfTheLight) {
    FrameInputs before;
    before.camera.clip_from_view = test_projection();
    before.sun = Sun{.illuminance_lux = glm::vec3(100.0F)};
    before.medium.ambient_radiance = glm::vec3(2.0F);
    EXPECT_EQ(change_everywhere(before, memory(before)), 0.0F);
    FrameInputs frame = before;
    frame.medium.ambient_radiance.g = 1.5F;
    EXPECT_FLOAT_EQ(change_everywhere(frame, memory(before)), 0.25F);
    frame = before;
    frame.sun->illuminance_lux = glm::vec3(90.0F);
    EXPECT_FLOAT_EQ(change_everywhere(frame, memory(before)), 0.1F);
    frame.sun.reset();
    EXPECT_EQ(change_everywhere(frame, memory(before)), 1.0F);
    frame = before;
    frame.medium.phase_g = 0.1F;
    EXPECT_EQ(change_everywhere(frame, memory(before)), 1.0F);
    frame = before;
    frame.sun->direction = glm::normalize(glm::vec3(0.001F, -1.0F, 0.0F));
    EXPECT_EQ(change_everywhere(frame, memory(before)), 0.0F); // without shadow, scattered evenly
    before.sun->casts_shadows = true;
    frame.sun->casts_shadows = true;
    EXPECT_NEAR(change_everywhere(frame, memory(before)), 0.2F, 0.01F);
}

/// 8 frames after `change` in a scene that had settled, beside the same scene as if it had always been so, and as it
/// was before.
class Change : public FogTest {
protected:
    struct Outcome {
        Result left;
        Result settled;
        Result before;
    };
    static Scene lit_scene() {
        Scene scene = plain_scene();
        scene.image = {16, 8};
        scene.inputs.settings.grid = {.width = 40, .height = 24, .slices = 32, .range_m = 64.0F, .shape_m = 16.0F};
        scene.inputs.settings.temporal = {.enabled = true, .new_frame_weight = 0.05F, .jitter = false};
        scene.inputs.medium.homogeneous = {.extinction_per_m = 0.01F, .albedo = glm::vec3(1.0F)};
        scene.inputs.medium.ambient_radiance = glm::vec3(0.01F);
        return scene;
    }
    Outcome eight_frames_after(Scene scene, const std::function<void(Scene&)>& change) {
        Outcome outcome;
        scene.inputs.cut = true;
        for (int i = 0; i < 24; ++i) {
            outcome.before = render(scene);
            scene.inputs.cut = false;
        }
        change(scene);
        for (int i = 0; i < 8; ++i) {
            outcome.left = render(scene);
        }
        scene.inputs.cut = true;
        outcome.settled = render(scene);
        return outcome;
    }
    /// The largest part that is left of what went or has yet to come, over the froxels where the change is more than
    /// 1e-4 of the largest.
    static double residual(const Outcome& o) {
        float largest = 0.0F;
        for (std::size_t i = 0; i < o.left.in_scattered.size(); ++i) {
            largest = std::max(largest, std::abs(o.before.in_scattered[i].r - o.settled.in_scattered[i].r));
        }
        EXPECT_GT(largest, 0.0F);
        double worst = 0.0;
        for (std::size_t i = 0; i < o.left.in_scattered.size(); ++i) {
            const float light = std::max(o.before.in_scattered[i].r, o.settled.in_scattered[i].r);
            const float changed = std::abs(o.before.in_scattered[i].r - o.settled.in_scattered[i].r);
            if (changed > 1e-4F * largest) {
                const float left = std::abs(o.left.in_scattered[i].r - o.settled.in_scattered[i].r);
                worst = std::max(worst, static_cast<double>(left / light));
            }
        }
        return worst;
    }
    /// The part of the froxels that the change does not reach, and of those the part that kept its history.
    static std::pair<double, double> untouched(const Outcome& o) {
        std::size_t same = 0;
        std::size_t kept = 0;
        for (std::size_t i = 0; i < o.left.in_scattered.size(); ++i) {
            if (o.before.in_scattered[i].r == o.settled.in_scattered[i].r) {
                ++same;
                kept += o.left.in_scattered[i].a > 20.0F ? 1U : 0U;
            }
        }
        return {static_cast<double>(same) / static_cast<double>(o.left.in_scattered.size()),
                static_cast<double>(kept) / static_cast<double>(same)};
    }
};

TEST_F(Change, OfALocalLightIsSeenWithinEightFramesAndOnlyWhereItReaches) {
    const std::vector<std::pair<const char*, std::function<void(Scene&)>>> changes{
        {"off", [](Scene& s) { s.lights.erase(s.lights.begin()); }},
        {"all off", [](Scene& s) { s.lights.clear(); }},
        {"dimmed", [](Scene& s) { s.lights[0].intensity_type *= glm::vec4(0.9F, 0.9F, 0.9F, 1.0F); }},
        {"moved", [](Scene& s) { s.lights[0].position_range.x += 5.0F; }},
        {"moved a little", [](Scene& s) { s.lights[0].position_range.x += 0.05F; }},
        {"spot turned",
         [](Scene& s) {
             s.lights[1].direction_radius = {0.6F, -0.8F, 0.0F, 0.02F};
         }},
        {"spot narrowed",
         [](Scene& s) {
             s.lights[1].cone = {1000.0F, -980.0F, 0.0F, 0.0F};
         }},
        {"one came",
         [](Scene& s) {
             s.lights.push_back(lamp({-3, -2, -9}, 3.0F, 10.0F));
         }},
    };
    for (const auto& [name, change] : changes) {
        Scene scene = lit_scene();
        scene.inputs.medium.phase_g = 0.5F;
        scene.lights = {lamp({-4.0F, 1.0F, -14.0F}, 8.0F, 50.0F),
                        spot({6.0F, 6.0F, -20.0F}, 14.0F, {0.0F, -1.0F, 0.0F}, 0.9F)};
        const Outcome outcome = eight_frames_after(scene, change);
        const auto [same, kept] = untouched(outcome);
        std::printf("%s: %.2e left, %.2f of the froxels the same, %.3f of them kept\n", name, residual(outcome), same,
                    kept);
        EXPECT_LE(residual(outcome), 0.01) << name;
        EXPECT_GT(same, 0.5) << name;
        EXPECT_GT(kept, 0.75) << name;
    }
}

TEST_F(Change, OfManyLightsAtOnceLeavesNothingBehind) {
    Scene scene = lit_scene();
    for (int i = 0; i < 40; ++i) {
        const int row = i / 8;
        scene.lights.push_back(
            lamp({-6.0F + static_cast<float>(i % 8), static_cast<float>(i % 3), -5.0F - static_cast<float>(row) * 2.0F},
                 2.0F, 10.0F));
    }
    EXPECT_LE(residual(eight_frames_after(scene, [](Scene& s) { s.lights.clear(); })), 0.01);
}

TEST_F(Change, OfSunAmbientAndPhaseIsSeenWithinEightFrames) {
    const std::vector<std::pair<const char*, std::function<void(Scene&)>>> changes{
        {"sun off", [](Scene& s) { s.inputs.sun.reset(); }},
        {"sun dimmed", [](Scene& s) { s.inputs.sun->illuminance_lux *= 0.5F; }},
        {"sun turned", [](Scene& s) { s.inputs.sun->direction = glm::normalize(glm::vec3(0.2F, -1.0F, 0.4F)); }},
        {"ambient", [](Scene& s) { s.inputs.medium.ambient_radiance = glm::vec3(3.0F); }},
        {"ambient's direction", [](Scene& s) { s.inputs.medium.ambient_sh_1[0] = glm::vec3(0.01F); }},
        {"phase", [](Scene& s) { s.inputs.medium.phase_g = -0.3F; }},
    };
    for (const auto& [name, change] : changes) {
        Scene scene = lit_scene();
        scene.inputs.medium.phase_g = 0.5F;
        scene.inputs.sun = Sun{.direction = {0.0F, -1.0F, 0.0F}, .illuminance_lux = glm::vec3(10.0F)};
        EXPECT_LE(residual(eight_frames_after(scene, change)), 0.01) << name;
    }
}

TEST_F(Change, OfAMediumIsThereInTheNextFrameAndCostsNoHistory) {
    const LocalVolume cloud{.center_m = {0.0F, 0.0F, -12.0F}, .half_size_m = glm::vec3(3.0F), .extinction_per_m = 0.5F};
    const std::vector<std::pair<const char*, std::function<void(Medium&)>>> changes{
        {"denser", [](Medium& m) { m.homogeneous.extinction_per_m = 0.05F; }},
        {"height fog", [](Medium& m) { m.height.extinction_per_m = 0.1F; }},
        {"a volume goes", [](Medium& m) { m.volumes.clear(); }},
        {"a volume moves", [](Medium& m) { m.volumes[0].center_m.x = 4.0F; }},
        {"emission", [](Medium& m) { m.homogeneous.emission_per_m = glm::vec3(0.01F); }},
    };
    for (const auto& [name, change] : changes) {
        Scene scene = lit_scene();
        scene.inputs.settings.light_path = LightPath::none;
        scene.inputs.medium.volumes = {cloud};
        scene.lights = {lamp({-4.0F, 1.0F, -14.0F}, 8.0F, 50.0F)};
        for (int i = 0; i < 4; ++i) {
            (void)render(scene);
        }
        change(scene.inputs.medium);
        const Result next = render(scene);
        EXPECT_GT(next.in_scattered[1000].a, 4.0F) << name;
        scene.inputs.cut = true;
        const Result fresh = render(scene);
        EXPECT_EQ(next.density, fresh.density) << name;
        for (std::size_t i = 0; i < fresh.color.size(); ++i) {
            ASSERT_NEAR(next.color[i].r, fresh.color[i].r, 1e-5F * fresh.color[i].r) << name;
        }
    }
}

TEST_F(Change, OfWhatWeakensLightIsSeenWithinEightFrames) {
    const LocalVolume cloud{.center_m = {0.0F, 0.0F, -12.0F}, .half_size_m = glm::vec3(3.0F), .extinction_per_m = 0.5F};
    const std::vector<std::pair<const char*, std::function<void(Scene&)>>> changes{
        {"denser", [](Scene& s) { s.inputs.medium.homogeneous.extinction_per_m = 0.2F; }},
        {"height fog", [](Scene& s) { s.inputs.medium.height.extinction_per_m = 0.1F; }},
        {"no longer", [](Scene& s) { s.inputs.settings.light_path = LightPath::none; }},
        {"a volume in the lamp's light comes", [cloud](Scene& s) { s.inputs.medium.volumes = {cloud}; }},
    };
    for (const auto& [name, change] : changes) {
        Scene scene = lit_scene();
        scene.lights = {lamp({-4.0F, 1.0F, -14.0F}, 8.0F, 50.0F)};
        scene.inputs.medium.homogeneous.extinction_per_m = 0.1F;
        scene.inputs.settings.light_path = LightPath::march;
        EXPECT_LE(residual(eight_frames_after(scene, change)), 0.01) << name;
    }
}

/// A light that moves every frame: how far behind it the brightest place of the fog is.
TEST_F(Change, FogFollowsALightThatMoves) {
    Scene scene = lit_scene();
    const auto at = [](int frame) {
        return lamp({-10.0F + 0.2F * static_cast<float>(frame), 0.0F, -12.0F}, 6.0F, 50.0F);
    };
    const auto centroid = [](const Result& result) {
        double sum = 0.0;
        double first = 0.0;
        for (std::size_t i = 0; i < result.in_scattered.size(); ++i) {
            const double light = static_cast<double>(result.in_scattered[i].r) - 0.01;
            sum += light;
            first += light * static_cast<double>(i % 40);
        }
        return first / sum;
    };
    Result moving;
    for (int i = 0; i < 60; ++i) {
        scene.lights = {at(i)};
        moving = render(scene);
    }
    scene.inputs.cut = true;
    const double lag = centroid(render(scene)) - centroid(moving);
    scene.lights = {at(60)};
    const double step = centroid(render(scene)) - centroid(moving) - lag;
    std::printf("the fog's light is %.2f frames behind the lamp\n", lag / step);
    EXPECT_LT(std::abs(lag), 0.5 * step);
}

} // namespace
} // namespace tyndall::volumetrics::test
