// Particles of fog on the device: the medium of every froxel against the sum of all particles' exact means over its
// slice in double precision, and that all that only froxels know counts them.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <random>

#include <glm/gtc/quaternion.hpp>

#include "features/volumetrics/airlight.hpp"
#include "features/volumetrics/change.hpp"
#include "features/volumetrics/depth_range.hpp"
#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

constexpr std::uint32_t width = 33;
constexpr std::uint32_t height = 17;
constexpr std::uint32_t slices = 32;
constexpr double range_m = 64.0;
constexpr double shape_m = 16.0;

Scene small_scene() {
    Scene scene = plain_scene();
    scene.image = {8, 8};
    scene.inputs.settings.grid = {
        .width = width, .height = height, .slices = slices, .range_m = 64.0F, .shape_m = 16.0F};
    scene.inputs.camera.origin_m = {1000.0, 20.0, -300.0};
    return scene;
}

/// All over the view and a little beyond it, around the eye too, from a twentieth of a slice to many slices.
std::vector<FogParticle> crowd(std::size_t count) {
    std::mt19937 random(11);
    const auto uniform = [&](double low, double high) {
        return static_cast<float>(low + (high - low) * static_cast<double>(random()) / 4294967295.0);
    };
    std::vector<FogParticle> particles;
    for (std::size_t i = 0; i < count; ++i) {
        const float away_m = std::exp2(uniform(2.0, 6.2));
        particles.push_back({.position_m = {uniform(-1.2, 1.2) * away_m, uniform(-0.8, 0.8) * away_m,
                                            i % 50 == 0 ? uniform(-1.0, 1.0) : -away_m},
                             .radius_m = std::exp2(uniform(-4.0, 1.5)),
                             .extinction_per_m = uniform(0.01, 2.0),
                             .albedo = {uniform(0.0, 1.0), uniform(0.0, 1.0), uniform(0.0, 1.0)}});
    }
    return particles;
}

double boundary_m(std::uint32_t slice) {
    return shape_m * std::expm1(static_cast<double>(slice) / slices * std::log1p(range_m / shape_m));
}

/// A column's ray from the eye: a metre of view depth along it.
glm::dvec3 column_ray(std::uint32_t x, std::uint32_t y) {
    return {tan_x * (2.0 * x / (width - 1.0) - 1.0), -tan_y * (2.0 * y / (height - 1.0) - 1.0), -1.0};
}

/// Integral of the particle's profile along the ray from the eye, up to `length_m` of it, by the antiderivative.
double profile_up_to(const FogParticle& particle, const glm::dvec3& unit_ray, double length_m) {
    const glm::dvec3 centre(particle.position_m);
    const auto radius = static_cast<double>(particle.radius_m);
    const double nearest = glm::dot(centre, unit_ray);
    const double inside = 1.0 - glm::dot(centre - nearest * unit_ray, centre - nearest * unit_ray) / (radius * radius);
    if (inside <= 0.0) {
        return 0.0;
    }
    const auto antiderivative = [&](double s) {
        return inside * inside * s - 2.0 / 3.0 * inside * s * s * s + s * s * s * s * s / 5.0;
    };
    const double reach = std::sqrt(inside);
    const double s = std::clamp((length_m - nearest) / radius, -reach, reach);
    return radius * (antiderivative(s) - antiderivative(-reach));
}

/// Scattering and extinction of a froxel.
glm::dvec4 exact_medium(const std::vector<FogParticle>& particles, const glm::dvec3& ray, std::uint32_t slice) {
    const double stretch = glm::length(ray);
    const double near_m = boundary_m(slice) * stretch;
    const double far_m = boundary_m(slice + 1) * stretch;
    glm::dvec4 sum(0.0);
    for (const FogParticle& particle : particles) {
        const double mean =
            (profile_up_to(particle, ray / stretch, far_m) - profile_up_to(particle, ray / stretch, near_m)) /
            (far_m - near_m);
        sum += mean * static_cast<double>(particle.extinction_per_m) * glm::dvec4(particle.albedo, 1.0);
    }
    return sum;
}

bool contains(const std::vector<std::string>& all, const std::string& one) {
    return std::find(all.begin(), all.end(), one) != all.end();
}

class FogParticles : public FogTest {
protected:
    /// Scattering and extinction of each froxel, 1/m; behind them the extinction of each channel, where it is coloured.
    std::vector<glm::dvec4> medium(const Scene& scene) {
        const auto scale = static_cast<double>(volumetric_parameters(scene.inputs, std::nullopt).density_scale.y);
        std::vector<glm::dvec4> made;
        for (const glm::vec4& stored : render(scene).density) {
            made.push_back(glm::dvec4(stored) * scale);
        }
        return made;
    }

