// Fog that shines by itself, on the device, against closed forms in double precision.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

constexpr double depth_m = 40.0;

/// A black wall at `depth_m` in front of 33x17x32 froxels.
Scene scene_before_wall() {
    Scene scene = plain_scene();
    scene.image = {64, 36};
    scene.inputs.settings.grid = {.width = 33, .height = 17, .slices = 32, .range_m = 64.0F, .shape_m = 16.0F};
    scene.depth_m = [](std::uint32_t, std::uint32_t) { return depth_m; };
    scene.color = [](std::uint32_t, std::uint32_t) { return glm::vec4(0.0F); };
    return scene;
}

/// What a slab that gains `source` per metre sends to the eye over `length_m`.
double slab(double source, double extinction, double length_m) {
    return extinction > 0.0 ? source / extinction * -std::expm1(-extinction * length_m) : source * length_m;
}

class Emission : public FogTest {
protected:
    /// Largest relative error of the pixels' red; `expected` of the unit ray in view space and its length in metres.
    template <typename Expected>
    double worst(const Scene& scene, Expected expected) {
        const Result result = render(scene);
        double error = 0.0;
        for (std::uint32_t y = 0; y < scene.image.y; ++y) {
            for (std::uint32_t x = 0; x < scene.image.x; ++x) {
                const PixelRay ray = pixel_ray(scene, x, y);
                const double radiance = expected(ray.direction, depth_m * ray.stretch);
                const auto found = static_cast<double>(result.color[y * scene.image.x + x].r);
                error = std::max(error, std::abs(found / radiance - 1.0));
            }
        }
        return error;
    }
};

TEST_F(Emission, HomogeneousFogFromNoneToDense) {
    for (const Integrator integrator : {Integrator::exponential, Integrator::exponential_quadratic}) {
        for (const double extinction : {0.0, 1e-9, 1e-3, 0.1, 1.0, 100.0, 1e6}) {
            Scene scene = scene_before_wall();
            scene.inputs.settings.integrator = integrator;
            scene.inputs.medium.homogeneous.extinction_per_m = static_cast<float>(extinction);
            scene.inputs.medium.homogeneous.emission_per_m = {3.0F, 0.0F, 0.0F};
            scene.inputs.medium.ambient_radiance = glm::vec3(0.5F);
            const auto expected = [&](const glm::dvec3&, double length_m) {
                return slab(3.0 + 0.5 * extinction, extinction, length_m);
            };
            scene.inputs.settings.storage = StorageFormat::fp32;
            const double fp32 = worst(scene, expected);
            scene.inputs.settings.storage = StorageFormat::fp16;
            const double fp16 = worst(scene, expected);
            std::printf("emission, extinction %g: off by %.1e, in fp16 %.1e\n", extinction, fp32, fp16);
            EXPECT_LE(fp32, 2e-3) << extinction;
            EXPECT_LE(fp16, 5e-3) << extinction;
        }
    }
}

TEST_F(Emission, HeightFogFallsOffWithItsHeight) {
    for (const float extinction : {0.0F, 0.05F}) {
        Scene scene = scene_before_wall();
        scene.inputs.camera.origin_m = {0.0, 3.0, 0.0};
        scene.inputs.medium.height = {.extinction_per_m = extinction,
                                      .albedo = glm::vec3(0.0F),
                                      .emission_per_m = {2.0F, 0.0F, 0.0F},
                                      .base_height_m = -100.0F,
                                      .falloff_per_m = 0.02F};
        const double error = worst(scene, [&](const glm::dvec3& ray, double length_m) {
            // The integral of e^(-f y) along a rising or falling ray; emission stays a multiple of extinction.
            const double rise = 0.02 * ray.y * length_m;
            const double mean = std::abs(rise) < 1e-9 ? 1.0 : -std::expm1(-rise) / rise;
            const double density_m = std::exp(-0.02 * 103.0) * mean * length_m;
            return slab(2.0, static_cast<double>(extinction), density_m);
        });
        std::printf("emission of height fog, extinction %g: off by %.1e\n", static_cast<double>(extinction), error);
        EXPECT_LE(error, 2e-3);
    }
}

TEST_F(Emission, VolumesBlendItAsDefined) {
    struct Case {
        VolumeBlend blend;
        float extinction;
        float factor;
        double emission;       ///< of the blend
        double all_extinction; ///< of the blend
    };
    // In fog of extinction 0.1 and emission 2 everywhere, a volume of emission 5.
    const Case cases[] = {
        {VolumeBlend::add, 0.3F, 1.0F, 7.0, 0.4},        {VolumeBlend::add, 0.0F, 1.0F, 7.0, 0.1},
        {VolumeBlend::subtract, 0.04F, 1.0F, 1.2, 0.06}, {VolumeBlend::multiply, 0.0F, 3.0F, 6.0, 0.3},
        {VolumeBlend::max, 0.4F, 1.0F, 5.0, 0.4},        {VolumeBlend::max, 0.05F, 1.0F, 2.0, 0.1},
    };
    for (const Case& c : cases) {
        Scene scene = scene_before_wall();
        scene.inputs.medium.homogeneous = {
            .extinction_per_m = 0.1F, .albedo = glm::vec3(0.0F), .emission_per_m = {2.0F, 0.0F, 0.0F}};
        scene.inputs.medium.volumes = {LocalVolume{.blend = c.blend,
                                                   .half_size_m = glm::vec3(500.0F),
                                                   .extinction_per_m = c.extinction,
                                                   .factor = c.factor,
                                                   .albedo = glm::vec3(0.0F),
                                                   .emission_per_m = {5.0F, 0.0F, 0.0F}}};
        EXPECT_LE(worst(scene, [&](const glm::dvec3&,
                                   double length_m) { return slab(c.emission, c.all_extinction, length_m); }),
                  2e-3)
            << static_cast<int>(c.blend) << " " << c.extinction;
    }
}

