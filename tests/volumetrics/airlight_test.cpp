// Lights that each pixel integrates along its ray: which ones, what they bring against the reference, which shares no
// arithmetic with the shaders, and that nothing is lit twice or not at all.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>

#include "features/volumetrics/airlight.hpp"
#include "features/volumetrics/change.hpp"
#include "features/volumetrics/reference/render.hpp"
#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

gpu::GpuLight gpu_light(const reference::Light& light) {
    gpu::GpuLight made{.position_range = glm::vec4(light.position, light.range_m),
                       .intensity_type = glm::vec4(light.intensity_cd, 0.0),
                       .direction_radius = glm::vec4(0.0, -1.0, 0.0, light.radius_m),
                       .cone = {0.0F, 1.0F, 0.0F, 0.0F}};
    if (light.cone) {
        const double scale = 1.0 / std::max(0.001, std::cos(light.cone->inner_rad) - std::cos(light.cone->outer_rad));
        made.intensity_type.w = 1.0F;
        made.direction_radius = glm::vec4(light.cone->direction, light.radius_m);
        made.cone = glm::vec4(scale, -std::cos(light.cone->outer_rad) * scale, 0.0, 0.0);
    }
    return made;
}

reference::Light lamp(const glm::dvec3& position, double candela = 10.0) {
    return {.position = position, .intensity_cd = glm::dvec3(candela), .range_m = 30.0, .casts_shadows = false};
}

reference::Light sized(reference::Light light, double radius_m) {
    light.radius_m = radius_m;
    return light;
}

FrameInputs inputs_with(const std::vector<reference::Light>& lights) {
    FrameInputs inputs = plain_scene().inputs;
    inputs.medium.homogeneous.extinction_per_m = 0.05F;
    inputs.settings.airlight.max_lights = 4;
    for (const reference::Light& light : lights) {
        inputs.lights.push_back(gpu_light(light));
    }
    return inputs;
}

using Places = std::vector<std::uint32_t>;

Places chosen(const FrameInputs& inputs, const Places& before = {}) {
    FrameMemory memory = memory_of(inputs, volumetric_parameters(inputs, std::nullopt));
    memory.airlights = before;
    return choose_airlights(inputs, memory).lights;
}

TEST(AirlightChoice, IsOfLightsInAndBesideTheView) {
    EXPECT_EQ(chosen(inputs_with({})), Places{});
    const std::vector<reference::Light> lights{lamp({0.0, 0.0, -6.0}), lamp({-5.9, 3.0, -6.0}), lamp({9.0, 0.0, -6.0}),
                                               lamp({0.0, 0.0, 4.0}), lamp({0.2, 5.0, -6.0})};
    // The half width of the view at 6 m is 6 m, its half height 3.4 m: the third, the fourth and the last are outside.
    EXPECT_EQ(chosen(inputs_with(lights)), (Places{0, 1}));
    FrameInputs inputs = inputs_with(lights);
    inputs.settings.airlight.max_lights = 0;
    EXPECT_EQ(chosen(inputs), Places{});
    EXPECT_EQ(choose_airlights(inputs, std::nullopt).why_not, "airlight.max_lights is 0");
}

TEST(AirlightChoice, LeavesNoiseMapsVolumesAndColoredExtinctionToTheFroxels) {
    FrameInputs inputs = inputs_with({lamp({0.0, 0.0, -6.0})});
    EXPECT_EQ(chosen(inputs), Places{0});
    inputs.medium.noise.amplitude = 0.1F;
    EXPECT_EQ(chosen(inputs), Places{});
    inputs.medium.noise.amplitude = 0.0F;
    inputs.medium.volumes.push_back({.extinction_per_m = 0.1F});
    EXPECT_EQ(chosen(inputs), Places{});
    inputs.medium.volumes.clear();
    inputs.medium.map.texels = *DensityTexels::create({2, 1, 1}, {255, 0});
    EXPECT_EQ(chosen(inputs), Places{});
    EXPECT_EQ(choose_airlights(inputs, std::nullopt).why_not,
              "only froxels know noise, a density map, local volumes and particles");
    inputs.medium.map.texels.reset();
    inputs.medium.homogeneous.extinction_color = {1.0F, 1.0F, 0.5F};
    EXPECT_EQ(chosen(inputs), Places{});
    EXPECT_EQ(choose_airlights(inputs, std::nullopt).why_not, "only froxels know extinction of each channel");
}

TEST(AirlightChoice, TakesASpotBesideTheViewWhoseConeIsNarrow) {
    std::vector<reference::Light> lights{lamp({0.0, 6.0, -6.0}), lamp({0.0, 6.0, -6.0})};
    lights[1].cone = reference::Cone{glm::dvec3(0.0, -1.0, 0.0), 0.01, 0.05};
    EXPECT_EQ(chosen(inputs_with(lights)), Places{1});
}

