// Media that take more of one channel than of another: each channel against its closed form, and the grey medium's
// frame.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "features/volumetrics/reference/medium.hpp"
#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

class ColoredExtinction : public FogTest {
protected:
    /// Of each channel, relative, to the same channel of a grey medium of that channel's extinction.
    double largest_difference_to_grey(const Scene& scene) {
        const Result colored = render(scene);
        double worst = 0.0;
        for (int c = 0; c < 3; ++c) {
            Scene grey = scene;
            const auto take = [&](auto& fog) {
                fog.extinction_per_m *= fog.extinction_color[c];
                fog.extinction_color = glm::vec3(1.0F);
            };
            take(grey.inputs.medium.homogeneous);
            take(grey.inputs.medium.height);
            for (LocalVolume& volume : grey.inputs.medium.volumes) {
                take(volume);
            }
            const Result alone = render(grey);
            for (std::size_t i = 0; i < alone.color.size(); ++i) {
                const auto expected = static_cast<double>(alone.color[i][c]);
                worst = std::max(worst, std::abs(static_cast<double>(colored.color[i][c]) / expected - 1.0));
            }
        }
        std::printf("a channel and the grey fog of its extinction differ by at most %.1e\n", worst);
        return worst;
    }
};

/// Walls at 0.5 to 90 m, beyond the range of 64 m; every other one is the sky.
double wall_m(std::uint32_t x, std::uint32_t y) {
    return 0.5 + 90.0 * static_cast<double>((7 * x + 13 * y) % 320) / 320.0;
}

Scene colored_scene() {
    Scene scene = plain_scene();
    scene.image = {64, 36};
    scene.inputs.settings.grid = {.width = 20, .height = 12, .slices = 32, .range_m = 64.0F, .shape_m = 16.0F};
    scene.inputs.medium.homogeneous.extinction_per_m = 0.05F;
    scene.inputs.medium.homogeneous.extinction_color = {1.0F, 0.3F, 0.0F};
    scene.depth_m = wall_m;
    scene.color = [](std::uint32_t, std::uint32_t) { return glm::vec4(1.0F); };
    return scene;
}

TEST_F(ColoredExtinction, EachChannelPassesAsItsOwnOpticalDepthSays) {
    Scene scene = colored_scene();
    scene.inputs.medium.homogeneous.albedo = glm::vec3(0.0F);
    scene.inputs.settings.grid.width = 80; // optical depth grows with the ray's slope, between columns as a line
    scene.inputs.settings.grid.height = 45;
    const reference::Fog fog(scene.inputs.medium, 0.0);
    for (const StorageFormat storage : {StorageFormat::fp32, StorageFormat::fp16}) {
        scene.inputs.settings.storage = storage;
        const Result result = render(scene);
        double worst = 0.0;
        for (std::uint32_t y = 0; y < scene.image.y; ++y) {
            for (std::uint32_t x = 0; x < scene.image.x; ++x) {
                const PixelRay ray = pixel_ray(scene, x, y);
                const glm::dvec3 tau =
                    fog.closed_optical_depth({glm::dvec3(0.0), ray.direction}, wall_m(x, y) * ray.stretch);
                for (int c = 0; c < 3; ++c) {
                    const double found = result.color[y * scene.image.x + x][c];
                    worst = std::max(worst, std::abs(found - std::exp(-tau[c])));
                }
            }
        }
        std::printf("transmittance of each channel at most %.1e off\n", worst);
        EXPECT_LE(worst, storage == StorageFormat::fp32 ? 2e-4 : 1e-3);
    }
}

// Albedo 1 and the same light from everywhere, behind the fog too: nothing is to be seen of it in any channel.
TEST_F(ColoredExtinction, WhiteFurnaceIsWhiteInEachChannel) {
    Scene scene = colored_scene();
    scene.inputs.settings.grid.width = 80;
    scene.inputs.settings.grid.height = 45;
    scene.inputs.medium.ambient_radiance = glm::vec3(1.0F);
    for (const Integrator integrator : {Integrator::exponential, Integrator::exponential_quadratic}) {
        scene.inputs.settings.integrator = integrator;
        double worst = 0.0;
        for (const glm::vec4& pixel : render(scene).color) {
            for (int c = 0; c < 3; ++c) {
                worst = std::max(worst, std::abs(static_cast<double>(pixel[c]) - 1.0));
            }
        }
        std::printf("furnace at most %.1e off\n", worst);
        EXPECT_LE(worst, 1e-4);
    }
}

