// The host's side of the uniforms, against plain unprojection in double precision.
#include <cmath>
#include <optional>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "features/volumetrics/parameters.hpp"

namespace tyndall::volumetrics {
namespace {

/// Reverse-Z, y down in clip space; infinite where far_m is 0. `shift` moves the frustum off its axis.
glm::dmat4 perspective(double tan_x, double tan_y, double near_m, double far_m, glm::dvec2 shift = {0.0, 0.0}) {
    glm::dmat4 p(0.0);
    p[0][0] = 1.0 / tan_x;
    p[1][1] = -1.0 / tan_y;
    p[2][0] = shift.x;
    p[2][1] = shift.y;
    p[2][2] = far_m > 0.0 ? near_m / (far_m - near_m) : 0.0;
    p[3][2] = far_m > 0.0 ? near_m * far_m / (far_m - near_m) : near_m;
    p[2][3] = -1.0;
    return p;
}

glm::dmat4 orthographic(double half_x, double half_y, double near_m, double far_m) {
    glm::dmat4 p(1.0);
    p[0][0] = 1.0 / half_x;
    p[1][1] = -1.0 / half_y;
    p[2][2] = 1.0 / (far_m - near_m);
    p[3][2] = far_m / (far_m - near_m);
    return p;
}

glm::dmat4 standard_depth(double tan_x, double near_m, double far_m) {
    glm::dmat4 p(0.0);
    p[0][0] = 1.0 / tan_x;
    p[1][1] = -1.0 / tan_x;
    p[2][2] = -far_m / (far_m - near_m);
    p[3][2] = -near_m * far_m / (far_m - near_m);
    p[2][3] = -1.0;
    return p;
}

class Projections : public testing::TestWithParam<glm::dmat4> {};

TEST_P(Projections, ColumnsAndDepthsInvertTheMatrix) {
    FrameInputs frame;
    frame.camera.clip_from_view = GetParam();
    const gpu::VolumetricParameters u = volumetric_parameters(frame, std::nullopt);
    for (const double depth_m : {0.2, 1.0, 17.0, 90.0}) {
        for (const glm::dvec2 xy : {glm::dvec2(0.0), glm::dvec2(0.3, -0.2), glm::dvec2(-0.5, 0.4)}) {
            const glm::dvec4 view(xy * depth_m, -depth_m, 1.0);
            const glm::dvec4 clip = GetParam() * view;
            const glm::dvec2 uv = glm::dvec2(clip) / clip.w * 0.5 + 0.5;
            for (int i = 0; i < 2; ++i) {
                const double slope =
                    uv[i] * static_cast<double>(u.volume.slope[i]) + static_cast<double>(u.volume.slope[i + 2]);
                const double origin =
                    uv[i] * static_cast<double>(u.volume.origin[i]) + static_cast<double>(u.volume.origin[i + 2]);
                EXPECT_NEAR(slope * depth_m + origin, view[i], 2e-6 * depth_m);
            }
            const double d = clip.z / clip.w;
            const double found = (static_cast<double>(u.depth.x) - d * static_cast<double>(u.depth.y)) /
                                 (static_cast<double>(u.depth.z) + d * static_cast<double>(u.depth.w));
            EXPECT_NEAR(found / depth_m, 1.0, 1e-4);
            EXPECT_GT(u.depth.z + static_cast<float>(d) * u.depth.w, 0.0F);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(All, Projections,
                         testing::Values(perspective(1.0, 0.5625, 0.05, 0.0), perspective(1.0, 0.5625, 0.05, 200.0),
                                         perspective(1.2, 0.7, 0.1, 0.0, {0.2, -0.1}),
                                         orthographic(60.0, 50.0, 0.1, 100.0), standard_depth(1.0, 0.1, 100.0)));

TEST_P(Projections, SkyIsTheFartherEndOfDeviceDepth) {
    FrameInputs frame;
    frame.camera.clip_from_view = GetParam();
    const auto device_depth = [&](double depth_m) {
        const glm::dvec4 clip = GetParam() * glm::dvec4(0.0, 0.0, -depth_m, 1.0);
        return clip.z / clip.w;
    };
    const double towards = device_depth(90.0) - device_depth(1.0);
    EXPECT_EQ(volumetric_parameters(frame, std::nullopt).sky.x, towards > 0.0 ? 1.0F : 0.0F);
}

TEST(Parameters, SkyOfAnInfiniteProjectionIsFar) {
    FrameInputs frame;
    frame.camera.clip_from_view = perspective(1.0, 1.0, 0.1, 0.0);
    const glm::vec4 c = volumetric_parameters(frame, std::nullopt).depth;
    EXPECT_GT(c.x / std::max(c.z, 1e-30F), 1e20F); // as the fragment shader computes it for device depth 0
}

TEST(Parameters, ColdStarts) {
    FrameInputs frame;
    frame.camera.clip_from_view = perspective(1.0, 0.5625, 0.1, 0.0);
    const auto memory = [](const FrameInputs& f) {
        FrameMemory seventh = memory_of(f, volumetric_parameters(f, std::nullopt));
        seventh.frames_since_cut = 7;
        return seventh;
    };
    EXPECT_TRUE(starts_cold(frame, std::nullopt));
    EXPECT_FALSE(starts_cold(frame, memory(frame)));
    FrameInputs other = frame;
    other.cut = true;
    EXPECT_TRUE(starts_cold(other, memory(frame)));
    other = frame;
    other.camera.clip_from_view = perspective(0.9, 0.5625, 0.1, 0.0);
    EXPECT_TRUE(starts_cold(other, memory(frame)));
    other = frame;
    other.settings.grid.range_m = 65.0F;
    EXPECT_TRUE(starts_cold(other, memory(frame)));
    other = frame;
    other.camera.origin_m.x = 0.5;
    EXPECT_FALSE(starts_cold(other, memory(frame)));
    EXPECT_EQ(volumetric_parameters(other, memory(frame)).frame.x, 8U);
}

TEST(Parameters, ReprojectionMovesAPointWithTheWorld) {
    FrameInputs frame;
    frame.camera.clip_from_view = perspective(1.0, 0.5625, 0.1, 0.0);
    frame.camera.origin_m = {1e6, 20.0, -3e5};
    frame.camera.view_from_render = glm::rotate(glm::dmat4(1.0), 0.4, glm::normalize(glm::dvec3(1.0, 2.0, 0.5)));
    FrameMemory before = memory_of(frame, volumetric_parameters(frame, std::nullopt));
    before.camera.origin_m = {1e6 - 0.25, 20.5, -3e5};
    before.camera.view_from_render = glm::rotate(glm::dmat4(1.0), -0.1, glm::dvec3(0.0, 1.0, 0.0));
    const glm::dvec3 world = frame.camera.origin_m + glm::dvec3(3.0, -2.0, -7.0);
    const glm::dvec4 now = frame.camera.view_from_render * glm::dvec4(world - frame.camera.origin_m, 1.0);
    const glm::dvec4 expected = before.camera.view_from_render * glm::dvec4(world - before.camera.origin_m, 1.0);
    const glm::vec4 found = volumetric_parameters(frame, before).previous_view_from_view * glm::vec4(now);
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(static_cast<double>(found[i]), expected[i], 1e-5);
    }
}

TEST(Parameters, RadianceScaleKeepsTheForwardPeakInHalfPrecision) {
    FrameInputs frame;
    frame.medium.phase_g = 0.9F;
    frame.sun = Sun{.illuminance_lux = glm::vec3(1e5F)};
    const double peak = 1e5 * 1.9 / (4.0 * 3.14159265358979 * 0.1 * 0.1);
    const double scale = static_cast<double>(radiance_scale_for(frame));
    EXPECT_LT(peak * scale, 65504.0);
    EXPECT_GT(peak * scale, 10000.0);
    EXPECT_EQ(std::exp2(std::round(std::log2(scale))), scale);
    frame.sun->illuminance_lux = glm::vec3(100.0F);
    EXPECT_EQ(radiance_scale_for(frame), 1.0F);
}

TEST(Parameters, DimFogAndThinFogKeepTheDigitsOfHalfPrecision) {
    FrameInputs frame;
    frame.medium.homogeneous.extinction_per_m = 1e-8F;
    frame.medium.ambient_radiance = glm::vec3(1e-9F);
    const double scale = static_cast<double>(radiance_scale_for(frame));
    EXPECT_GE(1e-9 * scale, 256.0);
    EXPECT_LE(1e-9 * scale, 512.0);
    frame.medium.ambient_radiance = glm::vec3(0.0F);
    EXPECT_EQ(radiance_scale_for(frame), 1.0F);

    const auto density_scale = [&] {
        return static_cast<double>(volumetric_parameters(frame, std::nullopt).density_scale.x);
    };
    EXPECT_NEAR(1e-8 * density_scale(), 16384.0, 1.0);
    // A volume of no size, however dense, takes nothing from the digits of the fog that is there.
    frame.medium.volumes = {{.half_size_m = {1.0F, 0.0F, 1.0F}, .extinction_per_m = 1e6F}};
    EXPECT_NEAR(1e-8 * density_scale(), 16384.0, 1.0);
    frame.medium.volumes[0].half_size_m.y = 1e-6F;
    EXPECT_NEAR(1e6 * density_scale(), 16384.0, 1.0);
}

TEST(Parameters, RadianceScaleIsThatOfTheLocalLightsToo) {
    FrameInputs frame;
    frame.camera.clip_from_view = perspective(1.0, 0.5625, 0.1, 0.0);
    frame.medium.homogeneous.extinction_per_m = 0.01F;
    frame.lights = {{.position_range = {0.0F, 0.0F, -10.0F, 1e6F}, .direction_radius = {0.0F, -1.0F, 0.0F, 0.02F}}};
    const auto scale_of = [&](float candela, const std::optional<FrameMemory>& before = std::nullopt) {
        frame.lights[0].intensity_type = glm::vec4(glm::vec3(candela), 0.0F);
        return static_cast<double>(radiance_scale_for(frame, before));
    };
    for (const float candela : {1e-6F, 1.0F, 1e9F}) {
        const double at_a_decimetre = static_cast<double>(candela) * 100.0 / (4.0 * 3.14159265358979);
        EXPECT_LE(at_a_decimetre * scale_of(candela), 32768.0);
        EXPECT_GT(at_a_decimetre * scale_of(candela), 8191.0);
    }
    // Out of reach, or far outside of the grid, it says little.
    frame.lights[0].position_range.w = 1e3F;
    frame.lights[0].position_range.z = -2e3F;
    EXPECT_EQ(scale_of(1e9F), 1.0);
    frame.lights[0].position_range = {0.0F, 0.0F, -1e5F, 1e6F};
    EXPECT_GT(scale_of(1e9F), 1.0);
    // A flicker leaves it as it is; a great change does not.
    frame.lights[0].position_range = {0.0F, 0.0F, -10.0F, 1e6F};
    frame.lights[0].intensity_type = glm::vec4(glm::vec3(1e4F), 0.0F);
    const FrameMemory before = memory_of(frame, volumetric_parameters(frame, std::nullopt));
    const double kept = static_cast<double>(before.volume.scale.x);
    EXPECT_EQ(scale_of(5e3F, before), kept);
    EXPECT_NE(scale_of(5e3F), kept);
    EXPECT_LT(scale_of(1e5F, before), kept);
    EXPECT_GT(scale_of(1.0F, before), kept);
}

/// Candles in a ring 0.6 m across.
std::vector<gpu::GpuLight> ring_of_candles(std::size_t count) {
    std::vector<gpu::GpuLight> lights;
    for (std::size_t i = 0; i < count; ++i) {
        const double angle = 6.283185307179586 * static_cast<double>(i) / static_cast<double>(count);
        lights.push_back({.position_range = glm::vec4(0.3 * std::cos(angle), 0.2 + 0.3 * std::sin(angle), -6.0, 30.0),
                          .intensity_type = glm::vec4(glm::vec3(10.0F), 0.0F),
                          .direction_radius = {0.0F, -1.0F, 0.0F, 0.02F}});
    }
    return lights;
}

TEST(Parameters, RadianceScaleIsThatOfLightsTogether) {
    FrameInputs frame;
    frame.camera.clip_from_view = perspective(1.0, 0.5625, 0.1, 0.0);
    frame.medium.homogeneous.extinction_per_m = 0.01F;
    const auto scale_of = [&](std::vector<gpu::GpuLight> lights) {
        frame.lights = std::move(lights);
        return static_cast<double>(radiance_scale_for(frame));
    };
    const double alone = scale_of(ring_of_candles(1));
    // Everywhere a decimetre off the candles.
    frame.lights = ring_of_candles(64);
    double brightest = 0.0;
    for (double x = 0.0; x < 0.8; x += 0.01) {
        for (double y = -0.4; y < 0.8; y += 0.01) {
            double sum = 0.0;
            for (const gpu::GpuLight& light : frame.lights) {
                const double d = glm::distance(glm::dvec3(light.position_range), glm::dvec3(x, y, -6.0));
                sum += 10.0 / std::pow(std::max(d, 0.1), 2.0) / (4.0 * 3.14159265358979);
            }
            brightest = std::max(brightest, sum);
        }
    }
    const double ring = static_cast<double>(radiance_scale_for(frame));
    EXPECT_LE(brightest * ring, 65504.0);
    EXPECT_GE(brightest * ring, 8192.0);
    EXPECT_LT(ring, alone);
    // Lights far from each other are as one, in whatever number.
    std::vector<gpu::GpuLight> scattered;
    for (int i = 0; i < 1000; ++i) {
        scattered.push_back(ring_of_candles(1).front());
        scattered.back().position_range = glm::vec4(20.0F * glm::vec3(i % 10, i / 10 % 10, -(i / 100)), 30.0F);
    }
    EXPECT_EQ(scale_of(scattered), alone);
    // A crowd among them is not.
    for (int i = 0; i < 100; ++i) {
        scattered.push_back(ring_of_candles(1).front());
    }
    EXPECT_LE(scale_of(scattered), alone / 32.0);
}

TEST(Parameters, NoiseStaysPreciseFarFromTheOriginAndLate) {
    FrameInputs frame;
    frame.medium.noise = {.amplitude = 0.5F, .scale_m = 2.0F, .wind_m_s = {1.0F, 0.0F, 0.0F}};
    frame.camera.origin_m = {2.0 * (256.0 * 4e6 + 12.25), 0.0, -2.0 * 3.5};
    frame.time_s = 512.0 * 100.0;
    const glm::vec4 origin = volumetric_parameters(frame, std::nullopt).noise_origin;
    EXPECT_NEAR(origin.x, 12.25F, 1e-5F);
    EXPECT_NEAR(origin.z, 252.5F, 1e-4F);
    EXPECT_EQ(origin.w, 0.5F);
}

} // namespace
} // namespace tyndall::volumetrics
