// Noise of baked volumes: the texels on the device against their definition in double precision, that they tile and are
// uniform, what becomes of them in the fog, and that they are baked once.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>

#include "features/volumetrics/reference/medium.hpp"
#include "features/volumetrics/reference/noise_volumes.hpp"
#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

constexpr std::array<std::uint32_t, 2> sizes{128, 32};

class NoiseVolumes : public FogTest {};

Scene cloudy(const DensityNoise& noise) {
    Scene scene = plain_scene();
    scene.inputs.medium.homogeneous.extinction_per_m = 0.3F;
    scene.inputs.medium.noise = noise;
    scene.inputs.time_s = 11.0;
    scene.inputs.camera.origin_m = {123.0, -456.0, 789.0};
    return scene;
}

DensityNoise clouds() {
    return {.kind = NoiseKind::perlin_worley,
            .amplitude = 0.9F,
            .scale_m = 40.0F,
            .wind_m_s = {0.7F, -1.0F, 0.4F},
            .coverage = 0.6F,
            .detail = 0.5F,
            .detail_scale_m = 15.0F,
            .detail_wind_m_s = {-0.2F, 0.3F, 0.9F}};
}

/// Mean difference of neighbouring planes across `axis`, the last one that of the last plane and the first.
std::vector<double> plane_steps(const std::vector<float>& texels, std::uint32_t size, int axis) {
    std::vector<double> steps(size, 0.0);
    for (std::uint32_t i = 0; i < texels.size(); ++i) {
        std::array<std::uint32_t, 3> at{i % size, i / size % size, i / size / size};
        const std::uint32_t plane = at[static_cast<std::size_t>(axis)];
        at[static_cast<std::size_t>(axis)] = (plane + 1) % size;
        const float next = texels[(at[2] * size + at[1]) * size + at[0]];
        steps[plane] += static_cast<double>(std::abs(next - texels[i])) / (size * size);
    }
    return steps;
}

TEST_F(NoiseVolumes, HaveTheTexelsThatAreDefinedTileAndAreUniform) {
    const Result result = render(cloudy(clouds()));
    const std::array volumes{&reference::NoiseVolume::shape(), &reference::NoiseVolume::detail()};
    for (std::size_t v = 0; v < volumes.size(); ++v) {
        const std::uint32_t size = sizes[v];
        ASSERT_EQ(result.baked_noise[v].size(), std::size_t{size} * size * size);
        double worst = 0.0;
        for (std::uint32_t i = 0; i < result.baked_noise[v].size(); i += v == 0 ? 97 : 3) {
            const double expected = volumes[v]->texel(i % size, i / size % size, i / size / size);
            worst = std::max(worst, std::abs(static_cast<double>(result.baked_noise[v][i]) - expected));
        }
        std::printf("volume %zu: texels at most %.1e off\n", v, worst);
        EXPECT_LE(worst, 1e-3);
    }
    for (std::size_t v = 0; v < sizes.size(); ++v) {
        const std::vector<float>& texels = result.baked_noise[v];
        for (int axis = 0; axis < 3; ++axis) {
            const std::vector<double> steps = plane_steps(texels, sizes[v], axis);
            const auto [least, most] = std::minmax_element(steps.begin(), steps.end() - 1);
            std::printf("volume %zu, axis %d: step of planes %.4f to %.4f, at the seam %.4f\n", v, axis, *least, *most,
                        steps.back());
            EXPECT_GE(steps.back(), 0.95 * *least);
            EXPECT_LE(steps.back(), 1.05 * *most);
        }
        std::array<double, 8> parts{};
        double mean = 0.0;
        for (const float value : texels) {
            ASSERT_TRUE(value >= 0.0F && value <= 1.0F);
            mean += static_cast<double>(value) / static_cast<double>(texels.size());
            parts[std::min<std::size_t>(7, static_cast<std::size_t>(value * 8.0F))] +=
                8.0 / static_cast<double>(texels.size());
        }
        EXPECT_NEAR(mean, 0.5, 2e-3);
        for (const double part : parts) {
            EXPECT_NEAR(part, 1.0, 2e-2);
        }
    }
}

TEST(NoiseVolumeTwin, RepeatsExactly) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> coordinate(0.0, 1.0);
    for (int i = 0; i < 200; ++i) {
        const glm::dvec3 p(coordinate(random), coordinate(random), coordinate(random));
        const glm::dvec3 q = p + glm::dvec3(i % 3, -(i % 4), i % 5);
        EXPECT_NEAR(reference::raw_noise_shape(p), reference::raw_noise_shape(q), 1e-12);
        EXPECT_NEAR(reference::raw_noise_detail(p), reference::raw_noise_detail(q), 1e-12);
        EXPECT_NEAR(reference::NoiseVolume::detail().at(p), reference::NoiseVolume::detail().at(q), 1e-10);
    }
    for (const std::int64_t shift : {-128, 128, 512}) {
        EXPECT_EQ(reference::NoiseVolume::shape().texel(3, 127, 0),
                  reference::NoiseVolume::shape().texel(3 + shift, 127 - shift, shift));
    }
}

