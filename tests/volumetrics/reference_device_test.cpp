// Pictures of the device against the reference, which shares no arithmetic with the shaders.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <glm/gtc/quaternion.hpp>

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

/// Light that fog before a black wall at 20 m sends to the eye, of some pixels.
std::vector<reference::Pixel> some_pixels(const Scene& scene, std::size_t count) {
    return reference::random_pixels({scene.image.x, scene.image.y}, count, 1);
}

std::vector<reference::Estimate> exact_airlight(const Scene& scene, const reference::Scene& truth, std::size_t count,
                                                double tolerance) {
    const reference::Camera camera{.world_from_camera = glm::dmat4(1.0), .fov_y_rad = 2.0 * std::atan(tan_y)};
    std::vector<reference::Estimate> exact;
    for (const reference::Pixel& pixel : some_pixels(scene, count)) {
        const reference::Ray ray = reference::pixel_ray(camera, {scene.image.x, scene.image.y}, pixel);
        exact.push_back(reference::airlight(truth, ray, -20.0 / ray.direction.z, {tolerance, 0.0}));
    }
    return exact;
}

struct AirlightError {
    double relative_l2 = 0.0;
    double bias = 0.0; ///< of the mean, relative to it
};

AirlightError airlight_error(const Result& result, const Scene& scene, const std::vector<reference::Estimate>& exact) {
    double error = 0.0;
    double total = 0.0;
    double bias = 0.0;
    double claimed = 0.0;
    double sum = 0.0;
    const std::vector<reference::Pixel> pixels = some_pixels(scene, exact.size());
    for (std::size_t i = 0; i < exact.size(); ++i) {
        const glm::dvec3& value = exact[i].value;
        const glm::dvec3 found(result.color[pixels[i].y * scene.image.x + pixels[i].x]);
        error += glm::dot(found - value, found - value);
        total += glm::dot(value, value);
        claimed += glm::dot(exact[i].error, exact[i].error);
        bias += found.r - value.r;
        sum += value.r;
    }
    std::printf("relative L2 %.2e, bias %.1e, the reference's own error %.1e\n", std::sqrt(error / total), bias / sum,
                std::sqrt(claimed / total));
    return {std::sqrt(error / total), bias / sum};
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
        const AirlightError error = airlight_error(render(scene), scene, exact_airlight(scene, truth, 2000, 1e-6));
        EXPECT_LE(error.relative_l2, 1e-2);
        EXPECT_LE(std::abs(error.bias), 5e-3);
    }
}

/// A sun that slants, before a black wall at 20 m.
Scene sunny_scene() {
    Scene scene = plain_scene();
    scene.inputs.sun = Sun{glm::normalize(glm::vec3(0.3F, -1.0F, 0.2F)), glm::vec3(15.0F), false};
    scene.depth_m = [](std::uint32_t, std::uint32_t) { return 20.0; };
    scene.color = [](std::uint32_t, std::uint32_t) { return glm::vec4(0.0F); };
    scene.inputs.settings.light_path = LightPath::march;
    return scene;
}

reference::Scene truth_of(const Scene& scene) {
    reference::Scene truth;
    truth.medium = scene.inputs.medium;
    truth.time_s = scene.inputs.time_s;
    if (scene.inputs.sun) {
        truth.sun = reference::DirectionalLight{glm::normalize(glm::dvec3(scene.inputs.sun->direction)),
                                                glm::dvec3(15.0), false};
    }
    for (const gpu::GpuLight& light : scene.lights) {
        truth.lights.push_back({.position = glm::dvec3(light.position_range),
                                .intensity_cd = glm::dvec3(light.intensity_type),
                                .radius_m = static_cast<double>(light.direction_radius.w),
                                .range_m = static_cast<double>(light.position_range.w),
                                .casts_shadows = false});
    }
    return truth;
}

gpu::GpuLight lamp(const glm::vec3& position, float candela) {
    return {.position_range = glm::vec4(position, 30.0F),
            .intensity_type = {candela, candela, candela, 0.0F},
            .direction_radius = {0.0F, -1.0F, 0.0F, 0.02F},
            .cone = {0.0F, 1.0F, 0.0F, 0.0F}};
}

