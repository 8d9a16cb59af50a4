// Clusters list every light that reaches them, local lights look as in a double-precision integral, and clusters change
// no bit.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <random>

#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

constexpr double pi = 3.14159265358979323846;

gpu::GpuLight point_light(const glm::vec3& position, float range_m, float candela, float radius_m = 0.0F) {
    return {.position_range = glm::vec4(position, range_m),
            .intensity_type = glm::vec4(glm::vec3(candela), 0.0F),
            .direction_radius = glm::vec4(0.0F, -1.0F, 0.0F, radius_m),
            .cone = {0.0F, 1.0F, 0.0F, 0.0F}};
}

gpu::GpuLight spot_light(const glm::vec3& position, float range_m, float candela, const glm::vec3& direction,
                         double inner, double outer) {
    gpu::GpuLight light = point_light(position, range_m, candela);
    const double scale = 1.0 / std::max(0.001, std::cos(inner) - std::cos(outer));
    light.intensity_type.w = 1.0F;
    light.direction_radius = glm::vec4(glm::normalize(direction), 0.0F);
    light.cone = glm::vec4(scale, -std::cos(outer) * scale, 0.0, 0.0);
    return light;
}

/// Points and spots of many sizes in and around the view, also behind the camera and beyond the range.
/// Braces: compilers evaluate arguments in parentheses in orders of their own.
std::vector<gpu::GpuLight> random_lights(std::size_t count, unsigned seed, float longest_m = 12.0F) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    std::vector<gpu::GpuLight> lights;
    for (std::size_t i = 0; i < count; ++i) {
        const float depth_m = -5.0F + 90.0F * unit(random);
        const glm::vec3 position{(2.4F * unit(random) - 1.2F) * depth_m, (1.4F * unit(random) - 0.7F) * depth_m,
                                 -depth_m};
        const float range_m = 0.2F * std::pow(5.0F * longest_m, unit(random));
        const float candela = 10.0F + 100.0F * unit(random);
        const glm::vec3 direction{unit(random) - 0.5F, unit(random) - 0.5F, unit(random) - 0.5F};
        const double outer = 0.05 + 1.5 * static_cast<double>(unit(random));
        lights.push_back(i % 2 == 0 ? point_light(position, range_m, candela)
                                    : spot_light(position, range_m, candela, direction, 0.7 * outer, outer));
    }
    return lights;
}

/// Does the light reach the point, in double precision, with KHR_lights_punctual's window and cone?
bool reaches(const gpu::GpuLight& light, const glm::dvec3& p) {
    const glm::dvec3 d = p - glm::dvec3(light.position_range);
    const double distance = glm::length(d);
    if (distance >= static_cast<double>(light.position_range.w)) {
        return false;
    }
    if (light.intensity_type.w < 0.5F || distance == 0.0) {
        return true;
    }
    const double cosine = glm::dot(d / distance, glm::dvec3(light.direction_radius));
    return cosine * static_cast<double>(light.cone.x) + static_cast<double>(light.cone.y) > 0.0;
}

class Clusters : public FogTest {
protected:
    /// The cluster of a view-space point, or -1 outside the view.
    [[nodiscard]] static int cluster_of(const GridSettings& grid, const glm::dvec3& p) {
        const double depth_m = -p.z;
        const glm::dvec2 uv(0.5 + 0.5 * p.x / (depth_m * tan_x), 0.5 - 0.5 * p.y / (depth_m * tan_y));
        if (depth_m <= 0.0 || uv.x < 0.0 || uv.x > 1.0 || uv.y < 0.0 || uv.y > 1.0) {
            return -1;
        }
        const double s = static_cast<double>(grid.shape_m);
        const double t = std::log1p(depth_m / s) / std::log1p(static_cast<double>(grid.range_m) / s);
        const glm::uvec3 froxel(uv.x * (grid.width - 1) + 0.5, uv.y * (grid.height - 1) + 0.5,
                                std::min(t, 1.0) * grid.slices);
        const glm::uvec3 counts = counts_of(grid);
        const glm::uvec3 c = glm::min(froxel / block, counts - 1U);
        return static_cast<int>((c.z * counts.y + c.y) * counts.x + c.x);
    }

