// Boxes and ellipsoids of fog on the device: optical depths along the rays of froxel centres against geometry in double
// precision, and each way of blending.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <glm/gtc/quaternion.hpp>

#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

constexpr std::uint32_t width = 33;
constexpr std::uint32_t height = 17;
constexpr std::uint32_t slices = 32;

Scene scene_of(const LocalVolume& volume) {
    Scene scene = plain_scene();
    scene.image = {8, 8};
    scene.inputs.settings.grid = {
        .width = width, .height = height, .slices = slices, .range_m = 64.0F, .shape_m = 16.0F};
    scene.inputs.camera.origin_m = {1000.0, 20.0, -300.0};
    scene.inputs.medium.volumes = {volume};
    return scene;
}

LocalVolume turned(VolumeShape shape) {
    return {.shape = shape,
            .center_m = {1001.0F, 19.5F, -312.0F},
            .half_size_m = {3.0F, 1.5F, 4.0F},
            .rotation = glm::angleAxis(0.7F, glm::normalize(glm::vec3(1.0F, 2.0F, -0.5F))),
            .extinction_per_m = 0.3F,
            .albedo = {1.0F, 0.5F, 0.0F}};
}

/// Metres of view depth to the ray's point, of unit depth.
glm::dvec3 column_ray(std::uint32_t x, std::uint32_t y) {
    return {tan_x * (2.0 * x / (width - 1.0) - 1.0), -tan_y * (2.0 * y / (height - 1.0) - 1.0), -1.0};
}

/// The weight as it is defined.
double weight_at(const LocalVolume& volume, const glm::dvec3& world) {
    const glm::dvec3 own = glm::inverse(glm::dquat(volume.rotation)) * (world - glm::dvec3(volume.center_m));
    const glm::dvec3 q = own / glm::dvec3(volume.half_size_m);
    const double edge = std::max(static_cast<double>(volume.edge), 1e-12);
    if (volume.shape == VolumeShape::ellipsoid) {
        return std::clamp((1.0 - glm::length(q)) / edge, 0.0, 1.0);
    }
    double weight = 1.0;
    for (int i = 0; i < 3; ++i) {
        weight *= std::clamp((1.0 - std::abs(q[i])) / edge, 0.0, 1.0);
    }
    return weight;
}

class LocalVolumes : public FogTest {
protected:
    /// Largest error of the columns' optical depth at the range, and the largest optical depth.
    std::pair<double, double> optical_depth_error(const LocalVolume& volume, int steps) {
        const Scene scene = scene_of(volume);
        const Result result = render(scene);
        double worst = 0.0;
        double largest = 0.0;
        for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = 0; x < width; ++x) {
                const glm::dvec3 ray = column_ray(x, y);
                double sum = 0.0;
                for (int i = 0; i < steps; ++i) {
                    const double depth_m = 20.0 * (i + 0.5) / steps; // nothing lies beyond
                    sum += weight_at(volume, scene.inputs.camera.origin_m + depth_m * ray);
                }
                const double expected =
                    static_cast<double>(volume.extinction_per_m) * sum * glm::length(ray) * 20.0 / steps;
                const std::size_t last = (slices * height + y) * width + x;
                worst = std::max(worst, std::abs(static_cast<double>(result.accumulated[last].a) - expected));
                largest = std::max(largest, expected);
            }
        }
        return {worst, largest};
    }

    /// The medium of the froxel in the middle of the view whose slice holds this depth, with the view's homogeneous
    /// fog.
    glm::dvec4 blended(VolumeBlend blend, float extinction, float factor, float background) {
        LocalVolume volume{.blend = blend,
                           .center_m = {1000.0F, 20.0F, -300.0F},
                           .half_size_m = glm::vec3(500.0F),
                           .extinction_per_m = extinction,
                           .factor = factor,
                           .albedo = {1.0F, 0.5F, 0.25F}};
        Scene scene = scene_of(volume);
        scene.inputs.medium.homogeneous = {.extinction_per_m = background, .albedo = {0.5F, 0.5F, 0.5F}};
        const Result result = render(scene);
        const auto scale = static_cast<double>(volumetric_parameters(scene.inputs, std::nullopt).density_scale.y);
        return glm::dvec4(result.density[(10 * height + 8) * width + 16]) * scale;
    }
};