TEST_F(Emission, ShiningBoxInClearAirGivesItsWayThroughIt) {
    Scene scene = scene_before_wall();
    scene.inputs.medium.volumes = {LocalVolume{
        .center_m = {0.0F, 0.0F, -20.0F}, .half_size_m = {500.0F, 500.0F, 3.3F}, .emission_per_m = {4.0F, 0.0F, 0.0F}}};
    const double error =
        worst(scene, [&](const glm::dvec3&, double length_m) { return 4.0 * 6.6 * length_m / depth_m; });
    std::printf("shining box: off by %.1e\n", error);
    EXPECT_LE(error, 2e-3);
}

TEST_F(Emission, NoiseChangesItWithTheExtinction) {
    Scene scene = scene_before_wall();
    scene.color = [](std::uint32_t, std::uint32_t) { return glm::vec4(0.0F, 0.0F, 1.0F, 1.0F); };
    scene.inputs.medium.homogeneous = {
        .extinction_per_m = 0.05F, .albedo = glm::vec3(0.0F), .emission_per_m = {0.15F, 0.0F, 0.0F}};
    scene.inputs.medium.noise = {.amplitude = 0.9F, .scale_m = 20.0F};
    double lowest = 1.0;
    double highest = 0.0;
    for (const glm::vec4& pixel : render(scene).color) {
        const double transmittance = static_cast<double>(pixel.b);
        // Between columns the two are not interpolated alike.
        EXPECT_NEAR(static_cast<double>(pixel.r), 3.0 * (1.0 - transmittance), 0.01);
        lowest = std::min(lowest, transmittance);
        highest = std::max(highest, transmittance);
    }
    EXPECT_GT(highest, 1.2 * lowest); // the noise shows
}

TEST_F(Emission, IsBoundedByItsSourceAndByItsSum) {
    for (const float emission : {1e-6F, 1.0F, 1e9F}) {
        for (const float extinction : {0.0F, 1e-8F, 1e-2F, 1.0F, 1e6F}) {
            Scene scene = scene_before_wall();
            scene.inputs.settings.storage = StorageFormat::fp16;
            scene.inputs.medium.homogeneous = {
                .extinction_per_m = extinction, .albedo = glm::vec3(1.0F), .emission_per_m = glm::vec3(emission)};
            scene.inputs.cut = true; // the scale of a frame that follows none
            const Result result = render(scene);
            const auto scale = static_cast<double>(radiance_scale_for(scene.inputs));
            const double longest_m = 64.0 * std::sqrt(1.0 + tan_x * tan_x + tan_y * tan_y);
            const auto source = static_cast<double>(emission);
            const double bound = extinction > 0.0F
                                     ? std::min(source * longest_m, source / static_cast<double>(extinction))
                                     : source * longest_m;
            double brightest = 0.0;
            for (const glm::vec4& value : result.accumulated) {
                ASSERT_TRUE(std::isfinite(value.r) && value.r >= 0.0F);
                brightest = std::max(brightest, static_cast<double>(value.r) / scale);
            }
            EXPECT_LE(brightest, bound * (1.0 + 2.0 / 1024.0)) << emission << " " << extinction;
            EXPECT_GE(brightest, 0.5 * bound) << emission << " " << extinction;
        }
    }
}

TEST_F(Emission, IsLeftOutWhereNothingShines) {
    Scene scene = scene_before_wall();
    scene.inputs.medium.homogeneous.extinction_per_m = 0.1F;
    const std::string reason = "fog emission: no medium emits";
    const auto left_out = [&] {
        const std::vector<std::string> omissions = render(scene).omissions;
        return std::find(omissions.begin(), omissions.end(), reason) != omissions.end();
    };
    EXPECT_TRUE(left_out());
    scene.inputs.medium.volumes = {LocalVolume{.half_size_m = {1.0F, 0.0F, 1.0F}, .emission_per_m = glm::vec3(1.0F)}};
    EXPECT_TRUE(left_out());
    scene.inputs.medium.volumes[0].half_size_m.y = 1.0F;
    EXPECT_FALSE(left_out());
}

} // namespace
} // namespace tyndall::volumetrics::test
