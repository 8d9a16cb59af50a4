// What integrators and visibility methods leave out, in double precision: one slice of a constant medium, and shafts of
// light over 64 slices against the reference.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>

#include <glm/geometric.hpp>
#include <glm/gtc/packing.hpp>
#include <gtest/gtest.h>

#include "features/volumetrics/reference/render.hpp"
#include "samples/precision/integrator_twin.hpp"

namespace tyndall::volumetrics::test {
namespace {

using samples::integrate;
using samples::TwinSlice;

TEST(SliceFigures, OneSliceOfAConstantMedium) {
    struct Row {
        double x;
        double euler;
        double half_slice;
    };
    // Of the exact radiance: x / (1 - e^-x), and e^(-x / 2) times that.
    for (const auto& [x, euler, half_slice] :
         {Row{0.001, 1.0005, 1.0000}, Row{1.0, 1.58, 0.96}, Row{8.0, 8.0, 0.15}, Row{100.0, 100.0, 0.0}}) {
        const std::vector<TwinSlice> slice{{x, x, 1.0}};
        const double exact = -std::expm1(-x);
        EXPECT_NEAR(integrate(Integrator::euler, slice).radiance / exact, euler, 0.004 * euler) << x;
        EXPECT_NEAR(integrate(Integrator::half_slice, slice).radiance / exact, half_slice, 0.005) << x;
        EXPECT_NEAR(integrate(Integrator::exponential, slice).radiance / exact, 1.0, 1e-14) << x;
    }
}

TEST(SliceFigures, WhatSinglePrecisionLeavesOfThinAir) {
    // (1 - T) / sigma over a slice of 0.25 m, where the exact value is all but 0.25 m.
    const auto weight = [](float sigma) { return (1.0F - std::exp(-sigma * 0.25F)) / sigma; };
    EXPECT_NEAR(weight(1e-6F) / 0.25F, 0.95F, 0.01F);
    EXPECT_EQ(weight(1e-7F), 0.0F);
}

TEST(SliceFigures, WhatHalfPrecisionLeavesOfTransmittance) {
    const auto stored = [](double depth) {
        return glm::unpackHalf1x16(glm::packHalf1x16(static_cast<float>(std::exp(-depth))));
    };
    EXPECT_EQ(stored(2.4e-4), 1.0F);
    EXPECT_LT(stored(2.5e-4), 1.0F);
}

TEST(SliceFigures, WhatLinearInterpolationLosesAtMidSlice) {
    const auto radiance = [](double x) { return 0.5 * -std::expm1(-x) / -std::expm1(-0.5 * x); };
    EXPECT_NEAR(1.0 - radiance(1.0), 0.20, 0.005);
    EXPECT_NEAR(1.0 - radiance(4.0), 0.43, 0.005);
    EXPECT_NEAR(0.5 * (1.0 + std::exp(-1.0)) / std::exp(-0.5), 1.13, 0.005);
}

TEST(SliceFigures, ASampleBesideALightIsSeveralTimesTooBright) {
    // 5 cm from the middle of a slice of 1 m: 1 / h^2 to the mean of 1 / d^2.
    constexpr double h = 0.05;
    const auto mean = [&](double a, double b) { return (std::atan(b / h) - std::atan(a / h)) / h; };
    EXPECT_NEAR(1.0 / (h * h) / mean(-0.5, 0.5), 6.8, 0.05);
    // From the slice's middle to its boundary the light's distance from the sample grows.
    EXPECT_GT(1.0 / (h * h) / (1.0 / (h * h + 0.5 * 0.5)), 40.0);
}

TEST(SliceFigures, ACornerRaysLengthByItsDepth) {
    const double corner = std::sqrt(1.0 + 1.0 + 0.5625 * 0.5625); // 16:9, 90 degrees across
    EXPECT_NEAR(1.0 - 1.0 / corner, 0.34, 0.005);
}

TEST(SliceFigures, HenyeyGreensteinByTheBookInSinglePrecision) {
    // g = 0.999: its integral over the sphere, the denominator as 1 + g^2 - 2 g cos, the angle in single precision.
    const auto integral = [](auto g) {
        using Real = decltype(g);
        double sum = 0.0;
        constexpr int count = 2000000;
        for (int i = 0; i < count; ++i) {
            // Equal steps of ln(2e-8 + theta), where the peak is narrow.
            const auto theta_at = [](double k) { return 1e-8 * (std::pow(3.14159265358979 / 1e-8, k / count) - 1.0); };
            const double theta = theta_at(i + 0.5);
            const double step = theta_at(i + 1.0) - theta_at(i);
            const Real cosine = std::cos(static_cast<Real>(theta));
            const Real spread = Real(1) + g * g - Real(2) * g * cosine;
            const Real phase = (Real(1) - g * g) / (Real(2) * spread * std::sqrt(spread));
            sum += static_cast<double>(phase) * std::sin(theta) * step;
        }
        return sum;
    };
    EXPECT_NEAR(integral(0.999), 1.0, 1e-4);
    // Percents off; on which side depends on the compiler's order of operations (0.965 by g++, 1.024 by clang).
    const double off = std::abs(integral(0.999F) - 1.0);
    std::printf("Henyey-Greenstein in single precision: off by %.3f\n", off);
    EXPECT_GT(off, 0.015);
    EXPECT_LT(off, 0.06);
}

/// Extinction per m of the smooth medium, times `density`, and radiance per optical depth, at t in [0, 1] m.
double smooth_extinction(double density, double t) {
    return density * 2.0 * (1.0 + 0.8 * std::sin(7.0 * t));
}
double smooth_source(double t) {
    return 1.0 + 0.5 * std::cos(5.0 * t);
}

/// Integrals from 0 to x of u^n e^-u, n = 0, 1, 2, by their series.
std::array<double, 3> exponential_moments(double x) {
    std::array<double, 3> moments{};
    for (std::size_t n = 0; n < moments.size(); ++n) {
        const auto power = static_cast<double>(n + 1);
        double term = std::pow(x, power);
        for (int k = 0; k < 60; ++k) {
            moments[n] += term / (power + k);
            term *= -x / (k + 1);
        }
    }
    return moments;
}

/// The radiance of `count` equal slices of the smooth medium, each with a source that is a parabola in optical depth
/// through its two ends and its middle; optical depth by Simpson's rule, and to the middle by the same parabola.
double quadratic_in_optical_depth(double density, int count) {
    double radiance = 0.0;
    double transmittance = 1.0;
    const double d = 1.0 / count;
    for (int i = 0; i < count; ++i) {
        const std::array t{i * d, (i + 0.5) * d, (i + 1.0) * d};
        std::array<double, 3> extinction{};
        std::array<double, 3> source{};
        for (std::size_t n = 0; n < t.size(); ++n) {
            extinction[n] = smooth_extinction(density, t[n]);
            source[n] = smooth_source(t[n]);
        }
        const double x = d / 6.0 * (extinction[0] + 4.0 * extinction[1] + extinction[2]);
        const double middle = d / 24.0 * (5.0 * extinction[0] + 8.0 * extinction[1] - extinction[2]);
        const double first = (source[1] - source[0]) / middle; // Newton's divided differences
        const double second = ((source[2] - source[0]) / x - first) / (x - middle);
        const std::array<double, 3> moments = exponential_moments(x);
        radiance +=
            transmittance * (source[0] * moments[0] + (first - second * middle) * moments[1] + second * moments[2]);
        transmittance *= std::exp(-x);
    }
    return radiance;
}

TEST(SliceFigures, SmoothMediumOver64Slices) {
    struct Row {
        double density;
        double euler;
        double half_slice;
        double exponential;
        double quadratic;
    };
    for (const Row& row : {Row{1.0, 2.3e-2, 9.8e-5, 6.4e-6, 1.0e-10}, Row{20.0, 0.39, 2.1e-2, 8.7e-5, 3.5e-7}}) {
        constexpr int count = 64;
        std::vector<TwinSlice> slices;
        for (int i = 0; i < count; ++i) {
            const double t = (i + 0.5) / count;
            const double extinction = smooth_extinction(row.density, t);
            slices.push_back({extinction, extinction * smooth_source(t), 1.0 / count});
        }
        const double exact = quadratic_in_optical_depth(row.density, 256 * count);
        const auto expect = [&](const char* scheme, double found, double figure) {
            const double error = std::abs(found / exact - 1.0);
            std::printf("density %2g, %-22s %.2e\n", row.density, scheme, error);
            EXPECT_NEAR(error, figure, 0.03 * figure) << scheme;
        };
        expect("euler", integrate(Integrator::euler, slices).radiance, row.euler);
        expect("half slice", integrate(Integrator::half_slice, slices).radiance, row.half_slice);
        expect("exponential", integrate(Integrator::exponential, slices).radiance, row.exponential);
        expect("quadratic, ends and middle", quadratic_in_optical_depth(row.density, count), row.quadratic);
    }
}

/// A roof of slats 0.3 to 1.7 m wide, as far apart, 10 m above; a slanting sun.
reference::Geometry slats() {
    std::mt19937 random(9);
    std::uniform_real_distribution<double> width(0.3, 1.7);
    std::vector<reference::Triangle> triangles;
    for (double x = -120.0; x < 120.0;) {
        const double end = x + width(random);
        const glm::dvec3 a(x, 10.0, -120.0);
        const glm::dvec3 b(end, 10.0, 120.0);
        triangles.push_back({{a, {b.x, 10.0, a.z}, b}, glm::dvec3(0.0), glm::dvec3(0.0)});
        triangles.push_back({{a, b, {a.x, 10.0, b.z}}, glm::dvec3(0.0), glm::dvec3(0.0)});
        x = end + width(random);
    }
    return reference::Geometry(std::move(triangles));
}

TEST(SliceFigures, ShaftsOver64Slices) {
    reference::Scene scene;
    scene.medium.homogeneous.extinction_per_m = 0.02F;
    scene.geometry = slats();
    scene.sun = reference::DirectionalLight{glm::normalize(glm::dvec3(0.5, -1.0, 0.25)), glm::dvec3(1.0)};
    const glm::dvec3 to_sun = -scene.sun->direction;
    const double scattered = static_cast<double>(0.02F) / (4.0 * 3.14159265358979323846);

    constexpr double range_m = 64.0;
    constexpr double shape_m = 16.0;
    constexpr int count = 64;
    constexpr std::array methods{"one tap", "8 taps", "lit fraction"};
    std::array<double, 3> errors{};
    double total = 0.0;
    const reference::Camera camera{.world_from_camera = glm::dmat4(1.0), .fov_y_rad = 1.0};
    const reference::ImageSize size{160, 90};
    for (const reference::Pixel& pixel : reference::random_pixels(size, 1500, 3)) {
        const reference::Ray ray = reference::pixel_ray(camera, size, pixel);
        const double stretch = -1.0 / ray.direction.z;
        const std::vector<reference::Interval> lit =
            scene.geometry.lit_from_direction(ray, {0.0, range_m * stretch}, to_sun);
        const auto lit_part = [&](double begin, double end) {
            double sum = 0.0;
            for (const reference::Interval& part : lit) {
                sum += std::max(0.0, std::min(end, part.end) - std::max(begin, part.begin));
            }
            return sum / (end - begin);
        };
        const auto taps = [&](double begin, double end, int n) {
            double sum = 0.0;
            for (int i = 0; i < n; ++i) {
                const double t = begin + (end - begin) * (i + 0.5) / n;
                sum += lit_part(t - 1e-9, t + 1e-9) > 0.5 ? 1.0 : 0.0;
            }
            return sum / n;
        };
        std::array<std::vector<TwinSlice>, 3> columns;
        const auto boundary_m = [&](int k) {
            return stretch * shape_m * (std::pow(1.0 + range_m / shape_m, static_cast<double>(k) / count) - 1.0);
        };
        for (int k = 0; k < count; ++k) {
            const double begin = boundary_m(k);
            const double end = boundary_m(k + 1);
            const std::array visible{taps(begin, end, 1), taps(begin, end, 8), lit_part(begin, end)};
            for (std::size_t i = 0; i < methods.size(); ++i) {
                columns[i].push_back({static_cast<double>(0.02F), scattered * visible[i], end - begin});
            }
        }
        const double exact = reference::airlight(scene, ray, range_m * stretch, {1e-9, 0.0}).value.r;
        total += exact * exact;
        for (std::size_t i = 0; i < methods.size(); ++i) {
            const double found = integrate(Integrator::exponential, columns[i]).radiance;
            errors[i] += (found - exact) * (found - exact);
        }
    }
    for (std::size_t i = 0; i < methods.size(); ++i) {
        errors[i] = std::sqrt(errors[i] / total);
        std::printf("shafts, 64 slices, %-12s relative L2 %.2e\n", methods[i], errors[i]);
    }
    EXPECT_NEAR(errors[0], 5.4e-2, 2e-2);
    EXPECT_NEAR(errors[1], 7.6e-3, 3e-3);
    EXPECT_LE(errors[2], 2.2e-3);
}

} // namespace
} // namespace tyndall::volumetrics::test