/// Of the factor over all space, which `coverage` and `detail` leave at 1.
TEST(NoiseVolumeTwin, HasTheMeanAndTheCoverageThatItsKeysSay) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> place(-1e4, 1e4);
    for (const float coverage : {0.2F, 0.7F, 1.0F}) {
        for (const float detail : {0.0F, 0.8F}) {
            DensityNoise noise = clouds();
            noise.amplitude = 1.0F;
            noise.coverage = coverage;
            noise.detail = detail;
            Medium medium;
            medium.homogeneous.extinction_per_m = 1.0F;
            medium.noise = noise;
            const reference::Fog fog(medium, 3.0);
            constexpr int count = 20000;
            double sum = 0.0;
            double covered = 0.0;
            double largest = 0.0;
            for (int i = 0; i < count; ++i) {
                const double factor = fog.at({place(random), place(random), place(random)}).extinction.x;
                ASSERT_GE(factor, 0.0);
                sum += factor / count;
                covered += factor > 0.0 ? 1.0 / count : 0.0;
                largest = std::max(largest, factor);
            }
            std::printf("coverage %.1f, detail %.1f: mean %.3f, covered %.3f, largest %.2f of at most %.2f\n",
                        static_cast<double>(coverage), static_cast<double>(detail), sum, covered, largest,
                        noise_bound(noise));
            const bool feels_texels = coverage < 0.5F; // between them the volumes are smoother
            EXPECT_NEAR(sum, feels_texels ? 0.935 : 1.0, feels_texels ? 0.025 : 0.01);
            EXPECT_LE(largest, noise_bound(noise));
            if (detail == 0.0F) {
                EXPECT_NEAR(covered, coverage, 0.02);
            }
        }
    }
}

/// Where froxels are fine enough to show it.
TEST_F(NoiseVolumes, MakeTheDensityThatIsDefined) {
    Scene scene = cloudy(clouds());
    const Result result = render(scene);
    const reference::Fog fog(scene.inputs.medium, scene.inputs.time_s);
    const double density_scale = static_cast<double>(volumetric_parameters(scene.inputs, std::nullopt).density_scale.y);
    const GridSettings& grid = scene.inputs.settings.grid;
    const double ratio = 1.0 + static_cast<double>(grid.range_m) / static_cast<double>(grid.shape_m);
    const auto boundary_m = [&](std::uint32_t i) {
        return static_cast<double>(grid.shape_m) * (std::pow(ratio, static_cast<double>(i) / grid.slices) - 1.0);
    };
    double worst = 0.0;
    double clear = 0.0;
    double total = 0.0;
    for (std::uint32_t k = 0; k < grid.slices; ++k) {
        const double depth_m = 0.5 * (boundary_m(k) + boundary_m(k + 1));
        for (std::uint32_t y = 0; y < grid.height; y += 7) {
            for (std::uint32_t x = 0; x < grid.width; x += 5) {
                const glm::dvec3 ray((2.0 * x / (grid.width - 1.0) - 1.0) * tan_x,
                                     (1.0 - 2.0 * y / (grid.height - 1.0)) * tan_y, -1.0);
                const double expected = fog.at(scene.inputs.camera.origin_m + ray * depth_m).extinction.r;
                const double found =
                    density_scale * static_cast<double>(result.density[(k * grid.height + y) * grid.width + x].a);
                worst = std::max(worst, std::abs(found - expected));
                clear += expected < 0.031 ? 1.0 : 0.0;
                total += 1.0;
            }
        }
    }
    std::printf("density at most %.1e off, of a mean of 0.3 per metre; %.0f %% of it clear\n", worst,
                100.0 * clear / total);
    EXPECT_LE(worst, 3e-3);
    EXPECT_GT(clear / total, 0.2);
    EXPECT_LT(clear / total, 0.8);
}

TEST_F(NoiseVolumes, AreBakedOnceForAllViews) {
    const auto has = [](const std::vector<std::string>& names, const std::string& name) {
        return std::find(names.begin(), names.end(), name) != names.end();
    };
    Scene scene = cloudy(clouds());
    scene.image = {8, 8};
    scene.inputs.settings.grid = {.width = 16, .height = 9, .slices = 16};
    const std::vector<Scene> both{scene, scene};
    const std::vector<Result> first = render_views(both);
    EXPECT_TRUE(has(first[0].pass_names, "noise shape bake"));
    EXPECT_TRUE(has(first[0].pass_names, "noise detail bake"));
    EXPECT_EQ(std::count(first[0].pass_names.begin(), first[0].pass_names.end(), "noise shape bake"), 1);
    const std::vector<Result> second = render_views(both);
    for (const char* name : {"noise shape bake", "noise shape copy", "noise detail bake", "noise detail copy"}) {
        EXPECT_FALSE(has(second[0].pass_names, name)) << name;
    }
    EXPECT_TRUE(has(second[1].omissions, "noise bake: an earlier frame has baked its volumes"));
    for (const Result* result : {&first[1], &second[0], &second[1]}) {
        EXPECT_EQ(result->density, first[0].density);
    }
    EXPECT_EQ(feature().own_images().size(), 2U);

    scene.inputs.medium.noise.kind = NoiseKind::perlin; // needs no volume, and bakes none
    EXPECT_FALSE(has(render(scene).omissions, "noise bake: an earlier frame has baked its volumes"));
}

} // namespace
} // namespace tyndall::volumetrics::test