    /// Points within each light's range, at random: their clusters list the light, and few more than those are listed.
    void expect_complete(const Scene& scene, int samples, std::size_t least_tested, double most_listed) {
        const Result result = render(scene);
        const glm::uvec3 counts = counts_of(scene.inputs.settings.grid);
        const std::size_t words = (scene.lights.size() + 31) / 32;
        ASSERT_EQ(result.masks.size(), std::size_t{counts.x} * counts.y * counts.z * words);

        std::mt19937 random(11);
        std::uniform_real_distribution<double> signed_unit(-1.0, 1.0);
        std::size_t tested = 0;
        std::vector<std::uint32_t> exact(result.masks.size(), 0);
        for (std::size_t i = 0; i < scene.lights.size(); ++i) {
            const glm::dvec3 centre(scene.lights[i].position_range);
            const double range_m = static_cast<double>(scene.lights[i].position_range.w);
            for (int sample = 0; sample < samples; ++sample) {
                const glm::dvec3 p =
                    centre + range_m * glm::dvec3{signed_unit(random), signed_unit(random), signed_unit(random)};
                const int cluster = cluster_of(scene.inputs.settings.grid, p);
                if (cluster < 0 || !reaches(scene.lights[i], p)) {
                    continue;
                }
                ++tested;
                const std::size_t word = static_cast<std::size_t>(cluster) * words + i / 32;
                exact[word] |= 1U << (i % 32);
                ASSERT_NE(result.masks[word] >> (i % 32) & 1U, 0U)
                    << "light " << i << " at " << p.x << " " << p.y << " " << p.z;
            }
        }
        EXPECT_GT(tested, least_tested);
        std::size_t listed = 0;
        std::size_t reached = 0;
        for (std::size_t i = 0; i < exact.size(); ++i) {
            listed += static_cast<std::size_t>(std::popcount(result.masks[i]));
            reached += static_cast<std::size_t>(std::popcount(exact[i]));
        }
        std::printf("clusters list %zu lights, %zu samples reach %zu\n", listed, tested, reached);
        EXPECT_LT(static_cast<double>(listed), most_listed * static_cast<double>(reached));
    }

private:
    static constexpr glm::uvec3 block{8, 8, 2};
    [[nodiscard]] static glm::uvec3 counts_of(const GridSettings& grid) {
        return (glm::uvec3(grid.width, grid.height, grid.slices) + block - 1U) / block;
    }
};

TEST_F(Clusters, MissNoLightAndStayTight) {
    Scene scene = plain_scene();
    scene.inputs.medium.homogeneous.extinction_per_m = 0.01F;
    scene.lights = random_lights(100, 3);
    expect_complete(scene, 20000, 100000, 3.0);
}

TEST_F(Clusters, MissNoneOfFourThousandLights) {
    Scene scene = plain_scene();
    scene.image = {32, 18};
    scene.inputs.settings.grid.width = 32;
    scene.inputs.settings.grid.height = 18;
    scene.inputs.settings.grid.slices = 32;
    scene.inputs.medium.homogeneous.extinction_per_m = 0.01F;
    scene.lights = random_lights(4096, 4, 1.5F);
    expect_complete(scene, 500, 100000, 3.0);
}

TEST_F(Clusters, ChangeNoBitOfTheLighting) {
    Scene scene = plain_scene();
    scene.inputs.medium.homogeneous.extinction_per_m = 0.01F;
    scene.inputs.medium.phase_g = 0.3F;
    scene.inputs.settings.temporal.jitter = true;
    for (const std::size_t count : {std::size_t{70}, std::size_t{300}}) { // in a uniform, and in a storage buffer
        scene.lights = random_lights(count, 5);
        scene.inputs.settings.clusters = true;
        const Result with = render(scene);
        scene.inputs.settings.clusters = false;
        scene.inputs.cut = true;
        const Result without = render(scene);
        EXPECT_TRUE(without.masks.empty());
        EXPECT_EQ(with.in_scattered, without.in_scattered) << count;
        EXPECT_EQ(with.color, without.color) << count;
        float brightest = 0.0F;
        for (const glm::vec4& v : with.in_scattered) {
            brightest = std::max(brightest, v.r);
        }
        EXPECT_GT(brightest, 1.0F);
        // The last one is there: of the lamps above none is in the view's middle.
        scene.lights.back() = point_light({0.0F, 0.0F, -8.0F}, 3.0F, 1e4F);
        scene.inputs.settings.clusters = true;
        const Result last = render(scene);
        EXPECT_NE(last.in_scattered, with.in_scattered) << count;
    }
}