    std::string refusal(const std::function<void(std::vector<FogParticle>&)>& change) {
        FrameInputs inputs = plain_scene().inputs;
        inputs.image_size = {4, 4};
        inputs.fog_particles.assign(3, {.position_m = {0.0F, 0.0F, -5.0F}, .extinction_per_m = 1.0F});
        change(inputs.fog_particles);
        const auto begun = feature().begin_frame(inputs);
        return begun ? "accepted" : begun.error().message;
    }
};

TEST_F(FogParticles, AddUpToTheirExactMeansOverEverySlice) {
    for (const std::size_t count : {std::size_t{37}, FogParticle::most}) {
        const glm::dquat turn = glm::angleAxis(0.8, glm::normalize(glm::dvec3(0.3, 1.0, -0.2)));
        Scene scene = small_scene();
        scene.inputs.fog_particles = crowd(count);
        std::vector<FogParticle> in_view = scene.inputs.fog_particles;
        scene.inputs.camera.view_from_render = glm::dmat4(glm::mat3_cast(turn));
        for (FogParticle& particle : scene.inputs.fog_particles) {
            particle.position_m = glm::vec3(glm::inverse(turn) * glm::dvec3(particle.position_m));
        }
        const std::vector<glm::dvec4> found = medium(scene);
        double worst = 0.0;
        double largest = 0.0;
        std::vector<glm::dvec4> exact;
        for (std::uint32_t i = 0; i < slices * height * width; ++i) {
            exact.push_back(exact_medium(in_view, column_ray(i % width, i / width % height), i / width / height));
            largest = std::max(largest, exact.back().a);
        }
        for (std::size_t i = 0; i < exact.size(); ++i) {
            for (int c = 0; c < 4; ++c) {
                worst = std::max(worst, std::abs(found[i][c] - exact[i][c]) / (exact[i][c] + 1e-3 * largest));
            }
        }
        std::printf("%zu particles: extinction up to %.3f per metre, off by %.1e\n", count, largest, worst);
        EXPECT_GT(largest, 0.3);
        EXPECT_LE(worst, 1e-4);
    }
}

TEST_F(FogParticles, ThinnerThanASliceKeepTheirOpticalDepth) {
    for (const float radius_m : {0.3F, 0.02F, 0.001F}) {
        Scene scene = small_scene();
        const auto depth_m = static_cast<float>(0.3 * boundary_m(26) + 0.7 * boundary_m(27)); // of a slice of 3 m
        scene.inputs.fog_particles = {
            {.position_m = {0.0F, 0.0F, -depth_m}, .radius_m = radius_m, .extinction_per_m = 2.0F / radius_m}};
        const Result result = render(scene);
        EXPECT_TRUE(contains(result.pass_names, "fog particle clustering"));
        const std::size_t centre = (slices * height + height / 2) * width + width / 2;
        EXPECT_NEAR(result.accumulated[centre].a, 2.0 * 16.0 / 15.0, 2e-3) << radius_m;
    }
}

TEST_F(FogParticles, WithoutAnyNothingChanges) {
    Scene scene = small_scene();
    scene.inputs.medium.homogeneous.extinction_per_m = 0.02F;
    scene.inputs.medium.volumes = {{.center_m = {1000.0F, 20.0F, -310.0F}, .edge = 0.3F, .extinction_per_m = 0.5F}};
    const Result without = render(scene);
    EXPECT_TRUE(contains(without.omissions, "fog particles: there is none"));
    EXPECT_FALSE(contains(without.pass_names, "fog particle clustering"));
    scene.inputs.fog_particles.assign(5, {.position_m = {0.0F, 0.0F, -5.0F}, .extinction_per_m = 0.0F});
    const Result of_nothing = render(scene);
    EXPECT_EQ(of_nothing.omissions, without.omissions);
    EXPECT_EQ(of_nothing.pass_names, without.pass_names);
    EXPECT_EQ(of_nothing.density, without.density);
    EXPECT_EQ(of_nothing.accumulated, without.accumulated);
    scene.inputs.medium = {};
    EXPECT_EQ(render(scene).omissions, std::vector<std::string>{"all volumetric passes: the medium is empty"});
}

TEST_F(FogParticles, InTheWhiteFurnaceTheyVanish) {
    Scene scene = small_scene();
    scene.inputs.medium.ambient_radiance = {3.0F, 2.0F, 1.0F};
    scene.inputs.fog_particles = crowd(500);
    for (FogParticle& particle : scene.inputs.fog_particles) {
        particle.albedo = glm::vec3(1.0F);
    }
    scene.color = [](std::uint32_t, std::uint32_t) { return glm::vec4(3.0F, 2.0F, 1.0F, 1.0F); };
    const Result result = render(scene);
    float thickest = 0.0F;
    for (const glm::vec4& value : result.accumulated) {
        thickest = std::max(thickest, value.a);
    }
    EXPECT_GT(thickest, 1.0F);
    for (const glm::vec4& color : result.color) {
        EXPECT_NEAR(color.r, 3.0F, 3e-4F);
        EXPECT_NEAR(color.b, 1.0F, 1e-4F);
    }
}

