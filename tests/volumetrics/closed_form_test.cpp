// Fog against its closed forms in double precision, at 160x90x64 froxels, pixel by pixel.
// Tolerance with fp32 storage: 2e-3, radiance relative, transmittance absolute; fp16's own error is printed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double tolerance = 2e-3;
constexpr double sky_m = 1e20; ///< stands for infinity, with which the closed forms would multiply by 0

struct Errors {
    double radiance = 0.0;      ///< largest relative error
    double transmittance = 0.0; ///< largest absolute error
};

/// Red: radiance of a medium of albedo 1 in front of black; blue: transmittance, a medium of albedo 0 in front of
/// white.
void separate_channels(Scene& scene) {
    scene.inputs.medium.homogeneous.albedo = {1.0F, 0.5F, 0.0F};
    scene.inputs.medium.height.albedo = {1.0F, 0.5F, 0.0F};
    scene.color = [](std::uint32_t, std::uint32_t) { return glm::vec4(0.0F, 0.0F, 1.0F, 0.25F); };
}

/// Surfaces at all depths, from 5 cm to beyond the range, and sky in every seventh column.
double varied_depth_m(std::uint32_t x, std::uint32_t y) {
    if (x % 7 == 3) {
        return std::numeric_limits<double>::infinity();
    }
    return 0.05 * std::pow(1600.0, ((x * 37 + y * 101) % 509) / 508.0);
}

template <typename Expected> // (ray, depth_m) -> {radiance of red, transmittance}
Errors compare(const Scene& scene, const Result& result, Expected expected) {
    Errors errors;
    for (std::uint32_t y = 0; y < scene.image.y; ++y) {
        for (std::uint32_t x = 0; x < scene.image.x; ++x) {
            const glm::vec4& found = result.color[y * scene.image.x + x];
            // The depth that the shader can know: device depth has single precision.
            const double seen_m = near_m / static_cast<double>(static_cast<float>(near_m / scene.depth_m(x, y)));
            const auto [radiance, transmittance] = expected(pixel_ray(scene, x, y), std::min(seen_m, sky_m));
            errors.radiance = std::max(errors.radiance, std::abs(static_cast<double>(found.r) - radiance) / radiance);
            errors.transmittance =
                std::max(errors.transmittance, std::abs(static_cast<double>(found.b) - transmittance));
            EXPECT_EQ(found.a, 0.25F) << "fog must leave the target's alpha";
        }
    }
    return errors;
}

void report(const char* what, double parameter, const Errors& fp32, const Errors& fp16) {
    std::printf("%-28s %8g   fp32: L %.1e T %.1e   fp16: L %.1e T %.1e\n", what, parameter, fp32.radiance,
                fp32.transmittance, fp16.radiance, fp16.transmittance);
    EXPECT_LE(fp32.radiance, tolerance) << what << " " << parameter;
    EXPECT_LE(fp32.transmittance, tolerance) << what << " " << parameter;
    EXPECT_LE(fp16.transmittance, 5.0 * tolerance) << what << " " << parameter;
}

class ClosedForm : public FogTest {
protected:
    template <typename Expected>
    void check(const char* what, double parameter, Scene scene, Expected expected) {
        scene.inputs.settings.storage = StorageFormat::fp32;
        const Errors fp32 = compare(scene, render(scene), expected);
        scene.inputs.settings.storage = StorageFormat::fp16;
        const Errors fp16 = compare(scene, render(scene), expected);
        report(what, parameter, fp32, fp16);
    }
};

TEST_F(ClosedForm, HomogeneousSlabFromThinToDense) {
    for (const double optical_depth : {1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0, 1e3}) {
        Scene scene = plain_scene();
        separate_channels(scene);
        scene.depth_m = varied_depth_m;
        const double extinction = optical_depth / 64.0;
        scene.inputs.medium.homogeneous.extinction_per_m = static_cast<float>(extinction);
        scene.inputs.medium.ambient_radiance = {2.0F, 2.0F, 2.0F};
        check("homogeneous, optical depth", optical_depth, scene, [&](const PixelRay& ray, double depth_m) {
            const double tau = extinction * depth_m * ray.stretch;
            return std::pair(-2.0 * std::expm1(-tau), std::exp(-tau));
        });
    }
}