// By every scheme.
TEST_F(ColoredExtinction, EachChannelIsTheGreyFogOfItsExtinction) {
    Scene scene = colored_scene();
    scene.inputs.medium.height = {.extinction_per_m = 0.2F,
                                  .extinction_color = {0.5F, 1.0F, 0.25F},
                                  .albedo = {0.9F, 0.8F, 0.7F},
                                  .base_height_m = -2.0F,
                                  .falloff_per_m = 0.2F};
    scene.inputs.medium.noise = {.amplitude = 0.7F, .scale_m = 5.0F};
    const auto cloud = [](VolumeBlend blend, const glm::vec3& center, float extinction) {
        return LocalVolume{.shape = VolumeShape::ellipsoid,
                           .blend = blend,
                           .center_m = center,
                           .half_size_m = {4.0F, 3.0F, 5.0F},
                           .edge = 0.4F,
                           .extinction_per_m = extinction,
                           .extinction_color = {0.3F, 0.6F, 1.0F},
                           .factor = 3.0F,
                           .albedo = {0.2F, 0.5F, 0.9F},
                           .emission_per_m = {0.1F, 0.2F, 0.3F}};
    };
    scene.inputs.medium.volumes = {cloud(VolumeBlend::add, {3.0F, 0.0F, -12.0F}, 0.5F),
                                   cloud(VolumeBlend::max, {-3.0F, 0.0F, -12.0F}, 0.3F),
                                   cloud(VolumeBlend::subtract, {0.0F, 1.0F, -16.0F}, 0.1F),
                                   cloud(VolumeBlend::multiply, {0.0F, -2.0F, -8.0F}, 0.0F)};
    scene.inputs.medium.ambient_radiance = glm::vec3(0.3F);
    scene.inputs.sun = Sun{glm::normalize(glm::vec3(0.3F, -1.0F, 0.2F)), glm::vec3(9.0F), false};
    scene.lights = {{.position_range = {2.0F, 4.0F, -10.0F, 40.0F},
                     .intensity_type = {40.0F, 40.0F, 40.0F, 0.0F},
                     .direction_radius = {0.0F, -1.0F, 0.0F, 0.02F},
                     .cone = {0.0F, 1.0F, 0.0F, 0.0F}}};
    for (const LightPath path : {LightPath::closed_form, LightPath::march}) {
        for (const Integrator integrator :
             {Integrator::euler, Integrator::half_slice, Integrator::exponential, Integrator::exponential_quadratic}) {
            scene.inputs.settings.light_path = path;
            scene.inputs.settings.integrator = integrator;
            EXPECT_LE(largest_difference_to_grey(scene), 1e-4);
        }
    }
}

TEST_F(ColoredExtinction, IsMultipliedByMapAndGridsInEachChannel) {
    Scene scene = colored_scene();
    const auto texels = [](const glm::uvec3& size) {
        std::vector<std::uint8_t> values(std::size_t{size.x} * size.y * size.z);
        for (std::size_t i = 0; i < values.size(); ++i) {
            values[i] = static_cast<std::uint8_t>(64 + (i * 67) % 192);
        }
        return *DensityTexels::create(size, std::move(values));
    };
    scene.inputs.medium.height = {.extinction_per_m = 0.1F, .extinction_color = {0.5F, 1.0F, 0.25F}};
    scene.inputs.medium.map = {.texels = texels({5, 7, 1}), .center_m = {0.0F, -30.0F}, .size_m = {40.0F, 60.0F}};
    scene.inputs.medium.volumes = {{.center_m = {0.0F, 0.0F, -12.0F},
                                    .half_size_m = {4.0F, 3.0F, 5.0F},
                                    .extinction_per_m = 0.3F,
                                    .extinction_color = {0.3F, 0.6F, 1.0F},
                                    .density = texels({4, 3, 5})}};
    scene.inputs.medium.ambient_radiance = glm::vec3(0.3F);
    EXPECT_LE(largest_difference_to_grey(scene), 1e-4);
}

TEST_F(ColoredExtinction, IsLeftOutWhereEveryMediumIsGrey) {
    const auto leaves_out = [&](const Scene& scene) {
        const std::vector<std::string> omissions = render(scene).omissions;
        return std::find(omissions.begin(), omissions.end(), "extinction of each channel: every medium is grey") !=
               omissions.end();
    };
    Scene scene = colored_scene();
    EXPECT_FALSE(leaves_out(scene));
    scene.inputs.medium.homogeneous.extinction_color = glm::vec3(1.0F);
    scene.inputs.medium.height.extinction_color = {1.0F, 0.0F, 0.0F}; // there is none
    EXPECT_TRUE(leaves_out(scene));
}

} // namespace
} // namespace tyndall::volumetrics::test