class LocalLight : public FogTest {
protected:
    /// Radiance along a pixel's ray to `depth_m`, single scattering without extinction of the light's own path, by
    /// Simpson's rule in double precision.
    [[nodiscard]] static double reference(const Scene& scene, const glm::dvec3& direction, double length_m, double g) {
        const double extinction = static_cast<double>(scene.inputs.medium.homogeneous.extinction_per_m);
        const auto integrand = [&](double t) {
            const glm::dvec3 p = direction * t;
            double sum = 0.0;
            for (const gpu::GpuLight& light : scene.lights) {
                const glm::dvec3 d = p - glm::dvec3(light.position_range);
                const double distance = glm::length(d);
                const double ratio = distance / static_cast<double>(light.position_range.w);
                const double window = std::max(0.0, 1.0 - ratio * ratio * ratio * ratio);
                const glm::dvec3 travel = d / distance;
                double cone = 1.0;
                if (light.intensity_type.w > 0.5F) {
                    const double cosine = glm::dot(travel, glm::dvec3(light.direction_radius));
                    cone = std::clamp(cosine * static_cast<double>(light.cone.x) + static_cast<double>(light.cone.y),
                                      0.0, 1.0);
                    cone *= cone;
                }
                const double weakened = std::exp(-extinction * distance);
                const double cos_theta = glm::dot(travel, -direction);
                const double phase = (1.0 - g * g) / (4.0 * pi * std::pow(1.0 + g * g - 2.0 * g * cos_theta, 1.5));
                sum += static_cast<double>(light.intensity_type.r) * window * cone * phase * weakened /
                       (distance * distance);
            }
            return extinction * std::exp(-extinction * t) * sum;
        };
        const int intervals = 20000;
        double sum = integrand(1e-9) + integrand(length_m);
        for (int i = 1; i < intervals; ++i) {
            sum += (i % 2 == 0 ? 2.0 : 4.0) * integrand(length_m * i / intervals);
        }
        return sum * length_m / intervals / 3.0;
    }
};

TEST_F(LocalLight, RadianceAlongRaysMatchesAnIntegral) {
    Scene scene = plain_scene();
    scene.inputs.medium.homogeneous = {.extinction_per_m = 0.03F, .albedo = glm::vec3(1.0F)};
    scene.inputs.medium.phase_g = 0.2F;
    scene.lights = {point_light({1.0F, 0.5F, -12.0F}, 20.0F, 100.0F),
                    spot_light({-6.0F, 5.0F, -15.0F}, 18.0F, 400.0F, {0.3F, -1.0F, 0.0F}, 0.3, 0.6)};
    const Result result = render(scene);
    double worst = 0.0;
    for (std::uint32_t y = 6; y < scene.image.y; y += 12) {
        for (std::uint32_t x = 5; x < scene.image.x; x += 12) {
            const PixelRay ray = pixel_ray(scene, x, y);
            const auto passes_near = [&](const gpu::GpuLight& light) {
                return glm::length(glm::cross(ray.direction, glm::dvec3(light.position_range))) < 1.0;
            };
            if (passes_near(scene.lights[0]) || passes_near(scene.lights[1])) {
                continue; // next to a light no grid of 15 cm columns holds 1 / h and the tip of a cone
            }
            const double expected = reference(scene, ray.direction, 64.0 * ray.stretch, 0.2);
            const double found = static_cast<double>(result.color[y * scene.image.x + x].r);
            worst = std::max(worst, std::abs(found - expected) / (expected + 0.01));
        }
    }
    std::printf("point and spot light, largest relative error over 405 rays: %.3f\n", worst);
    EXPECT_LE(worst, 0.08);
}