TEST_F(ClosedForm, OrthographicViewAndWideView) {
    Scene scene = plain_scene();
    separate_channels(scene);
    scene.depth_m = varied_depth_m;
    scene.inputs.medium.homogeneous.extinction_per_m = 0.05F;
    scene.inputs.medium.ambient_radiance = glm::vec3(1.0F);
    glm::dmat4 p(1.0); // 0 at the far plane, 64 m
    p[0][0] = 0.05;
    p[1][1] = -0.05;
    p[2][2] = 1.0 / 64.0;
    p[3][2] = 1.0;
    scene.inputs.camera.clip_from_view = p;
    const Result result = render(scene);
    double worst = 0.0;
    for (std::uint32_t i = 0; i < scene.image.x * scene.image.y; ++i) {
        const double d =
            static_cast<double>(static_cast<float>(near_m / scene.depth_m(i % scene.image.x, i / scene.image.x)));
        const double depth_m = d == 0.0 ? std::numeric_limits<double>::infinity() : (1.0 - d) * 64.0; // sky
        const double tau = 0.05 * depth_m;
        worst = std::max(worst, std::abs(static_cast<double>(result.color[i].b) - std::exp(-tau)));
    }
    EXPECT_LE(worst, tolerance);
}

/// Integral of ext e^(-falloff max(0, y - base)) along a ray from height h with slope dy per metre, over s metres.
double height_optical_depth(double h, double dy, double s, double ext, double falloff, double base) {
    const auto above = [&](double a, double length) { // ray wholly above the base, from height a over it
        const double x = falloff * dy * length;
        return ext * std::exp(-falloff * a) * length * (std::abs(x) < 1e-12 ? 1.0 : -std::expm1(-x) / x);
    };
    const double y0 = h - base;
    const double y1 = y0 + dy * s;
    if (y0 >= 0.0 && y1 >= 0.0) {
        return above(y0, s);
    }
    if (y0 <= 0.0 && y1 <= 0.0) {
        return ext * s;
    }
    const double s_cross = -y0 / dy;
    return y0 > 0.0 ? above(y0, s_cross) + ext * (s - s_cross) : ext * s_cross + above(0.0, s - s_cross);
}

TEST_F(ClosedForm, ExponentialHeightFog) {
    for (const double falloff : {0.02, 0.1, 0.2}) {
        Scene scene = plain_scene();
        separate_channels(scene);
        scene.depth_m = varied_depth_m;
        scene.inputs.camera.origin_m = {1e4, 5.0, -1e4};
        const double pitch = 0.2; // downward
        const glm::dmat3 view_to_world(1.0, 0.0, 0.0, 0.0, std::cos(pitch), -std::sin(pitch), 0.0, std::sin(pitch),
                                       std::cos(pitch));
        scene.inputs.camera.view_from_render = glm::dmat4(glm::transpose(view_to_world));
        scene.inputs.medium.height = {.extinction_per_m = 0.05F,
                                      .albedo = {1.0F, 0.5F, 0.0F},
                                      .base_height_m = 1.0F,
                                      .falloff_per_m = static_cast<float>(falloff)};
        scene.inputs.medium.ambient_radiance = glm::vec3(1.5F);
        check("height fog, falloff", falloff, scene, [&](const PixelRay& ray, double depth_m) {
            const double dy = (view_to_world * ray.direction).y;
            const double tau = height_optical_depth(5.0, dy, depth_m * ray.stretch, 0.05, falloff, 1.0);
            return std::pair(-1.5 * std::expm1(-tau), std::exp(-tau));
        });
    }
}