TEST_F(FogParticles, AddToTheMediumThatIsThereBeforeItsNoise) {
    Scene scene = small_scene();
    scene.inputs.medium.homogeneous = {.extinction_per_m = 0.1F, .extinction_color = {1.0F, 0.5F, 0.25F}};
    scene.inputs.medium.volumes = {{.blend = VolumeBlend::subtract,
                                    .center_m = {1000.0F, 20.0F, -300.0F},
                                    .half_size_m = glm::vec3(900.0F),
                                    .extinction_per_m = 1.0F}};
    scene.inputs.fog_particles = {
        {.position_m = {0.0F, 0.0F, -12.0F}, .radius_m = 3.0F, .extinction_per_m = 0.4F, .albedo = {1.0F, 0.5F, 0.0F}}};
    const std::size_t in_particle = (12 * height + height / 2) * width + width / 2;
    const std::size_t in_channels = in_particle + std::size_t{slices} * height * width;
    const glm::dvec4 exact = exact_medium(scene.inputs.fog_particles, column_ray(width / 2, height / 2), 12);
    ASSERT_GT(exact.a, 0.1);
    const std::vector<glm::dvec4> emptied = medium(scene);
    for (int c = 0; c < 3; ++c) { // the volume takes the homogeneous fog only
        EXPECT_NEAR(emptied[in_particle][c], exact[c], 1e-5);
        EXPECT_NEAR(emptied[in_channels][c], exact.a, 1e-5);
    }
    scene.inputs.medium.volumes.clear();
    const std::vector<glm::dvec4> colored = medium(scene);
    EXPECT_NEAR(colored[in_channels].r, exact.a + 0.1, 1e-5);
    EXPECT_NEAR(colored[in_channels].b, exact.a + 0.025, 1e-5);
    EXPECT_NEAR(colored[in_particle].g, exact.g + 0.05, 1e-5);

    scene.inputs.medium.noise.amplitude = 0.8F;
    const double noisy = medium(scene)[in_channels].r;
    scene.inputs.fog_particles.clear();
    const double factor = medium(scene)[in_channels].r / 0.1;
    EXPECT_GT(std::abs(factor - 1.0), 0.01);
    EXPECT_NEAR(noisy, factor * (exact.a + 0.1), 1e-5);
}

TEST_F(FogParticles, AreSeenByEveryVariantAndProjection) {
    Scene scene = small_scene();
    scene.inputs.medium.noise = {.kind = NoiseKind::perlin_worley, .amplitude = 1e-6F};
    scene.inputs.medium.homogeneous.emission_per_m = glm::vec3(1.0F);
    scene.inputs.settings.storage = StorageFormat::fp16;
    scene.inputs.fog_particles = crowd(200);
    const auto worst = [&](const std::function<glm::dvec4(std::size_t)>& exact) {
        const std::vector<glm::dvec4> found = medium(scene);
        double error = 0.0;
        for (std::size_t i = 0; i < std::size_t{slices} * height * width; ++i) {
            // fp16 has 11 bits. Drivers may round or cut: up to half a unit above, up to a whole one below.
            const double above = (found[i].a - exact(i).a) / (exact(i).a + 0.1);
            error = std::max(error, above > 0.0 ? above : -0.5 * above);
        }
        return error;
    };
    const auto perspective = [&](std::size_t i) {
        const auto froxel = static_cast<std::uint32_t>(i);
        return exact_medium(scene.inputs.fog_particles, column_ray(froxel % width, froxel / width % height),
                            froxel / width / height);
    };
    EXPECT_LE(worst(perspective), 5e-4);

    scene.inputs.camera.clip_from_view = glm::dmat4(1.0); // 20 m wide, 12 m high, to 100 m
    scene.inputs.camera.clip_from_view[0][0] = 1.0 / 10.0;
    scene.inputs.camera.clip_from_view[1][1] = -1.0 / 6.0;
    scene.inputs.camera.clip_from_view[2][2] = 0.01;
    scene.inputs.camera.clip_from_view[3][2] = 1.0;
    const auto orthographic = [&](std::size_t i) {
        const auto froxel = static_cast<std::uint32_t>(i);
        const glm::vec3 eye(10.0 * (2.0 * (froxel % width) / (width - 1.0) - 1.0),
                            -6.0 * (2.0 * (froxel / width % height) / (height - 1.0) - 1.0), 0.0);
        std::vector<FogParticle> from_eye = scene.inputs.fog_particles;
        for (FogParticle& particle : from_eye) {
            particle.position_m -= eye;
        }
        return exact_medium(from_eye, {0.0, 0.0, -1.0}, froxel / width / height);
    };
    EXPECT_LE(worst(orthographic), 5e-4);
}