TEST(AirlightChoice, IsOfTheBrightestAsSeen) {
    std::vector<reference::Light> lights{lamp({0.0, 0.0, -6.0}, 10.0), lamp({0.0, 1.0, -6.0}, 30.0),
                                         lamp({0.0, 1.0, -12.0}, 30.0), lamp({1.0, 0.0, -6.0}, 0.01)};
    FrameInputs inputs = inputs_with(lights);
    EXPECT_EQ(chosen(inputs), (Places{0, 1, 2})); // the last is too dim
    inputs.settings.airlight.max_lights = 2;
    EXPECT_EQ(chosen(inputs), (Places{1, 2})); // 30 e^(-0.05 12) / 12 against 10 e^(-0.05 6) / 6
    EXPECT_EQ(choose_airlights(inputs, std::nullopt).why_not, "airlight.max_lights is 2");
    inputs.medium.homogeneous.extinction_per_m = 0.2F;
    EXPECT_EQ(chosen(inputs), (Places{0, 1}));
}

TEST(AirlightChoice, KeepsWhatItChoseBefore) {
    // A froxel at 6 m is 0.075 m wide; chosen within 4 of them, kept within 6.
    const double edge_m = 6.0;
    const double diagonal = std::sqrt(2.0); // of the view's edge, 45 degrees from its axis
    for (const auto& [widths, fresh, kept] :
         {std::tuple(3.5, true, true), std::tuple(5.0, false, true), std::tuple(7.0, false, false)}) {
        const FrameInputs inputs = inputs_with({sized(lamp({edge_m + widths * 0.0755 * diagonal, 0.0, -edge_m}), 0.0)});
        EXPECT_EQ(!chosen(inputs).empty(), fresh) << widths;
        EXPECT_EQ(!chosen(inputs, {0}).empty(), kept) << widths;
    }
    FrameInputs inputs = inputs_with({lamp({0.0, 0.0, -6.0}, 10.0), lamp({1.0, 0.0, -6.0}, 12.0)});
    inputs.settings.airlight.max_lights = 1;
    EXPECT_EQ(chosen(inputs), Places{1});
    EXPECT_EQ(chosen(inputs, {0}), Places{0});
    inputs.lights[1].intensity_type = glm::vec4(glm::vec3(16.0F), 0.0F);
    EXPECT_EQ(chosen(inputs, {0}), Places{1});
    // Another number of lights: the same lamp is known by its place in the world.
    FrameMemory memory = memory_of(inputs, volumetric_parameters(inputs, std::nullopt));
    memory.airlights = {0};
    inputs.lights[1].intensity_type = glm::vec4(glm::vec3(12.0F), 0.0F);
    inputs.lights.insert(inputs.lights.begin(), gpu_light(lamp({0.0, 2.0, -6.0}, 1.0)));
    EXPECT_EQ(choose_airlights(inputs, memory).lights, Places{1});
}

TEST(AirlightChoice, ChangesTheLightOfFroxelsThatALightReachesOnly) {
    FrameInputs inputs = inputs_with({lamp({0.0, 0.0, -6.0}), lamp({1.0, 0.0, -6.0})});
    FrameInputs without_first = inputs;
    without_first.lights = froxel_lights(inputs, {.lights = {0}, .why_not = {}});
    const FrameMemory memory = memory_of(inputs, volumetric_parameters(inputs, std::nullopt));
    const std::vector<LightChange> changes = light_changes(without_first, memory);
    ASSERT_EQ(changes.size(), 1U);
    EXPECT_EQ(changes[0].before.intensity_type.r, 10.0F);
    EXPECT_EQ(changes[0].now.intensity_type.r, 0.0F);
    // Moving while it is left out is no change of the froxels.
    const FrameMemory dark = memory_of(without_first, volumetric_parameters(without_first, std::nullopt));
    without_first.lights[0].position_range.x += 1.0F;
    EXPECT_TRUE(light_changes(without_first, dark).empty());
}

/// One light in one fog, before walls at 4 m and 20 m, side by side in stripes.
struct Case {
    const char* name;
    reference::Light light;
    float g = 0.0F;
    bool height_fog = false;
    double error = 3e-3;   ///< relative L2
    double largest = 3e-2; ///< error of a pixel in parts of the brightest

    friend std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }
};

class Airlight : public FogTest {};
class AirlightOf : public FogTest, public testing::WithParamInterface<Case> {};

double wall_m(std::uint32_t x) {
    return x / 8 % 2 == 0 ? 4.0 : 20.0;
}