TEST_F(LocalVolumes, HardEdgesHaveTheirExactOverlap) {
    for (const VolumeShape shape : {VolumeShape::box, VolumeShape::ellipsoid}) {
        const auto [worst, largest] = optical_depth_error(turned(shape), 20000);
        std::printf("hard %s: optical depth up to %.3f, off by %.1e\n", shape == VolumeShape::box ? "box" : "ellipsoid",
                    largest, worst);
        EXPECT_GT(largest, 1.0);
        EXPECT_LE(worst, 1e-3); // two steps of the sum that it is held against
    }
}

TEST_F(LocalVolumes, SoftEdgesAreIntegratedWithinTheOverlap) {
    for (const VolumeShape shape : {VolumeShape::box, VolumeShape::ellipsoid}) {
        LocalVolume volume = turned(shape);
        volume.edge = 0.5F;
        const auto [worst, largest] = optical_depth_error(volume, 4000);
        std::printf("soft %s: optical depth up to %.3f, off by %.1e\n", shape == VolumeShape::box ? "box" : "ellipsoid",
                    largest, worst);
        EXPECT_GT(largest, 0.5);
        EXPECT_LE(worst, 0.005 * largest);
    }
}

TEST_F(LocalVolumes, BlendsAsDefined) {
    const auto expect = [](const glm::dvec4& found, const glm::dvec4& expected) {
        for (int i = 0; i < 4; ++i) {
            EXPECT_NEAR(found[i], expected[i], 1e-5) << i;
        }
    };
    expect(blended(VolumeBlend::add, 0.4F, 1.0F, 0.1F), {0.45, 0.25, 0.15, 0.5});
    expect(blended(VolumeBlend::subtract, 0.04F, 1.0F, 0.1F), {0.03, 0.03, 0.03, 0.06});
    expect(blended(VolumeBlend::subtract, 0.4F, 1.0F, 0.1F), glm::dvec4(0.0));
    expect(blended(VolumeBlend::multiply, 0.0F, 3.0F, 0.1F), {0.15, 0.15, 0.15, 0.3});
    expect(blended(VolumeBlend::max, 0.4F, 1.0F, 0.1F), {0.4, 0.2, 0.1, 0.4});
    expect(blended(VolumeBlend::max, 0.05F, 1.0F, 0.1F), {0.05, 0.05, 0.05, 0.1});
}

TEST_F(LocalVolumes, WhatIsEmptyIsLeftOut) {
    LocalVolume volume = turned(VolumeShape::box);
    volume.half_size_m.y = 0.0F;
    Scene scene = scene_of(volume);
    EXPECT_EQ(render(scene).omissions, std::vector<std::string>{"all volumetric passes: the medium is empty"});
    scene.inputs.medium.homogeneous.extinction_per_m = 0.01F;
    const Result result = render(scene);
    EXPECT_NE(std::find(result.omissions.begin(), result.omissions.end(), "local volumes: there is none"),
              result.omissions.end());
    for (const glm::vec4& froxel : result.density) {
        ASSERT_EQ(froxel, result.density.front());
    }
}

TEST_F(LocalVolumes, CameraInAFaceSeesFiniteFog) {
    for (const VolumeShape shape : {VolumeShape::box, VolumeShape::ellipsoid}) {
        LocalVolume volume{.shape = shape,
                           .center_m = {1000.0F, 20.0F, -302.0F},
                           .half_size_m = {2.0F, 2.0F, 2.0F},
                           .extinction_per_m = 1.0F};
        const Result result = render(scene_of(volume));
        const std::size_t centre = (slices * height + 8) * width + 16;
        EXPECT_NEAR(result.accumulated[centre].a, 4.0F, 1e-4F);
        for (const glm::vec4& value : result.accumulated) {
            ASSERT_TRUE(std::isfinite(value.a) && value.a >= 0.0F);
        }
    }
}

} // namespace
} // namespace tyndall::volumetrics::test