TEST_F(LocalLight, ManyTogetherAreAsBrightInHalfPrecision) {
    Scene scene = plain_scene();
    scene.image = {80, 45};
    scene.inputs.medium.homogeneous = {.extinction_per_m = 0.05F, .albedo = glm::vec3(1.0F)};
    const auto mean = [&](StorageFormat storage) {
        scene.inputs.settings.storage = storage;
        double sum = 0.0;
        for (const glm::vec4& pixel : render(scene).color) {
            sum += static_cast<double>(pixel.r);
        }
        return sum;
    };
    for (const double across_m : {0.6, 0.0}) {
        scene.lights.clear();
        for (int i = 0; i < 64; ++i) {
            const double angle = 2.0 * pi * i / 64.0;
            const glm::dvec3 place(0.5 * across_m * std::cos(angle), 0.5 * across_m * std::sin(angle), -6.0);
            scene.lights.push_back(point_light(glm::vec3(place), 30.0F, 8.0F, 0.02F));
        }
        const double ratio = mean(StorageFormat::fp16) / mean(StorageFormat::fp32);
        std::printf("64 lights, %.1f m across: %.4f in fp16 of what they are in fp32\n", across_m, ratio);
        EXPECT_NEAR(ratio, 1.0, 3e-3);
    }
}

TEST_F(LocalLight, InFogIsSteadyAsItCrossesSlices) {
    // The light moves along the middle ray by a fifth of a slice a step: point-sampled 1 / d^2 would jump 40-fold.
    std::vector<double> brightness;
    for (int step = 0; step < 12; ++step) {
        Scene scene = plain_scene();
        scene.image = {64, 36};
        scene.inputs.medium.homogeneous = {.extinction_per_m = 0.03F, .albedo = glm::vec3(1.0F)};
        scene.lights = {point_light({0.05F, 0.0F, -12.0F - 0.14F * static_cast<float>(step)}, 20.0F, 100.0F, 0.02F)};
        const Result result = render(scene);
        float brightest = 0.0F; // next to the light, where a point sample is worst
        for (const glm::vec4& pixel : result.color) {
            brightest = std::max(brightest, pixel.r);
        }
        brightness.push_back(static_cast<double>(brightest));
    }
    for (std::size_t i = 1; i < brightness.size(); ++i) {
        EXPECT_NEAR(brightness[i] / brightness[i - 1], 1.0, 0.15) << i;
    }
}

TEST_F(LocalLight, FiveCentimetresFromARayIsSteadyAndExactWithinItsSlice) {
    // Slices of 1 m; along a froxel's middle ray the light moves through two of them in steps of 8 cm, so that it also
    // lies at their middles and on their boundary. A sample at the middle of a slice gives a ratio of 40 and more.
    Scene scene = plain_scene();
    scene.inputs.settings.grid = {.width = 16, .height = 9, .slices = 64, .range_m = 64.0F, .shape_m = 6400.0F};
    scene.inputs.medium.homogeneous = {.extinction_per_m = 1e-3F, .albedo = glm::vec3(1.0F)};
    const glm::dvec3 at_one_metre((2.0 * 9 / 15.0 - 1.0) * tan_x, 0.0, -1.0);
    const glm::dvec3 ray = glm::normalize(at_one_metre);
    for (const double g : {0.0, 0.7, -0.5, 0.95}) {
        scene.inputs.medium.phase_g = static_cast<float>(g);
        double dimmest = 1e30;
        double brightest = 0.0;
        double worst = 0.0;
        for (int step = 0; step <= 25; ++step) {
            const glm::dvec3 beside = at_one_metre * (10.0 + 0.08 * step) + glm::dvec3(0.0, 0.05, 0.0);
            scene.lights = {point_light(glm::vec3(beside), 1000.0F, 100.0F)};
            const Result result = render(scene);
            const double found = static_cast<double>(result.accumulated[std::size_t{64} * 16 * 9 + 4 * 16 + 9].r);
            const double expected = reference(scene, ray, 64.0 * glm::length(at_one_metre), g);
            dimmest = std::min(dimmest, found / expected);
            brightest = std::max(brightest, found / expected);
            worst = std::max(worst, std::abs(found / expected - 1.0));
        }
        std::printf("light 5 cm from the ray, g = %.1f: largest ratio between positions %.4f, largest error %.4f\n", g,
                    brightest / dimmest, worst);
        EXPECT_LE(brightest / dimmest, 1.05) << g;
        EXPECT_LE(worst, 0.05) << g;
    }
}

} // namespace
} // namespace tyndall::volumetrics::test
