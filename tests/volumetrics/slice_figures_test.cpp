// What integrators and visibility methods leave out, in double precision: one slice of a constant medium, and shafts of
// light over 64 slices against the reference.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "features/volumetrics/reference/render.hpp"
#include "tests/volumetrics/integrator_twin.hpp"

namespace tyndall::volumetrics::test {
namespace {

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