Scene scene_of(const Case& c) {
    Scene scene = plain_scene();
    scene.inputs.settings.airlight.max_lights = 1;
    scene.inputs.medium.homogeneous = {.extinction_per_m = 0.05F, .albedo = {0.9F, 0.8F, 1.0F}};
    if (c.height_fog) {
        scene.inputs.medium.height = {
            .extinction_per_m = 0.2F, .albedo = {1.0F, 0.9F, 0.7F}, .base_height_m = -1.0F, .falloff_per_m = 0.7F};
    }
    scene.inputs.medium.phase_g = c.g;
    scene.depth_m = [](std::uint32_t x, std::uint32_t) { return wall_m(x); };
    scene.lights = {gpu_light(c.light)};
    return scene;
}

TEST_P(AirlightOf, IsThatOfTheReference) {
    const Case& c = GetParam();
    const Scene scene = scene_of(c);
    const Result result = render(scene);
    ASSERT_TRUE(std::any_of(result.omissions.begin(), result.omissions.end(), [](const std::string& text) {
        return text.starts_with("1 local light of 1 in the froxels");
    }));
    EXPECT_TRUE(std::all_of(result.in_scattered.begin(), result.in_scattered.end(),
                            [](const glm::vec4& v) { return glm::vec3(v) == glm::vec3(0.0F); }));

    reference::Scene truth;
    truth.medium = scene.inputs.medium;
    truth.lights = {c.light};
    const reference::ImageSize size{scene.image.x, scene.image.y};
    const reference::Camera camera{.world_from_camera = glm::dmat4(1.0), .fov_y_rad = 2.0 * std::atan(tan_y)};
    double error = 0.0;
    double total = 0.0;
    double bias = 0.0;
    double sum = 0.0;
    double largest = 0.0;
    double brightest = 0.0;
    std::vector<reference::Pixel> pixels = reference::random_pixels(size, 1500, 1);
    for (std::uint32_t y = 80; y < 100; ++y) {
        for (std::uint32_t x = 150; x < 170; ++x) {
            pixels.push_back({x, y});
        }
    }
    for (const reference::Pixel& pixel : pixels) {
        const reference::Ray ray = reference::pixel_ray(camera, size, pixel);
        const reference::Estimate exact =
            reference::airlight(truth, ray, -wall_m(pixel.x) / ray.direction.z, {1e-6, 1e-12});
        const glm::dvec3 found(result.color[pixel.y * scene.image.x + pixel.x]);
        error += glm::dot(found - exact.value, found - exact.value);
        total += glm::dot(exact.value, exact.value);
        bias += found.g - exact.value.g;
        sum += exact.value.g;
        largest = std::max(largest, glm::length(found - exact.value));
        brightest = std::max(brightest, glm::length(exact.value));
    }
    std::printf("%s: relative L2 %.1e, bias %+.1e, largest %.1e of the brightest\n", c.name, std::sqrt(error / total),
                bias / sum, largest / brightest);
    EXPECT_LE(std::sqrt(error / total), c.error);
    EXPECT_LE(std::abs(bias / sum), c.error);
    EXPECT_LE(largest / brightest, c.largest);
}

const reference::Cone along_view{glm::dvec3(0.0, 0.0, -1.0), 0.2, 0.4};
const reference::Cone toward_eye{glm::normalize(glm::dvec3(0.1, 0.05, 1.0)), 0.2, 0.4};
const reference::Cone downward{glm::dvec3(0.0, -1.0, 0.0), 0.1, 0.3};

reference::Light spot(const glm::dvec3& position, const reference::Cone& cone) {
    reference::Light light = lamp(position);
    light.cone = cone;
    return light;
}

/// On the ray of pixel (160, 90), whose centre is (0.003125, -0.003125) at one metre.
constexpr glm::dvec3 on_a_ray(0.003125 * 6.0, -0.003125 * 6.0, -6.0);

INSTANTIATE_TEST_SUITE_P(
    Lights, AirlightOf,
    testing::Values(Case{"in the view", lamp({0.3, 0.2, -6.0})}, Case{"on a ray", lamp(on_a_ray), 0.3F},
                    Case{"on a ray, backward", lamp(on_a_ray), -0.8F},
                    Case{"sharply forward", lamp({0.3, 0.2, -6.0}), 0.95F},
                    Case{"behind the eye", sized(lamp({0.05, 0.1, 0.3}), 0.15), 0.3F, false, 5e-3},
                    Case{"at the eye", lamp({0.0, 0.0, 0.0})},
                    Case{"as large as many pixels", sized(lamp({0.1, 0.1, -3.0}), 0.3), 0.5F, false, 5e-3},
                    Case{"in height fog", lamp({0.3, -0.4, -6.0}), 0.5F, true},
                    Case{"spot along the view", spot({-0.5, 0.2, -2.0}, along_view), 0.7F},
                    Case{"spot toward the eye", spot({0.5, 0.2, -12.0}, toward_eye), 0.7F},
                    Case{"spot across", spot({0.3, 2.0, -5.0}, downward), 0.7F},
                    Case{"spot across, backward", spot({0.3, 2.0, -5.0}, downward), -0.7F, true}),
    [](const auto& instance) { return "Case" + std::to_string(instance.index); });