// A dense box above the view, which no froxel sees, a soft ball in it that shadows itself, thin air around them. The
// froxels' size is what is left: without the march a third of the light is too much.
TEST_F(AgainstReference, LocalVolumesWeakenLight) {
    Scene scene = sunny_scene();
    scene.inputs.medium.homogeneous.extinction_per_m = 0.03F;
    scene.inputs.medium.volumes = {LocalVolume{.center_m = {-2.0F, 13.0F, -10.0F},
                                               .half_size_m = {6.0F, 1.0F, 5.0F},
                                               .rotation = glm::angleAxis(0.3F, glm::vec3(0.0F, 0.0F, 1.0F)),
                                               .extinction_per_m = 1.0F},
                                   LocalVolume{.shape = VolumeShape::ellipsoid,
                                               .center_m = {4.0F, -1.0F, -11.0F},
                                               .half_size_m = {3.0F, 2.5F, 3.0F},
                                               .edge = 0.6F,
                                               .extinction_per_m = 0.8F,
                                               .albedo = {1.0F, 0.8F, 0.6F}}};
    scene.lights = {lamp({9.0F, 1.0F, -12.0F}, 60.0F)};
    const reference::Scene truth = truth_of(scene);
    const std::vector<reference::Estimate> exact = exact_airlight(scene, truth, 150, 1e-3);
    const AirlightError marched = airlight_error(render(scene), scene, exact);
    EXPECT_LE(marched.relative_l2, 2e-2);
    EXPECT_LE(std::abs(marched.bias), 5e-3);
    scene.inputs.settings.light_path = LightPath::closed_form;
    EXPECT_GE(airlight_error(render(scene), scene, exact).bias, 0.2);
}

// Denser and thinner places of height fog; what stands in homogeneous fog counts for the lamp alone.
TEST_F(AgainstReference, EveryBlendWeakensLight) {
    Scene scene = sunny_scene();
    scene.inputs.medium.homogeneous.extinction_per_m = 0.05F;
    scene.inputs.medium.height = {.extinction_per_m = 0.15F, .base_height_m = 0.0F, .falloff_per_m = 0.2F};
    scene.inputs.medium.volumes = {LocalVolume{.shape = VolumeShape::ellipsoid,
                                               .blend = VolumeBlend::multiply,
                                               .center_m = {-3.0F, 4.0F, -11.0F},
                                               .half_size_m = {4.0F, 3.0F, 4.0F},
                                               .edge = 0.5F,
                                               .factor = 8.0F},
                                   LocalVolume{.blend = VolumeBlend::subtract,
                                               .center_m = {6.0F, 3.0F, -11.0F},
                                               .half_size_m = {3.0F, 4.0F, 5.0F},
                                               .extinction_per_m = 0.1F},
                                   LocalVolume{.blend = VolumeBlend::max,
                                               .center_m = {0.0F, -3.0F, -10.0F},
                                               .half_size_m = {5.0F, 2.0F, 3.0F},
                                               .edge = 0.3F,
                                               .extinction_per_m = 0.7F}};
    scene.lights = {lamp({0.0F, 7.0F, -12.0F}, 60.0F)};
    const std::vector<reference::Estimate> exact = exact_airlight(scene, truth_of(scene), 100, 1e-3);
    EXPECT_LE(airlight_error(render(scene), scene, exact).relative_l2, 2e-2);
    scene.inputs.settings.light_path = LightPath::closed_form;
    EXPECT_GE(airlight_error(render(scene), scene, exact).relative_l2, 5e-2);
}

// Wisps of fog that stand in each other's light, of the sun and of a lamp.
TEST_F(AgainstReference, NoiseWeakensLight) {
    Scene scene = sunny_scene();
    scene.inputs.medium.height = {.extinction_per_m = 0.3F, .base_height_m = 0.0F, .falloff_per_m = 0.2F};
    scene.inputs.medium.noise = {.amplitude = 0.9F, .scale_m = 4.0F, .wind_m_s = {0.5F, 0.0F, 0.1F}};
    scene.inputs.time_s = 4.0;
    scene.lights = {lamp({-7.0F, 3.0F, -12.0F}, 60.0F)};
    const reference::Scene truth = truth_of(scene);
    const std::vector<reference::Estimate> exact = exact_airlight(scene, truth, 80, 1e-3);
    EXPECT_LE(airlight_error(render(scene), scene, exact).relative_l2, 2e-2);
    scene.inputs.settings.light_path_steps = 32;
    EXPECT_LE(airlight_error(render(scene), scene, exact).relative_l2, 6e-3);
    scene.inputs.settings.light_path = LightPath::closed_form;
    EXPECT_GE(airlight_error(render(scene), scene, exact).relative_l2, 5e-2);
}

// Alone, so that the sun does not hide a part of its way.
TEST_F(AgainstReference, NoiseWeakensALampsLightOnAllOfItsWay) {
    Scene scene = sunny_scene();
    scene.inputs.sun.reset();
    scene.inputs.medium.homogeneous.extinction_per_m = 0.2F;
    scene.inputs.medium.noise = {.amplitude = 0.9F, .scale_m = 8.0F};
    scene.inputs.settings.light_path_steps = 32;
    scene.lights = {lamp({-7.0F, 3.0F, -12.0F}, 60.0F)};
    const std::vector<reference::Estimate> exact = exact_airlight(scene, truth_of(scene), 80, 1e-3);
    const double error = airlight_error(render(scene), scene, exact).relative_l2;
    std::printf("noise before a lamp: %.2e\n", error);
    EXPECT_LE(error, 3e-3);
}

} // namespace
} // namespace tyndall::volumetrics::test