TEST_F(ClosedForm, HeightFogIsTheMeanOverEachSliceAlsoAcrossTheBase) {
    Scene scene = plain_scene();
    scene.inputs.settings.grid = {.width = 16, .height = 9, .slices = 16, .range_m = 64.0F, .shape_m = 16.0F};
    scene.inputs.camera.origin_m = {0.0, 5.0, 0.0};
    scene.inputs.medium.height = {.extinction_per_m = 0.05F, .base_height_m = 1.0F, .falloff_per_m = 3.0F};
    const Result result = render(scene);
    const double scale = static_cast<double>(volumetric_parameters(scene.inputs, std::nullopt).density_scale.y);
    const auto boundary_m = [](double k) { return 16.0 * (std::pow(5.0, k / 16.0) - 1.0); };
    for (std::uint32_t i = 0; i < result.density.size(); ++i) {
        const std::uint32_t slice = i / (16 * 9);
        const double slope = (1.0 - 2.0 * (i / 16 % 9) / 8.0) * tan_y;
        const double near_depth = boundary_m(slice);
        const double length = boundary_m(slice + 1.0) - near_depth;
        const double expected = height_optical_depth(5.0 + slope * near_depth, slope, length, 0.05, 3.0, 1.0) / length;
        ASSERT_NEAR(static_cast<double>(result.density[i].a) * scale, expected, 1e-5 * expected + 1e-8) << i;
    }
}

TEST_F(ClosedForm, CornerRayIsLongerThanCentreRay) {
    Scene scene = plain_scene();
    scene.inputs.medium.homogeneous = {.extinction_per_m = 1e-4F, .albedo = glm::vec3(1.0F)};
    scene.inputs.medium.ambient_radiance = glm::vec3(1.0F);
    scene.depth_m = [](std::uint32_t, std::uint32_t) { return 40.0; };
    const Result result = render(scene);
    const double corner = static_cast<double>(result.color.front().r);
    const double centre = static_cast<double>(result.color[90 * scene.image.x + 160].r);
    const double expected = pixel_ray(scene, 0, 0).stretch / pixel_ray(scene, 160, 90).stretch;
    EXPECT_GT(expected, 1.5);
    EXPECT_NEAR(corner / centre / expected, 1.0, tolerance);
}

TEST_F(ClosedForm, SunIsBrighterTowardTheLight) {
    for (const double g : {-0.5, 0.0, 0.5}) {
        double centre[2] = {};
        for (const double toward : {1.0, -1.0}) {
            Scene scene = plain_scene();
            separate_channels(scene);
            scene.depth_m = varied_depth_m;
            scene.inputs.medium.homogeneous.extinction_per_m = 0.02F;
            scene.inputs.medium.phase_g = static_cast<float>(g);
            const glm::dvec3 travel(0.0, 0.0, toward); // toward the eye, or away with it
            scene.inputs.sun = Sun{.direction = glm::vec3(travel), .illuminance_lux = glm::vec3(100.0F)};
            check(toward > 0.0 ? "sun ahead, g" : "sun behind, g", g, scene, [&](const PixelRay& ray, double depth_m) {
                const double tau = 0.02 * depth_m * ray.stretch;
                const double cosine = glm::dot(travel, -ray.direction);
                const double phase = (1.0 - g * g) / (4.0 * pi * std::pow(1.0 + g * g - 2.0 * g * cosine, 1.5));
                return std::pair(-100.0 * phase * std::expm1(-tau), std::exp(-tau));
            });
            scene.inputs.settings.storage = StorageFormat::fp32;
            centre[toward > 0.0 ? 0 : 1] = static_cast<double>(render(scene).color[90 * scene.image.x + 157].r);
        }
        if (g > 0.0) {
            EXPECT_GT(centre[0], 10.0 * centre[1]);
        } else if (g < 0.0) {
            EXPECT_LT(10.0 * centre[0], centre[1]);
        } else {
            EXPECT_NEAR(centre[0] / centre[1], 1.0, 1e-6);
        }
    }
}