TEST_F(Airlight, IsFiniteAndBoundedWhateverTheLight) {
    for (const double candela : {1e-6, 1e9}) {
        for (const glm::dvec3& place :
             {glm::dvec3(0.0), on_a_ray, glm::dvec3(0.0, 0.0, 0.05), glm::dvec3(0.0, 0.0, -4.0)}) {
            for (const bool narrow : {false, true}) {
                reference::Light light = sized(lamp(place, candela), 0.0);
                if (narrow) {
                    light.cone = reference::Cone{glm::dvec3(0.0, 0.0, -1.0), 0.0, 0.0};
                }
                Scene scene = scene_of({"", light, 0.999F});
                scene.inputs.settings.airlight.max_lights = 4;
                const Result result = render(scene);
                // No point scatters more than intensity times the phase function's peak over the smallest radius, and
                // of such points no more than its width over both sides counts.
                const double bound = candela * (1.0 + 0.999) / (4.0 * 3.1416 * 0.001 * 0.001) * 0.05 * 4.0 / 0.005;
                for (const glm::vec4& pixel : result.color) {
                    ASSERT_TRUE(std::isfinite(pixel.r) && pixel.r >= 0.0F && static_cast<double>(pixel.r) <= bound)
                        << pixel.r;
                }
            }
        }
    }
}

TEST_F(Airlight, CostsNothingWhereNoLightIsChosen) {
    Scene scene = scene_of({"", lamp({12.0, 0.0, -6.0}), 0.4F});
    const Result with = render(scene);
    scene.inputs.settings.airlight.max_lights = 0;
    const Result without = render(scene);
    EXPECT_EQ(with.color, without.color);
    EXPECT_EQ(with.in_scattered, without.in_scattered);
    EXPECT_EQ(with.pass_names, without.pass_names);
}

/// Of several lights some are left out, by clusters and without: the picture is the sum of theirs.
TEST_F(Airlight, AndFroxelsTogetherHoldEveryLightOnce) {
    const std::vector<gpu::GpuLight> lights{gpu_light(lamp({7.0, 0.0, -6.0}, 30.0)), gpu_light(lamp({0.3, 0.2, -6.0})),
                                            gpu_light(lamp({-0.5, 0.5, -8.0}, 5.0))};
    for (const bool clusters : {true, false}) {
        Scene scene = scene_of({"", lamp({0.0, 0.0, 0.0}), 0.4F});
        scene.inputs.settings.clusters = clusters;
        scene.inputs.settings.airlight.max_lights = 4;
        const auto picture = [&](const std::vector<gpu::GpuLight>& some) {
            scene.lights = some;
            return render(scene).color;
        };
        const std::vector<glm::vec4> all = picture(lights);
        std::vector<glm::vec4> sum(all.size(), glm::vec4(0.0F));
        for (const gpu::GpuLight& light : lights) {
            const std::vector<glm::vec4> one = picture({light});
            for (std::size_t i = 0; i < sum.size(); ++i) {
                sum[i] += one[i];
            }
        }
        double worst = 0.0;
        for (std::size_t i = 0; i < sum.size(); ++i) {
            worst = std::max(worst, static_cast<double>(std::abs(all[i].g - sum[i].g) / (sum[i].g + 1e-6F)));
        }
        EXPECT_LE(worst, 1e-4) << clusters;
    }
}

/// Far from a light froxels hold what it brings: there both ways agree.
TEST_F(Airlight, IsThatOfTheFroxelsFarFromTheLight) {
    Scene scene = scene_of({"", lamp({3.0, 1.5, -6.0}), 0.3F});
    scene.depth_m = [](std::uint32_t, std::uint32_t) { return 20.0; };
    const Result pixels = render(scene);
    scene.inputs.settings.airlight.max_lights = 0;
    const Result froxels = render(scene);
    double worst = 0.0;
    for (std::uint32_t y = 0; y < scene.image.y; ++y) {
        for (std::uint32_t x = 0; x < scene.image.x / 2; ++x) {
            const std::size_t i = y * scene.image.x + x;
            worst = std::max(worst, std::abs(static_cast<double>(pixels.color[i].g / froxels.color[i].g) - 1.0));
        }
    }
    EXPECT_LE(worst, 1e-2);
}

} // namespace
} // namespace tyndall::volumetrics::test
