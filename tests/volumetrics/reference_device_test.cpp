// Pictures of the device against the reference, which shares no arithmetic with the shaders.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "features/volumetrics/reference/medium.hpp"
#include "features/volumetrics/reference/render.hpp"
#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

class AgainstReference : public FogTest {};

/// Density of one noise on the device against its definition.
class AgainstReferenceNoise : public FogTest, public testing::WithParamInterface<DensityNoise> {};

TEST_P(AgainstReferenceNoise, IsTheOneThatIsDefined) {
    Scene scene = plain_scene();
    scene.inputs.medium.homogeneous.extinction_per_m = 0.3F;
    scene.inputs.medium.noise = GetParam();
    scene.inputs.time_s = 11.0;
    scene.inputs.camera.origin_m = {123.0, -456.0, 789.0};
    const Result result = render(scene);
    const reference::Fog fog(scene.inputs.medium, scene.inputs.time_s);
    const double density_scale = static_cast<double>(volumetric_parameters(scene.inputs, std::nullopt).density_scale.x);
    const GridSettings& grid = scene.inputs.settings.grid;
    double worst = 0.0;
    for (std::uint32_t k = 0; k < grid.slices; ++k) {
        const auto boundary_m = [&](std::uint32_t i) {
            const double ratio = 1.0 + static_cast<double>(grid.range_m) / static_cast<double>(grid.shape_m);
            return static_cast<double>(grid.shape_m) * (std::pow(ratio, static_cast<double>(i) / grid.slices) - 1.0);
        };
        const double depth_m = 0.5 * (boundary_m(k) + boundary_m(k + 1));
        for (std::uint32_t y = 0; y < grid.height; y += 7) {
            for (std::uint32_t x = 0; x < grid.width; x += 5) {
                const glm::dvec3 ray((2.0 * x / (grid.width - 1.0) - 1.0) * tan_x,
                                     (1.0 - 2.0 * y / (grid.height - 1.0)) * tan_y, -1.0);
                const double expected = fog.at(scene.inputs.camera.origin_m + ray * depth_m).extinction.r;
                const float found = result.density[(k * grid.height + y) * grid.width + x].a;
                worst = std::max(worst, std::abs(static_cast<double>(found) / density_scale / expected - 1.0));
            }
        }
    }
    std::printf("noise: density at most %.1e off\n", worst);
    EXPECT_LE(worst, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(
    Octaves, AgainstReferenceNoise,
    testing::Values(
        DensityNoise{.amplitude = 0.8F, .scale_m = 25.0F, .wind_m_s = {0.7F, -1.0F, 0.4F}},
        DensityNoise{
            .amplitude = 0.8F, .scale_m = 100.0F, .wind_m_s = {0.7F, -1.0F, 0.4F}, .octaves = 3, .gain = 0.7F}));

/// Light that fog before a black wall at 20 m sends to the eye, over 2,000 pixels.
void expect_airlight(const Result& result, const Scene& scene, const reference::Scene& truth) {
    const reference::ImageSize size{scene.image.x, scene.image.y};
    const reference::Camera camera{.world_from_camera = glm::dmat4(1.0), .fov_y_rad = 2.0 * std::atan(tan_y)};
    double error = 0.0;
    double total = 0.0;
    double bias = 0.0;
    double claimed = 0.0;
    double sum = 0.0;
    for (const reference::Pixel& pixel : reference::random_pixels(size, 2000, 1)) {
        const reference::Ray ray = reference::pixel_ray(camera, size, pixel);
        const reference::Estimate exact = reference::airlight(truth, ray, -20.0 / ray.direction.z, {1e-6, 0.0});
        const glm::dvec3 found(result.color[pixel.y * scene.image.x + pixel.x]);
        error += glm::dot(found - exact.value, found - exact.value);
        total += glm::dot(exact.value, exact.value);
        claimed += glm::dot(exact.error, exact.error);
        bias += found.r - exact.value.r;
        sum += exact.value.r;
    }
    std::printf("relative L2 %.2e, bias %.1e, the reference's own error %.1e\n", std::sqrt(error / total), bias / sum,
                std::sqrt(claimed / total));
    EXPECT_LE(std::sqrt(error / total), 1e-2);
    EXPECT_LE(std::abs(bias / sum), 5e-3);
}

/// Shining height fog, a sun and a spot light beside the view, before a black wall at 20 m.
TEST_F(AgainstReference, LightsInHeightFog) {
    Scene scene = plain_scene();
    scene.inputs.medium.homogeneous.extinction_per_m = 0.02F;
    scene.inputs.medium.height = {.extinction_per_m = 0.2F, .base_height_m = -1.0F, .falloff_per_m = 0.4F};
    scene.inputs.medium.homogeneous.emission_per_m = {0.001F, 0.002F, 0.003F};
    scene.inputs.medium.height.emission_per_m = {0.03F, 0.02F, 0.01F};
    scene.inputs.medium.phase_g = 0.5F;
    scene.inputs.medium.ambient_radiance = {0.02F, 0.03F, 0.04F};
    scene.inputs.sun = Sun{glm::normalize(glm::vec3(0.3F, -1.0F, 0.4F)), glm::vec3(2.0F), false};
    scene.depth_m = [](std::uint32_t, std::uint32_t) { return 20.0; };
    scene.color = [](std::uint32_t, std::uint32_t) { return glm::vec4(0.0F); };

    reference::Scene truth;
    truth.medium = scene.inputs.medium;
    truth.sun = reference::DirectionalLight{glm::normalize(glm::dvec3(0.3, -1.0, 0.4)), glm::dvec3(2.0), false};
    truth.lights = {reference::Light{.position = {3.0, 7.0, -9.0},
                                     .intensity_cd = glm::dvec3(80.0, 60.0, 40.0),
                                     .radius_m = 0.02,
                                     .range_m = 30.0,
                                     .cone = reference::Cone{glm::normalize(glm::dvec3(-0.3, -1.0, 0.1)), 0.3, 0.9},
                                     .casts_shadows = false}};
    const float scale = 1.0F / (std::cos(0.3F) - std::cos(0.9F));
    scene.lights = {{.position_range = {3.0F, 7.0F, -9.0F, 30.0F},
                     .intensity_type = {80.0F, 60.0F, 40.0F, 1.0F},
                     .direction_radius = glm::vec4(glm::normalize(glm::vec3(-0.3F, -1.0F, 0.1F)), 0.02F),
                     .cone = {scale, -std::cos(0.9F) * scale, 0.0F, 0.0F}}};

    for (const LightPath path : {LightPath::none, LightPath::closed_form}) {
        scene.inputs.settings.light_path = path;
        truth.attenuates_light = path != LightPath::none;
        SCOPED_TRACE(truth.attenuates_light ? "light is weakened" : "light is not weakened");
        expect_airlight(render(scene), scene, truth);
    }
}

} // namespace
} // namespace tyndall::volumetrics::test
