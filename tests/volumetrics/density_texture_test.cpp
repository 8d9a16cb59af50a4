// The density map over the ground and the density grids of local volumes on the device, against the reference.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>

#include <glm/gtc/quaternion.hpp>

#include "features/volumetrics/reference/density_texels.hpp"
#include "features/volumetrics/reference/medium.hpp"
#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

constexpr std::uint32_t width = 33;
constexpr std::uint32_t height = 17;
constexpr std::uint32_t slices = 64;

std::shared_ptr<const DensityTexels> random_texels(const glm::uvec3& size) {
    std::mt19937 random(5);
    std::vector<std::uint8_t> values;
    for (std::uint32_t i = 0; i < size.x * size.y * size.z; ++i) {
        values.push_back(static_cast<std::uint8_t>(random() % 256));
    }
    return *DensityTexels::create(size, std::move(values));
}

Scene small_scene() {
    Scene scene = plain_scene();
    scene.image = {8, 8};
    scene.inputs.settings.grid = {
        .width = width, .height = height, .slices = slices, .range_m = 64.0F, .shape_m = 6.4e6F};
    scene.inputs.camera.origin_m = {1000.0, 20.0, -300.0};
    return scene;
}

bool has(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

class DensityTextures : public FogTest {
protected:
    /// Largest difference of a froxel's extinction to the mean of the reference's along its slice, 1/m; slices of equal
    /// length.
    double largest_difference(const Scene& scene) {
        const Result result = render(scene);
        const reference::Fog fog(scene.inputs.medium, scene.inputs.time_s);
        const auto scale = static_cast<double>(volumetric_parameters(scene.inputs, std::nullopt).density_scale.y);
        double worst = 0.0;
        for (std::uint32_t k = 0; k < slices; k += 3) {
            for (std::uint32_t y = 0; y < height; y += 2) {
                for (std::uint32_t x = 0; x < width; x += 2) {
                    const glm::dvec3 ray(tan_x * (2.0 * x / (width - 1.0) - 1.0),
                                         -tan_y * (2.0 * y / (height - 1.0) - 1.0), -1.0);
                    constexpr int steps = 64;
                    double mean = 0.0;
                    for (int i = 0; i < steps; ++i) {
                        const double depth_m = k + (i + 0.5) / steps;
                        mean += fog.at(scene.inputs.camera.origin_m + depth_m * ray).extinction.r / steps;
                    }
                    const double found = scale * static_cast<double>(result.density[(k * height + y) * width + x].a);
                    worst = std::max(worst, std::abs(found - mean));
                }
            }
        }
        return worst;
    }
};

TEST_F(DensityTextures, MapIsTheOneThatIsDefined) {
    Scene scene = small_scene();
    scene.inputs.medium.homogeneous.extinction_per_m = 1.0F;
    DensityMap& map = scene.inputs.medium.map;
    map = {.texels = random_texels({9, 5, 1}),
           .center_m = {1004.0F, -330.0F},
           .size_m = {50.0F, 40.0F},
           .bottom_m = 8.0F,
           .top_m = 31.0F,
           .fade_m = 4.0F};
    for (const MapEdge edge : {MapEdge::clamp, MapEdge::repeat}) {
        map.edge = edge;
        const double worst = largest_difference(scene);
        std::printf("map: a slice's mean of 1 per metre at most %.1e off\n", worst);
        EXPECT_LE(worst, 1.5e-2); // textures of 8 bits are filtered by weights of 8 bits
    }
}

TEST_F(DensityTextures, GridsAreThoseDefined) {
    Scene scene = small_scene();
    const auto turned = [](const glm::vec3& center_m, float edge, const std::shared_ptr<const DensityTexels>& density) {
        return LocalVolume{.shape = edge > 0.0F ? VolumeShape::ellipsoid : VolumeShape::box,
                           .center_m = center_m,
                           .half_size_m = {9.0F, 5.0F, 12.0F},
                           .rotation = glm::angleAxis(0.7F, glm::normalize(glm::vec3(1.0F, 2.0F, -0.5F))),
                           .edge = edge,
                           .extinction_per_m = 1.0F,
                           .density = density};
    };
    const auto first = random_texels({5, 3, 4});
    const auto second = random_texels({3, 4, 2});
    scene.inputs.medium.volumes = {turned({1008.0F, 21.0F, -330.0F}, 0.5F, first),
                                   turned({985.0F, 18.0F, -340.0F}, 0.4F, second),
                                   turned({1000.0F, 30.0F, -345.0F}, 0.6F, first)};
    const double worst = largest_difference(scene);
    std::printf("grids: a slice's mean of 1 per metre at most %.1e off\n", worst);
    EXPECT_LE(worst, 2e-2);
}

TEST_F(DensityTextures, GridsThinnerThanASliceAreThoseDefined) {
    Scene scene = small_scene();
    // Within slices 3, 9 and 30, whose ends are whole metres.
    const auto sheet = [&](float depth_m, float half_m) {
        return LocalVolume{.center_m = {1000.0F, 20.0F, -300.0F - depth_m},
                           .half_size_m = {60.0F, 60.0F, half_m},
                           .extinction_per_m = 1.0F,
                           .density = random_texels({5, 4, 6})};
    };
    scene.inputs.medium.volumes = {sheet(3.6F, 0.3F), sheet(9.4F, 0.3F), sheet(30.7F, 0.2F)};
    const double worst = largest_difference(scene);
    std::printf("thin grids: a slice's mean of 1 per metre at most %.1e off\n", worst);
    EXPECT_LE(worst, 2e-2);
}

TEST_F(DensityTextures, AreCopiedOnceAndOnlyWhereThereAreSome) {
    Scene scene = small_scene();
    scene.inputs.medium.homogeneous.extinction_per_m = 0.5F;
    const Result plain = render(scene);
    EXPECT_TRUE(has(plain.omissions, "density map: there is none"));
    EXPECT_TRUE(has(plain.omissions, "density grids: no local volume has one"));
    EXPECT_TRUE(feature().own_images().empty());

    scene.inputs.medium.map.texels = *DensityTexels::create({2, 2, 1}, {255, 255, 255, 255});
    const std::vector<Scene> both{scene, scene};
    const std::vector<Result> first = render_views(both);
    EXPECT_EQ(std::count(first[0].pass_names.begin(), first[0].pass_names.end(), "densities 0 copy"), 1);
    for (std::size_t i = 0; i < plain.density.size(); ++i) { // a map of ones changes nothing
        ASSERT_NEAR(first[0].density[i].a, plain.density[i].a, 1e-4F * plain.density[i].a);
    }
    const std::vector<Result> second = render_views(both);
    EXPECT_FALSE(has(second[0].pass_names, "densities 0 copy"));
    EXPECT_EQ(second[1].density, first[0].density);
    EXPECT_EQ(feature().own_images().size(), 1U);
}

TEST_F(DensityTextures, LightComesThroughTheMapsHeights) {
    // Fog between 3 m below and 3 m above the camera, a lamp and the sun far above.
    Scene scene = small_scene();
    Medium& medium = scene.inputs.medium;
    medium.map = {
        .texels = *DensityTexels::create({1, 1, 1}, {255}), .bottom_m = 17.0F, .top_m = 23.0F, .fade_m = 0.01F};
    const auto expect = [&](const char* what, const std::function<double(const glm::dvec3&)>& expected) {
        const Result result = render(scene);
        double worst = 0.0;
        for (std::uint32_t k = 4; k < slices; k += 3) {
            for (std::uint32_t y = 0; y < height; ++y) {
                const glm::dvec3 ray(tan_x * (2.0 * 11.0 / (width - 1.0) - 1.0),
                                     -tan_y * (2.0 * y / (height - 1.0) - 1.0), -1.0);
                const glm::dvec3 p = (k + 0.5) * ray;
                if (std::abs(p.y) < 2.4) {
                    const double found = static_cast<double>(result.in_scattered[(k * height + y) * width + 11].r);
                    worst = std::max(worst, std::abs(found / expected(p) - 1.0));
                }
            }
        }
        std::printf("light through fog between heights, %s: %.1e off\n", what, worst);
        EXPECT_LE(worst, 2e-2) << what;
    };
    const double per_sphere = 1.0 / (4.0 * 3.14159265358979);
    medium.height = {.extinction_per_m = 0.1F, .base_height_m = 21.0F, .falloff_per_m = 0.3F};
    scene.inputs.sun = Sun{.direction = {0.6F, -0.8F, 0.0F}, .illuminance_lux = glm::vec3(10.0F)};
    expect("the sun", [&](const glm::dvec3& p) {
        const double above = (std::exp(-0.3 * std::max(0.0, p.y - 1.0)) - std::exp(-0.3 * 2.0)) / 0.3;
        return 10.0 * per_sphere * std::exp(-0.1 * (above + std::max(0.0, 1.0 - p.y)) / 0.8);
    });
    scene.inputs.sun.reset();
    medium.height.extinction_per_m = 0.0F;
    medium.homogeneous.extinction_per_m = 0.1F;
    const glm::dvec3 lamp(40.0, 200.0, -30.0);
    scene.lights = {{.position_range = glm::vec4(lamp, 1e6F),
                     .intensity_type = glm::vec4(glm::vec3(1e6F), 0.0F),
                     .direction_radius = {0.0F, -1.0F, 0.0F, 0.0F},
                     .cone = {0.0F, 1.0F, 0.0F, 0.0F}}};
    expect("a lamp", [&](const glm::dvec3& p) {
        const glm::dvec3 way = lamp - p;
        const double through_m = (3.0 - p.y) * glm::length(way) / way.y;
        return 1e6 * per_sphere / glm::dot(way, way) * std::exp(-0.1 * through_m);
    });
}

TEST(DensityTexels, HeightsHoldAsMuchAsTheProfile) {
    Medium medium;
    medium.map.texels = *DensityTexels::create({1, 1, 1}, {255});
    for (const float high_m : {0.0F, 0.7F, 1.0F, 1.6F, 2.0F, 9.0F}) {
        medium.map.bottom_m = 5.0F;
        medium.map.top_m = 5.0F + high_m;
        medium.map.fade_m = 1.0F;
        double column_m = 0.0;
        for (int i = 0; i < 10000; ++i) {
            column_m += 1e-3 * reference::map_density(medium.map, {0.0, 5.0 + 1e-3 * (i + 0.5), 0.0});
        }
        const glm::dvec2 heights = heights_of_map(medium);
        EXPECT_NEAR(heights.y - heights.x, column_m, 1e-5) << high_m;
        EXPECT_NEAR(heights.x + heights.y, 10.0 + static_cast<double>(high_m), 1e-5) << high_m;
    }
}

TEST(DensityTexels, ImpossibleOnesAreRefused) {
    const auto refusal = [](const glm::uvec3& size, std::size_t count) {
        const auto texels = DensityTexels::create(size, std::vector<std::uint8_t>(count));
        return texels ? "accepted" : texels.error().message;
    };
    EXPECT_EQ(refusal({2, 3, 4}, 24), "accepted");
    EXPECT_EQ(refusal({2, 0, 4}, 0), "densities must have between 1 and 2048 texels along an axis, not 0.");
    EXPECT_EQ(refusal({4096, 1, 1}, 4096), "densities must have between 1 and 2048 texels along an axis, not 4096.");
    EXPECT_EQ(refusal({2, 3, 4}, 23), "densities must have at most 2^27 texels and a value each, not 24 and 23.");
}

TEST(DensityTexels, LightIsWeakenedByTheMapsMean) {
    FrameInputs inputs;
    inputs.camera.clip_from_view = test_projection();
    inputs.medium.homogeneous.extinction_per_m = 0.5F;
    inputs.medium.height.extinction_per_m = 0.25F;
    inputs.medium.map.texels = *DensityTexels::create({2, 1, 1}, {255, 51});
    EXPECT_FLOAT_EQ(air_of(inputs).x, 0.3F);
    EXPECT_FLOAT_EQ(air_of(inputs).y, 0.15F);
    const gpu::FarField far = volumetric_parameters(inputs, std::nullopt).volume.beyond;
    EXPECT_FLOAT_EQ(far.homogeneous.w, 0.3F);
    EXPECT_FLOAT_EQ(far.height.w, 0.15F);
}

} // namespace
} // namespace tyndall::volumetrics::test
