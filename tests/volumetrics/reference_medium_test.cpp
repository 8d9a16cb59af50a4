// The reference's phase function and optical depths against sums that know nothing of their closed forms.
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>

#include "features/volumetrics/reference/medium.hpp"
#include "features/volumetrics/reference/optical_depth.hpp"

namespace tyndall::volumetrics::reference {
namespace {

TEST(ReferenceMedium, PhaseIntegratesToOne) {
    for (const double g : {-0.999, -0.7, 0.0, 0.3, 0.9, 0.999}) {
        // Midpoints over u with 1 - |cos| from the peak = 2 u^8, so that the peak gets its share of nodes.
        constexpr int count = 200000;
        double sum = 0.0;
        for (int i = 0; i < count; ++i) {
            const double u = (i + 0.5) / count;
            const double cos_theta = (g < 0.0 ? -1.0 : 1.0) * (1.0 - 2.0 * std::pow(u, 8.0));
            sum += henyey_greenstein(g, cos_theta) * 16.0 * std::pow(u, 7.0) / count;
        }
        EXPECT_NEAR(2.0 * std::numbers::pi * sum, 1.0, 1e-6) << g;
    }
    EXPECT_GT(henyey_greenstein(0.5, 1.0), henyey_greenstein(0.5, -1.0)); // g > 0 scatters forward
}

TEST(ReferenceMedium, DirectedAmbientEqualsTheSumOverTheSphere) {
    Medium medium;
    medium.ambient_radiance = {2.0F, 3.0F, 4.0F};
    medium.ambient_sh_1 = {glm::vec3(1.0F, 0.0F, 2.0F), glm::vec3(0.5F, -1.0F, 0.0F), glm::vec3(0.0F, 2.0F, -3.0F)};
    medium.phase_lobes.lobes = {PhaseLobe{PhaseFunction::cornette_shanks, 0.7F, 0.8F},
                                PhaseLobe{PhaseFunction::schlick, -0.4F, 0.2F}};
    medium.phase_lobes.count = 2;
    const glm::dvec3 view = glm::normalize(glm::dvec3(0.3, -0.5, 0.8));
    glm::dvec3 sum(0.0);
    constexpr int rings = 1000;
    constexpr int sectors = 500;
    for (int i = 0; i < rings; ++i) {
        for (int k = 0; k < sectors; ++k) {
            const double y = -1.0 + (i + 0.5) * 2.0 / rings;
            const double around = (k + 0.5) * 2.0 * std::numbers::pi / sectors;
            const double r = std::sqrt(1.0 - y * y);
            const glm::dvec3 from(r * std::cos(around), y, r * std::sin(around));
            const glm::dvec3 radiance =
                glm::dvec3(medium.ambient_radiance) + 0.4886025119 * (from.y * glm::dvec3(medium.ambient_sh_1[0]) +
                                                                      from.z * glm::dvec3(medium.ambient_sh_1[1]) +
                                                                      from.x * glm::dvec3(medium.ambient_sh_1[2]));
            // The light travels along -from, toward the eye leads -view.
            sum += radiance * phase(medium, glm::dot(from, view)) * (4.0 * std::numbers::pi / rings / sectors);
        }
    }
    const glm::dvec3 found = scattered_ambient(medium, view);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(found[c], sum[c], 1e-4 * sum[c]);
    }
    medium.ambient_sh_1 = {};
    EXPECT_EQ(scattered_ambient(medium, view), glm::dvec3(2.0, 3.0, 4.0));
}

TEST(ReferenceMedium, OpticalDepthEqualsTheSum) {
    Medium medium;
    medium.homogeneous.extinction_per_m = 0.03F;
    medium.height.extinction_per_m = 0.5F;
    medium.height.base_height_m = 1.0F;
    medium.height.falloff_per_m = 0.7F;
    const Fog fog(medium, 0.0);
    const auto depth = [&](const glm::dvec3& a, const glm::dvec3& b) {
        return fog.closed_optical_depth({a, glm::normalize(b - a)}, glm::length(b - a)).x;
    };
    const glm::dvec3 from{1.0, -2.0, 3.0};
    for (const double y : {-5.0, -2.0, 0.5, 1.0, 6.0, 40.0}) {
        const glm::dvec3 to{4.0, y, -9.0};
        const double length_m = std::hypot(3.0, y + 2.0, 12.0);
        constexpr int count = 200000;
        double sum = 0.0;
        for (int i = 0; i < count; ++i) {
            const double height_m = -2.0 + (y + 2.0) * (i + 0.5) / count - 1.0;
            sum += 0.03 + 0.5 * std::exp(-0.7 * std::fmax(0.0, height_m));
        }
        const double expected = sum * length_m / count;
        EXPECT_NEAR(depth(from, to), expected, 1e-6 * expected) << y;
        EXPECT_NEAR(depth(to, from), expected, 1e-6 * expected) << y;
    }
}

/// The way of the sun's light through a volume counts, that through fog without end does not.
TEST(ReferenceMedium, SunThroughALocalVolume) {
    Medium medium;
    medium.homogeneous.extinction_per_m = 0.1F;
    medium.volumes = {LocalVolume{.center_m = {0.0F, 10.0F, 0.0F},
                                  .half_size_m = {4.0F, 2.0F, 4.0F},
                                  .rotation = glm::angleAxis(0.5F, glm::vec3(0.0F, 1.0F, 0.0F)),
                                  .extinction_per_m = 0.5F}};
    const Fog fog(medium, 0.0);
    for (const double slope : {0.0, 0.1}) {
        const Ray up{{0.0, 0.0, 0.0}, glm::normalize(glm::dvec3(slope, 1.0, 0.0))};
        EXPECT_NEAR(optical_depth_of_sky(fog, up, 1e-9).value.x, 2.0 * std::hypot(1.0, slope), 1e-7);
    }
    EXPECT_EQ(optical_depth_of_sky(fog, {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}, 1e-9).value.x, 0.0);
}

// Each channel against a sum over points, of a medium in which every part takes more of one channel than of another.
TEST(ReferenceMedium, OpticalDepthOfEachChannelEqualsItsSum) {
    Medium medium;
    medium.homogeneous = {.extinction_per_m = 0.2F, .extinction_color = {1.0F, 0.5F, 0.0F}};
    medium.height = {
        .extinction_per_m = 0.4F, .extinction_color = {0.0F, 0.5F, 1.0F}, .base_height_m = 1.0F, .falloff_per_m = 0.5F};
    const Ray ray{{0.0, 0.5, 0.0}, glm::normalize(glm::dvec3(0.2, 0.3, -1.0))};
    const double length_m = 12.0;
    const auto sum = [&] {
        constexpr int steps = 200000;
        glm::dvec3 total(0.0);
        for (int i = 0; i < steps; ++i) {
            total += Fog(medium, 0.0).at(point_at(ray, length_m * (i + 0.5) / steps)).extinction * (length_m / steps);
        }
        return total;
    };
    const auto expect_near = [](const glm::dvec3& found, const glm::dvec3& expected, double error) {
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(found[c], expected[c], error) << c;
        }
    };
    expect_near(optical_depth(Fog(medium, 0.0), ray, length_m, 1e-9).value, sum(), 1e-8);
    expect_near(Fog(medium, 0.0).at({0.0, 0.0, 0.0}).extinction, {0.2, 0.3, 0.4}, 1e-7);
    const auto volume = [](VolumeBlend blend, double z) {
        return LocalVolume{.blend = blend,
                           .center_m = {0.0F, 1.0F, static_cast<float>(z)},
                           .half_size_m = {2.0F, 2.0F, 1.5F},
                           .edge = 0.5F,
                           .extinction_per_m = 0.3F,
                           .extinction_color = {0.2F, 1.0F, 0.6F}};
    };
    medium.volumes = {volume(VolumeBlend::add, -2.0), volume(VolumeBlend::subtract, -4.0),
                      volume(VolumeBlend::max, -6.0)};
    expect_near(optical_depth(Fog(medium, 0.0), ray, length_m, 1e-7).value, sum(), 1e-4);
}

} // namespace
} // namespace tyndall::volumetrics::reference
