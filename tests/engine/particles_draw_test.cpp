// Billboards on a device: coverage, order, light and fog of single particles against closed forms.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "tests/engine/particle_picture.hpp"

namespace tyndall::test {
namespace {

TEST_F(ParticlesDrawTest, TheMiddleHasTheParticlesAlphaAndAmbientLight) {
    expect_near(center({resting({0, 0, -10}, 1.0F, 0.4F)}, {}), over(background, 4.0 * albedo, 0.4), 1e-5);
}

TEST_F(ParticlesDrawTest, CoverageFallsToTheRimAndIsRound) {
    const float radius_m = 2.0F;
    const std::vector<glm::vec4> pixels = draw({resting({0, 0, -10}, radius_m, 1.0F)}, {});
    // The view is 10 m wide at the particle.
    for (std::uint32_t y = 0; y < size_px; ++y) {
        for (std::uint32_t x = 0; x < size_px; ++x) {
            const double dx = (static_cast<double>(x) - 32.0) / size_px * 10.0 / 2.0;
            const double dy = (static_cast<double>(y) - 32.0) / size_px * 10.0 / 2.0;
            const double body = std::max(1.0 - dx * dx - dy * dy, 0.0);
            const double expected = background.r + (2.0 - background.r) * body * body;
            ASSERT_NEAR(static_cast<double>(pixels[y * size_px + x].r), expected, 2e-4) << x << ", " << y;
        }
    }
}

TEST_F(ParticlesDrawTest, SurfacesFadeAndHide) {
    const auto coverage = [&](double surface_m) {
        const glm::dvec4 pixel = center({resting({0, 0, -10}, 2.0F, 1.0F)}, {.surface_m = surface_m});
        return (background.r - pixel.r) / (background.r - 2.0);
    };
    EXPECT_NEAR(coverage(12.5), 1.0, 1e-5); // a radius and more behind it
    EXPECT_NEAR(coverage(11.0), 0.5, 1e-4);
    EXPECT_NEAR(coverage(10.2), 0.1, 1e-4);
    EXPECT_NEAR(coverage(9.9), 0.0, 1e-9);
    EXPECT_NEAR(coverage(5.0), 0.0, 1e-9);
}

TEST_F(ParticlesDrawTest, NearerParticlesCoverFartherOnesInAnyOrderOfEmitters) {
    ParticleEmitter far = resting({0, 0, -12}, 1.0F, 0.5F);
    ParticleEmitter near = resting({0, 0, -8}, 1.0F, 0.75F);
    near.albedo = {1.0F, 0.0F, 0.0F};
    const glm::dvec4 expected = over(over(background, 4.0 * albedo, 0.5), {4.0, 0.0, 0.0}, 0.75);
    expect_near(center({far, near}, {}), expected, 1e-5);
    expect_near(center({near, far}, {}), expected, 1e-5);
}

TEST_F(ParticlesDrawTest, AnIntervalHoldsWhatLiesBetweenItsPanes) {
    ParticleEmitter far = resting({0, 0, -12}, 1.0F, 0.5F);
    ParticleEmitter near = resting({0, 0, -8}, 1.0F, 0.75F);
    near.albedo = {1.0F, 0.0F, 0.0F};
    const auto drawn = [&](std::vector<std::uint32_t> intervals) {
        return center({near, far}, {.split_depths_m = {20.0F, 10.0F, 8.0F}, .intervals = std::move(intervals)});
    };
    expect_near(drawn({0}), background, 0.0);
    expect_near(drawn({1}), over(background, 4.0 * albedo, 0.5), 1e-5);
    expect_near(drawn({2}), background, 0.0);
    expect_near(drawn({3}), over(background, {4.0, 0.0, 0.0}, 0.75), 1e-5); // at the very depth of the last pane
    expect_near(drawn({0, 1, 2, 3}), over(over(background, 4.0 * albedo, 0.5), {4.0, 0.0, 0.0}, 0.75), 1e-5);
}

TEST_F(ParticlesDrawTest, FogAndLightOfTheVolumeAtTheParticlesOwnDepth) {
    const Fog fog;
    for (const double depth_m : {0.5, 2.0, 7.3, 20.0, 39.0}) {
        const double transmittance = std::exp(-fog.extinction_per_m * depth_m);
        const glm::dvec3 radiance =
            fog.in_scattered * albedo * transmittance + glm::dvec3(fog.source * (1.0 - transmittance));
        SCOPED_TRACE(depth_m);
        expect_near(center({resting({0, 0, -depth_m}, static_cast<float>(0.03 * depth_m), 0.6F)}, {.fog = fog}),
                    over(background, radiance, 0.6), 1e-4);
    }
}

gpu::GpuLight lamp_at(const glm::vec3& position, float range_m) {
    gpu::GpuLight light{};
    light.position_range = glm::vec4(position, range_m);
    light.intensity_type = glm::vec4(100.0F, 50.0F, 25.0F, 0.0F);
    light.cone = glm::vec4(0.0F, 1.0F, 0.0F, 0.0F);
    return light;
}

/// What the volume leaves out lights particles by itself, and shines in the air in front of them.
TEST_F(ParticlesDrawTest, LampsThatTheVolumeLeavesOut) {
    Picture picture{.fog = Fog{.extinction_per_m = 1e-9, .source = 0.0}};
    picture.lights = {lamp_at({3.0F, 0.0F, -10.0F}, 20.0F), lamp_at({0.0F, -4.0F, -10.0F}, 20.0F)};
    const auto irradiance = [](double d) { return (1.0 - std::pow(d / 20.0, 4.0)) / (d * d); };
    const glm::dvec3 light = glm::dvec3(100, 50, 25) * ((irradiance(3.0) + irradiance(4.0)) / (4.0 * std::numbers::pi));
    const ParticleEmitter particle = resting({0, 0, -10}, 0.3F, 0.6F);
    expect_near(center({particle}, picture), over(background, albedo * (light + 2.0), 0.6), 1e-2);

    // In the middle of a particle of this radius the mean of 1 / d^2 is 3 / radius^2.
    picture.lights = {lamp_at({0.0F, 0.0F, -10.0F}, 20.0F)};
    const ParticleEmitter large = resting({0, 0, -10}, 1.0F, 0.6F);
    const glm::dvec4 inside = center({large}, picture);
    EXPECT_GT(inside.r, 0.6 * 0.5 * 100.0 / (4.0 * std::numbers::pi) / (0.5 + 1.0 / 3.0) * 0.9);
    EXPECT_LT(inside.r, 0.4 * 10.0 + 0.6 * 0.5 * (2.0 + 100.0 / (4.0 * std::numbers::pi) * 3.0) * 1.1);

    // A black one in air so thin that light loses nothing: sigma / (4 pi h) times the angle under which the lamp sees
    // the way to it.
    picture.fog->lamp_extinction_per_m = 1e-5F;
    picture.lights = {lamp_at({3.0F, 0.0F, -6.0F}, 1e4F)};
    picture.lights[0].intensity_type *= 1e6F;
    picture.lights[0].intensity_type.w = 0.0F;
    ParticleEmitter black = particle;
    black.albedo = glm::vec3(0.0F);
    const double angle = std::atan(6.0 / 3.0) + std::atan(4.0 / 3.0);
    const glm::dvec3 glow = glm::dvec3(100, 50, 25) * (1e6 * 1e-5 / (4.0 * std::numbers::pi * 3.0) * angle);
    expect_near(center({black}, picture), over(background, glow, 0.6), 2e-2);
}

TEST_F(ParticlesDrawTest, SunReachesWhatItsCascadesLeaveLit) {
    const ParticleEmitter particle = resting({0, 0, -10}, 1.0F, 0.4F);
    Picture picture{.light = {.sun_illuminance_lux = {400.0F, 300.0F, 200.0F}}};
    const glm::dvec3 sunlit = albedo * glm::dvec3(400, 300, 200) / (4.0 * std::numbers::pi);
    expect_near(center({particle}, picture), over(background, sunlit, 0.4), 1e-5);
    picture.shadow_depth = 0.6F; // the particle lies at 0.5
    expect_near(center({particle}, picture), over(background, sunlit, 0.4), 1e-5);
    picture.shadow_depth = 0.4F;
    expect_near(center({particle}, picture), over(background, {0.0, 0.0, 0.0}, 0.4), 1e-5);
}

TEST_F(ParticlesDrawTest, LocalLightsAddUpAsFarAsTheirShadowMapsLeaveThem) {
    Picture picture;
    picture.shadow_depth = 1.0F;
    for (const float x : {3.0F, -4.0F}) {
        picture.lights.push_back(lamp_at({x, 0.0F, -10.0F}, 20.0F));
    }
    const auto irradiance = [](double d) { return (1.0 - std::pow(d / 20.0, 4.0)) / (d * d); };
    const glm::dvec3 light = glm::dvec3(100, 50, 25) * ((irradiance(3.0) + irradiance(4.0)) / (4.0 * std::numbers::pi));
    expect_near(center({resting({0, 0, -10}, 1.0F, 0.4F)}, picture), over(background, albedo * (light + 4.0), 0.4),
                1e-5);

    picture.lights.front().cone.z = 1.0F;
    picture.caster_m = 3.1; // behind the particle
    expect_near(center({resting({0, 0, -10}, 1.0F, 0.4F)}, picture), over(background, albedo * (light + 4.0), 0.4),
                1e-5);
    picture.caster_m = 2.9;
    const glm::dvec3 second = glm::dvec3(100, 50, 25) * (irradiance(4.0) / (4.0 * std::numbers::pi));
    for (const bool sun : {true, false}) {
        picture.shadow_depth = sun ? std::optional(1.0F) : std::nullopt;
        expect_near(center({resting({0, 0, -10}, 1.0F, 0.4F)}, picture), over(background, albedo * (second + 4.0), 0.4),
                    1e-5);
    }
}

TEST_F(ParticlesDrawTest, ParticlesBelowAPixelKeepTheirSumAndDoNotVanish) {
    // A pixel is 0.154 m wide at the particle; its radius is a fifth of that.
    const float radius_m = 0.03F;
    const double pixel_m = 10.0 / size_px;
    const double expected = std::numbers::pi / 3.0 * std::pow(static_cast<double>(radius_m) / pixel_m, 2.0);
    double sum = 0.0;
    double least = 1e9;
    constexpr int steps = 5;
    for (int i = 0; i < steps * steps; ++i) {
        const double x = pixel_m * (i % steps) / steps;
        const double y = pixel_m * (i / steps) / steps; // NOLINT(bugprone-integer-division)
        double covered = 0.0;
        for (const glm::vec4& pixel : draw({resting({x, y, -10}, radius_m, 1.0F)}, {})) {
            covered += (background.r - static_cast<double>(pixel.r)) / (background.r - 2.0);
        }
        sum += covered;
        least = std::min(least, covered);
    }
    EXPECT_NEAR(sum / (steps * steps), expected, 0.05 * expected);
    EXPECT_GT(least, 0.4 * expected);
}

TEST_F(ParticlesDrawTest, AFrameIsAFunctionOfItsTimeAlone) {
    ParticleEmitter smoke = resting({0, -1, -10}, 0.5F, 0.5F);
    smoke.kind = engine::ParticleKind::smoke;
    smoke.rate_per_s = 20.0;
    smoke.velocity_m_s = {0.0F, 0.5F, 0.0F};
    smoke.velocity_spread_m_s = {0.3F, 0.3F, 0.3F};
    smoke.turbulence_m_s = 0.2F;
    Picture picture;
    const auto at = [&](double time_s) {
        picture.view.time_s = time_s;
        return draw({smoke}, picture);
    };
    const std::vector<glm::vec4> first = at(3.0);
    const std::vector<glm::vec4> later = at(1e5);
    EXPECT_TRUE(at(3.0) == first);
    EXPECT_FALSE(later == first);
    const double covered = background.r - static_cast<double>(first[(size_px / 2) * size_px + size_px / 2].r);
    EXPECT_GT(covered, 1.0);
}

} // namespace
} // namespace tyndall::test