TEST_F(ClosedForm, WhiteFurnaceIsExactlyTheAmbient) {
    for (const float extinction : {1e-4F, 1e-2F, 1.0F, 100.0F}) {
        Scene scene = plain_scene();
        scene.inputs.medium.homogeneous = {.extinction_per_m = extinction, .albedo = glm::vec3(1.0F)};
        scene.inputs.medium.ambient_radiance = glm::vec3(3.0F);
        scene.color = [](std::uint32_t, std::uint32_t) { return glm::vec4(3.0F); };
        scene.depth_m = varied_depth_m;
        for (const glm::vec4& pixel : render(scene).color) {
            EXPECT_NEAR(pixel.r, 3.0F, 2e-5F) << extinction;
        }
    }
}

TEST_F(ClosedForm, RadianceIsBoundedAndTransmittanceFallsAlongEveryRay) {
    for (const float extinction : {1e-3F, 1.0F, 1e4F, 1e6F}) {
        Scene scene = plain_scene();
        scene.inputs.settings.storage = StorageFormat::fp16;
        scene.inputs.medium.homogeneous = {.extinction_per_m = extinction, .albedo = glm::vec3(1.0F)};
        scene.inputs.medium.ambient_radiance = glm::vec3(3.0F);
        const Result result = render(scene);
        const std::size_t layer = 160 * 90;
        for (std::size_t i = 0; i < result.accumulated.size(); ++i) {
            const glm::vec4& v = result.accumulated[i];
            ASSERT_TRUE(std::isfinite(v.r) && std::isfinite(v.a));
            ASSERT_GE(v.r, 0.0F);
            ASSERT_LE(v.r, 3.0F * 1.001F * radiance_scale_for(scene.inputs));
            ASSERT_TRUE(i < layer ? v == glm::vec4(0.0F) : v.a >= result.accumulated[i - layer].a);
        }
    }
}

TEST_F(ClosedForm, EmptyMediumDeclaresNothing) {
    Scene scene = plain_scene();
    scene.color = [](std::uint32_t x, std::uint32_t y) {
        return glm::vec4(1.0F / static_cast<float>(x + 1), -0.0F, 1e-40F, static_cast<float>(y));
    };
    const Result result = render(scene);
    EXPECT_EQ(result.pass_names, (std::vector<std::string>{"upload color", "upload depth", "read color out"}));
    EXPECT_EQ(result.omissions, std::vector<std::string>{"all volumetric passes: the medium is empty"});
}

TEST_F(ClosedForm, ZeroDensityLeavesTheSceneBitIdentical) {
    Scene scene = plain_scene();
    scene.depth_m = [](std::uint32_t x, std::uint32_t y) { return std::min(varied_depth_m(x, y), 1e4); };
    scene.color = [](std::uint32_t x, std::uint32_t y) {
        return glm::vec4(1.0F / static_cast<float>(x + 1), static_cast<float>(y) * 1e7F, 1e-30F * static_cast<float>(x),
                         0.3F);
    };
    // All passes run, and every froxel lies so far above the fog that its density is 0.
    scene.inputs.medium.height = {.extinction_per_m = 1.0F, .base_height_m = -1e6F, .falloff_per_m = 1.0F};
    scene.inputs.medium.ambient_radiance = glm::vec3(5.0F);
    const Result result = render(scene);
    EXPECT_NE(std::find(result.pass_names.begin(), result.pass_names.end(), "fog on opaque"), result.pass_names.end());
    for (std::uint32_t i = 0; i < scene.image.x * scene.image.y; ++i) {
        ASSERT_EQ(result.color[i], scene.color(i % scene.image.x, i / scene.image.x));
    }
}

} // namespace
} // namespace tyndall::volumetrics::test