TEST_F(FogParticles, MoveAtOnceAndCostNoHistory) {
    Scene scene = small_scene();
    scene.inputs.settings.temporal = {.enabled = true, .jitter = false};
    scene.inputs.medium.ambient_radiance = glm::vec3(1.0F);
    scene.inputs.fog_particles = crowd(300);
    (void)render(scene);
    const FrameMemory before = memory_of(scene.inputs, volumetric_parameters(scene.inputs, std::nullopt));
    for (FogParticle& particle : scene.inputs.fog_particles) {
        particle.position_m.x += 0.7F;
    }
    EXPECT_EQ(change_everywhere(scene.inputs, before), 0.0F);
    EXPECT_FALSE(starts_cold(scene.inputs, before));
    const Result moved = render(scene);
    scene.inputs.cut = true;
    EXPECT_EQ(render(scene).density, moved.density);
}

TEST_F(FogParticles, OutsideTheirDomainAreRefused) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    constexpr float infinity = std::numeric_limits<float>::infinity();
    const auto second = [&](const std::function<void(FogParticle&)>& change) {
        return refusal([&](std::vector<FogParticle>& particles) { change(particles[1]); });
    };
    EXPECT_EQ(second([](FogParticle&) {}), "accepted");
    const std::string place = "fog_particles[1].position_m must be between -1e7 and 1e7.";
    EXPECT_EQ(second([](FogParticle& particle) { particle.position_m.z = nan; }), place);
    EXPECT_EQ(second([](FogParticle& particle) { particle.position_m.x = -2e7F; }), place);
    const std::string radius = "fog_particles[1].radius_m must be above 0 and at most 1e6.";
    EXPECT_EQ(second([](FogParticle& particle) { particle.radius_m = 0.0F; }), radius);
    EXPECT_EQ(second([](FogParticle& particle) { particle.radius_m = infinity; }), radius);
    EXPECT_EQ(second([](FogParticle& particle) { particle.radius_m = nan; }), radius);
    const std::string extinction = "fog_particles[1].extinction_per_m must be between 0 and 1e6.";
    EXPECT_EQ(second([](FogParticle& particle) { particle.extinction_per_m = -0.1F; }), extinction);
    EXPECT_EQ(second([](FogParticle& particle) { particle.extinction_per_m = nan; }), extinction);
    const std::string albedo = "fog_particles[1].albedo must be between 0 and 1.";
    EXPECT_EQ(second([](FogParticle& particle) { particle.albedo.g = 1.1F; }), albedo);
    EXPECT_EQ(second([](FogParticle& particle) { particle.albedo.b = nan; }), albedo);
    EXPECT_EQ(refusal([](std::vector<FogParticle>& particles) { particles.resize(4096); }), "accepted");
    EXPECT_EQ(refusal([](std::vector<FogParticle>& particles) { particles.resize(4097); }),
              "fog_particles must be at most 4096, not 4097.");
    EXPECT_EQ(refusal([](std::vector<FogParticle>& particles) { particles.assign(1001, {.extinction_per_m = 1e6F}); }),
              "fog_particles must add up to an extinction of at most 1e9.");
}

TEST(FogParticlesOfAView, KeepLightsInTheFroxelsAndLieWithinTheRange) {
    FrameInputs inputs;
    inputs.camera.clip_from_view = test_projection();
    inputs.medium.homogeneous.extinction_per_m = 0.01F;
    inputs.lights = {{.position_range = {0.0F, 0.0F, -6.0F, 10.0F}, .intensity_type = {1.0F, 1.0F, 1.0F, 0.0F}}};
    EXPECT_EQ(choose_airlights(inputs, std::nullopt).lights.size(), 1U);
    inputs.fog_particles = {{.position_m = {0.0F, 0.0F, -30.0F}, .radius_m = 2.0F, .extinction_per_m = 0.1F}};
    const AirlightChoice choice = choose_airlights(inputs, std::nullopt);
    EXPECT_TRUE(choice.lights.empty());
    EXPECT_EQ(choice.why_not, "only froxels know noise, a density map, local volumes and particles");

    inputs.settings.grid.law = DepthLawKind::scene;
    inputs.visible_depth_m = DepthSpan{0.0, 4.0};
    EXPECT_GE(fitted_range(inputs, std::nullopt).range_m, 32.0F);
    EXPECT_LT(fitted_range(inputs, std::nullopt).range_m, 64.0F);
    inputs.fog_particles.clear();
    EXPECT_LT(fitted_range(inputs, std::nullopt).range_m, 32.0F);
}

} // namespace
} // namespace tyndall::volumetrics::test
