// The reference against closed forms, and against plain sums where there is none.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "features/volumetrics/reference/medium.hpp"
#include "features/volumetrics/reference/optical_depth.hpp"
#include "features/volumetrics/reference/render.hpp"

namespace tyndall::volumetrics::reference {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();
const Tolerance fine{1e-10, 0.0};

/// Grey and black where nothing is said: no background, no ambient light.
Scene homogeneous(float extinction_per_m) {
    Scene scene;
    scene.medium.homogeneous.extinction_per_m = extinction_per_m;
    return scene;
}

/// Both triangles of a rectangle.
void add_rectangle(std::vector<Triangle>& triangles, const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v,
                   double albedo = 0.0) {
    triangles.push_back({{corner, corner + u, corner + u + v}, glm::dvec3(albedo), glm::dvec3(0.0)});
    triangles.push_back({{corner, corner + u + v, corner + v}, glm::dvec3(albedo), glm::dvec3(0.0)});
}

/// A plain sum of midpoints, which knows no closed form, no substitution and no breaks.
double midpoints(double begin, double end, int count, const std::function<double(double)>& f) {
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
        sum += f(begin + (end - begin) * (i + 0.5) / count);
    }
    return sum * (end - begin) / count;
}

TEST(Quadrature, IsExactForPolynomialsAndBoundsItsError) {
    for (int degree = 0; degree <= 31;
         ++degree) { // Kronrod's rule of 21 nodes is exact up to 31, Gauss' of 10 up to 19
        const auto power = [degree](double t) { return glm::dvec3(std::pow(t, degree)); };
        const double expected = (std::pow(3.0, degree + 1) - std::pow(-1.0, degree + 1)) / (degree + 1);
        const Estimate found = gauss_kronrod(power, -1.0, 3.0);
        EXPECT_NEAR(found.value.x, expected, 1e-13 * std::pow(3.0, degree + 1)) << degree;
        EXPECT_EQ(found.error.x < 1e-13 * std::pow(3.0, degree + 1), degree <= 19) << degree;
    }
    // A peak 1e-3 wide that no first rule resolves, and a kink.
    const std::array whole{Interval{-1.0, 2.0}};
    const auto peak = [](double t) { return glm::dvec3(1e-3 / (1e-6 + t * t), std::abs(t - 0.3), 0.0); };
    for (const double relative : {1e-2, 1e-5, 1e-9}) {
        const Estimate found = integrate(peak, whole, {relative, 0.0});
        const glm::dvec3 exact(std::atan(1000.0) + std::atan(2000.0), 0.5 * (1.3 * 1.3 + 1.7 * 1.7), 0.0);
        EXPECT_LE(std::abs(found.value.x - exact.x), found.error.x);
        EXPECT_LE(std::abs(found.value.y - exact.y), found.error.y);
        EXPECT_LE(found.error.x, relative * 3.2);
    }
}

/// Against the closed form in homogeneous fog and a sum in height fog; with noise, emission stays a multiple of
/// extinction, so that what is seen is that multiple of what is hidden.
TEST(Reference, Emission) {
    const Ray ray{{0.0, 1.0, 0.0}, glm::normalize(glm::dvec3(1.0, 0.2, -2.0))};
    Scene scene;
    scene.medium.homogeneous.emission_per_m = glm::vec3(3.0F);
    EXPECT_NEAR(airlight(scene, ray, 7.0, fine).value.x, 21.0, 1e-8);
    scene.medium.homogeneous.extinction_per_m = 0.25F;
    EXPECT_NEAR(airlight(scene, ray, 7.0, fine).value.x, 12.0 * -std::expm1(-1.75), 1e-8);
    EXPECT_NEAR(airlight(scene, ray, infinity, fine).value.x, 12.0, 1e-8);
    scene.medium.noise = {.amplitude = 0.8F, .scale_m = 1.5F};
    const double hidden = 1.0 - transmittance(scene, ray, 7.0, {1e-7, 0.0}).value.x;
    EXPECT_NEAR(airlight(scene, ray, 7.0, {1e-7, 0.0}).value.x, 12.0 * hidden, 1e-5);

    scene.medium = {};
    scene.medium.height = {.emission_per_m = glm::vec3(2.0F), .base_height_m = 2.0F, .falloff_per_m = 0.5F};
    const double expected = midpoints(0.0, 60.0, 200000, [&](double t) {
        return 2.0 * std::exp(-0.5 * std::fmax(0.0, 1.0 + ray.direction.y * t - 2.0));
    });
    EXPECT_NEAR(airlight(scene, ray, 60.0, fine).value.x, expected, 1e-6 * expected);
}

/// Against what a plain sum makes of volumes upon height fog, of which the sums of a box and a sphere are known.
TEST(Reference, LocalVolumes) {
    const Ray ray{{0.0, 1.0, 0.0}, {0.0, 0.0, -1.0}};
    Scene scene;
    scene.medium.volumes = {LocalVolume{.center_m = {0.0F, 1.0F, -10.0F},
                                        .half_size_m = {1.0F, 2.0F, 3.0F},
                                        .extinction_per_m = 0.25F,
                                        .emission_per_m = glm::vec3(0.5F)}};
    EXPECT_NEAR(transmittance(scene, ray, 20.0, fine).value.x, std::exp(-1.5), 1e-9);
    EXPECT_NEAR(transmittance(scene, ray, infinity, fine).value.x, std::exp(-1.5), 1e-9);
    EXPECT_NEAR(transmittance(scene, ray, 9.0, fine).value.x, std::exp(-0.5), 1e-9);
    EXPECT_NEAR(airlight(scene, ray, 20.0, fine).value.x, 2.0 * -std::expm1(-1.5), 1e-8);
    LocalVolume& volume = scene.medium.volumes[0];
    volume.shape = VolumeShape::ellipsoid;
    volume.center_m.x = 0.6F; // 0.8 of the half size is left
    EXPECT_NEAR(transmittance(scene, ray, 20.0, fine).value.x, std::exp(-1.2), 1e-7);
    volume.edge = 1.0F; // the mean of 1 - |q| from -0.8 to 0.8 beside the centre by 0.6
    const double soft = 3.0 * midpoints(-0.8, 0.8, 400000, [](double q) { return 1.0 - std::hypot(0.6, q); });
    EXPECT_NEAR(transmittance(scene, ray, 20.0, fine).value.x, std::exp(-0.25 * soft), 1e-7);

    const glm::dvec3 centre{0.0, 1.0, -10.0};
    scene.medium.homogeneous = {.extinction_per_m = 0.1F, .albedo = glm::vec3(0.5F), .emission_per_m = glm::vec3(2.0F)};
    const auto at_centre = [&](VolumeBlend blend, float extinction_per_m) {
        scene.medium.volumes = {LocalVolume{.blend = blend,
                                            .center_m = {0.0F, 1.0F, -10.0F},
                                            .extinction_per_m = extinction_per_m,
                                            .factor = 3.0F,
                                            .albedo = glm::vec3(0.25F),
                                            .emission_per_m = glm::vec3(5.0F)}};
        const Coefficients c = Fog(scene.medium, 0.0).at(centre);
        return glm::dvec3(c.scattering.x, c.extinction.x, c.emission.x);
    };
    const auto expect = [](const glm::dvec3& found, const glm::dvec3& expected) {
        EXPECT_LE(glm::length(found - expected), 1e-6) << found.x << " " << found.y << " " << found.z;
    };
    expect(at_centre(VolumeBlend::add, 0.4F), {0.15, 0.5, 7.0});
    expect(at_centre(VolumeBlend::subtract, 0.04F), {0.03, 0.06, 1.2});
    expect(at_centre(VolumeBlend::subtract, 0.4F), {0.0, 0.0, 0.0});
    expect(at_centre(VolumeBlend::multiply, 0.0F), {0.15, 0.3, 6.0});
    expect(at_centre(VolumeBlend::max, 0.4F), {0.1, 0.4, 5.0});
    expect(at_centre(VolumeBlend::max, 0.04F), {0.05, 0.1, 2.0});
}

TEST(Reference, Slab) {
    for (const float extinction : {1e-8F, 1e-3F, 0.3F, 10.0F, 1e6F}) {
        Scene scene = homogeneous(extinction);
        scene.medium.homogeneous.albedo = {1.0F, 0.5F, 0.25F};
        scene.medium.phase_g = 0.6F;
        scene.medium.ambient_radiance = glm::vec3(2.0F);
        scene.sun = DirectionalLight{glm::normalize(glm::dvec3(1.0, -2.0, 0.5)), glm::dvec3(1000.0)};
        const Ray ray{{3.0, 1.0, 2.0}, glm::normalize(glm::dvec3(0.3, 0.2, -1.0))};
        const double cosine = glm::dot(scene.sun->direction, -ray.direction);
        const double g = 0.6F;
        const double p = (1.0 - g * g) / (4.0 * pi) * std::pow(1.0 + g * g - 2.0 * g * cosine, -1.5);
        for (const double length_m : {0.5, 64.0}) {
            const double source = (1000.0 * p + 2.0) * -std::expm1(-static_cast<double>(extinction) * length_m);
            const Estimate found = airlight(scene, ray, length_m, fine);
            EXPECT_NEAR(found.value.r, source, 1e-9 * source) << extinction;
            EXPECT_NEAR(found.value.b, 0.25 * source, 1e-9 * source) << extinction;
        }
        const double everything = 1000.0 * p + 2.0;
        EXPECT_NEAR(airlight(scene, ray, infinity, fine).value.r, everything, 1e-9 * everything) << extinction;
    }
}

TEST(Reference, WhiteFurnace) {
    for (const float extinction : {1e-6F, 1e-2F, 1.0F, 1e4F}) {
        Scene scene = homogeneous(extinction);
        scene.medium.height = {.extinction_per_m = 3.0F * extinction, .falloff_per_m = 0.2F};
        scene.medium.noise.amplitude = extinction < 1.0F ? 0.7F : 0.0F;
        scene.medium.ambient_radiance = glm::vec3(1.0F);
        scene.surroundings.zenith = scene.surroundings.horizon = scene.surroundings.ground = glm::dvec3(1.0);
        for (const double y : {-0.4, 0.0, 0.01, 0.9}) {
            const Ray ray{{0.1, 2.0, 0.3}, glm::normalize(glm::dvec3(0.3, y, -1.0))};
            scene.geometry = Geometry();
            if (extinction < 1e-3F) { // through what is thin, to a wall that shines
                scene.geometry = Geometry(
                    {{{glm::dvec3(-1e3, -1e3, -40.0), glm::dvec3(3e3, -1e3, -40.0), glm::dvec3(-1e3, 3e3, -40.0)},
                      glm::dvec3(0.0),
                      glm::dvec3(1.0)}});
            }
            const Estimate found = radiance(scene, ray, {1e-8, 0.0});
            EXPECT_NEAR(found.value.r, 1.0, 1e-7) << extinction << " " << y;
        }
    }
}

/// Straight up through fog of optical depth T = sigma / f under a sun at cosine m: with u = e^(-f t) the integral is
/// T e^-T times that of e^(T u (1 - 1 / m)) over u in [0, 1].
TEST(Reference, HeightFogUnderTheSun) {
    for (const float extinction : {0.01F, 1.0F, 6.0F}) {
        Scene scene;
        scene.medium.height = {.extinction_per_m = extinction, .falloff_per_m = 0.5F};
        scene.sun = DirectionalLight{glm::normalize(glm::dvec3(1.0, -1.0, 0.3)), glm::dvec3(100.0)};
        const double depth = static_cast<double>(extinction) / 0.5;
        const double k = depth * (1.0 + 1.0 / scene.sun->direction.y);
        const double expected = 100.0 / (4.0 * pi) * depth * std::exp(-depth) * std::expm1(k) / k;
        const Estimate found = radiance(scene, {{5.0, 0.0, 2.0}, {0.0, 1.0, 0.0}}, fine);
        EXPECT_NEAR(found.value.g, expected, 1e-9 * expected) << extinction;
        EXPECT_GE(found.error.g + 1e-14 * expected, std::abs(found.value.g - expected));
    }
}

TEST(Reference, BoxShadows) {
    // Bars across the view throw slanting shadows: lit where (x - y) mod 1 is above 1/3.
    std::vector<Triangle> bars;
    for (int i = -60; i < 60; ++i) {
        add_rectangle(bars, {i, 10.0, -100.0}, {1.0 / 3.0, 0.0, 0.0}, {0.0, 0.0, 200.0});
    }
    Scene scene = homogeneous(0.05F);
    scene.geometry = Geometry(std::move(bars));
    scene.sun = DirectionalLight{glm::normalize(glm::dvec3(1.0, -1.0, 0.0)), glm::dvec3(1.0)};
    // Along x at height 0: bar i shades x in [i + 10, i + 10 + 1/3].
    const double sigma = 0.05F;
    double expected = 0.0;
    for (int i = 0; i < 20; ++i) {
        expected += std::exp(-sigma * (i + 1.0 / 3.0)) - std::exp(-sigma * (i + 1.0));
    }
    expected /= 4.0 * pi;
    const Estimate found = airlight(scene, {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}, 20.0, fine);
    EXPECT_NEAR(found.value.r, expected, 1e-10 * expected);
}

/// Sun, Ramamoorthi, Narasimhan and Nayar 2005, "A practical analytic single scattering model": without extinction the
/// airlight of a point light at distance h is I / (4 pi h) times the angle under which it sees the ray.
TEST(Reference, PointLightInThinAir) {
    Scene scene = homogeneous(1e-9F);
    for (const double h : {0.05, 1.0, 30.0}) {
        scene.lights = {Light{.position = {7.0, h, 0.0}, .intensity_cd = glm::dvec3(50.0)}};
        const double expected =
            static_cast<double>(1e-9F) * 50.0 / (4.0 * pi * h) * (std::atan(13.0 / h) + std::atan(7.0 / h));
        const Estimate found = airlight(scene, {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}, 20.0, fine);
        EXPECT_NEAR(found.value.r, expected, 1e-7 * expected) << h;
    }
    // Straight through the light, whose radius bounds it: 2 r / r^2 inside, 1 / r - 1 / d on either side.
    scene.lights = {Light{.position = {7.0, 0.0, 0.0}, .intensity_cd = glm::dvec3(50.0), .radius_m = 0.02}};
    const double expected =
        static_cast<double>(1e-9F) * 50.0 / (4.0 * pi) * (2.0 / 0.02 + 2.0 / 0.02 - 1.0 / 7.0 - 1.0 / 13.0);
    EXPECT_NEAR(airlight(scene, {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}, 20.0, fine).value.r, expected, 1e-7 * expected);
}

/// The same paper's integral with extinction, by its own substitution: with A1 = sigma I e^(-T cos g) / (2 pi D sin g)
/// ... F(A1, u) = integral of e^(-A1 tan x) over x in [0, u] (Sun et al., equation 11; isotropic phase).
TEST(Reference, PointLightInFog) {
    for (const double sigma : {0.05, 0.5, 3.0}) {
        Scene scene = homogeneous(static_cast<float>(sigma));
        const auto s = static_cast<double>(static_cast<float>(sigma));
        scene.lights = {Light{.position = {4.0, 1.5, 0.0}, .intensity_cd = glm::dvec3(50.0)}};
        const double distance = std::hypot(4.0, 1.5);
        const double gamma = std::atan2(1.5, 4.0);
        const double to_point = s * distance; // optical thickness between eye and light
        const double a1 = to_point * std::sin(gamma);
        const double a0 =
            s * s * 50.0 * std::exp(-to_point * std::cos(gamma)) / (2.0 * pi * to_point * std::sin(gamma));
        const double far =
            0.25 * pi + 0.5 * std::atan((20.0 - distance * std::cos(gamma)) / (distance * std::sin(gamma)));
        const double expected =
            a0 * midpoints(0.5 * gamma, far, 200000, [&](double x) { return std::exp(-a1 * std::tan(x)); });
        const Estimate found = airlight(scene, {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}, 20.0, fine);
        EXPECT_NEAR(found.value.r, expected, 1e-8 * expected) << sigma;
    }
}

TEST(Reference, SpotLightWithShadowPhaseAndRange) {
    Scene scene = homogeneous(0.08F);
    scene.medium.phase_g = 0.7F;
    scene.lights = {Light{.position = {4.0, 3.0, 0.5},
                          .intensity_cd = glm::dvec3(50.0, 20.0, 0.0),
                          .range_m = 6.0,
                          .cone = Cone{glm::normalize(glm::dvec3(0.3, -1.0, 0.1)), 0.2, 0.7}}};
    std::vector<Triangle> plate;
    add_rectangle(plate, {4.5, 1.5, -1.0}, {0.5, 0.0, 0.0}, {0.0, 0.0, 3.0});
    scene.geometry = Geometry(std::move(plate));
    const Ray ray{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
    const Light& light = scene.lights[0];
    const double expected = midpoints(0.0, 12.0, 4000000, [&](double t) {
        const glm::dvec3 way = glm::dvec3(t, 0.0, 0.0) - light.position;
        const double d = glm::length(way);
        const double at_plate = light.position.x + way.x * 0.5;
        const double z_at_plate = light.position.z + way.z * 0.5;
        const bool shadowed = at_plate > 4.5 && at_plate < 5.0 && z_at_plate > -1.0 && z_at_plate < 2.0;
        const double cosine = glm::dot(way / d, light.cone->direction);
        const double scale = 1.0 / (std::cos(0.2) - std::cos(0.7));
        const double inside = std::clamp(cosine * scale - std::cos(0.7) * scale, 0.0, 1.0);
        const double window = std::max(0.0, 1.0 - std::pow(d / 6.0, 4.0));
        const double g = 0.7F;
        const double p = (1.0 - g * g) / (4.0 * pi) * std::pow(1.0 + g * g + 2.0 * g * way.x / d, -1.5);
        const double sigma = 0.08F;
        return shadowed ? 0.0 : sigma * 50.0 * inside * inside * window * p / (d * d) * std::exp(-sigma * (t + d));
    });
    const Estimate found = airlight(scene, ray, 12.0, fine);
    EXPECT_NEAR(found.value.r, expected, 1e-6 * expected);
    EXPECT_NEAR(found.value.g, 0.4 * expected, 1e-6 * expected);
    EXPECT_EQ(found.value.b, 0.0);
}

TEST(Reference, SurfacesAreLambertianAndSeenThroughTheMedium) {
    Scene scene = homogeneous(0.1F);
    std::vector<Triangle> triangles;
    add_rectangle(triangles, {-50.0, 0.0, -50.0}, {100.0, 0.0, 0.0}, {0.0, 0.0, 100.0}, 0.5);
    add_rectangle(triangles, {-50.0, 4.0, -50.0}, {51.0, 0.0, 0.0}, {0.0, 0.0, 100.0}); // a roof over x < 1
    scene.geometry = Geometry(std::move(triangles));
    scene.medium.homogeneous.albedo = glm::vec3(0.0F);
    scene.surroundings.ambient_up = glm::dvec3(3.0);
    scene.lights = {Light{.position = {2.0, 2.0, 0.0}, .intensity_cd = glm::dvec3(100.0)}};
    scene.sun = DirectionalLight{glm::normalize(glm::dvec3(0.0, -1.0, -1.0)), glm::dvec3(40.0)};
    const double sigma = 0.1F;
    for (const double x : {-3.0, 3.0}) {
        const Ray ray{{x, 3.0, 0.0}, {0.0, -1.0, 0.0}};
        const double d = std::hypot(x - 2.0, 2.0);
        const double from_light = 100.0 / (d * d) * (2.0 / d) * std::exp(-sigma * d);
        const double from_sun = x > 1.0 ? 40.0 * std::sqrt(0.5) : 0.0;
        const double expected = 0.5 / pi * (from_light + from_sun + 3.0 * pi) * std::exp(-sigma * 3.0);
        EXPECT_NEAR(radiance(scene, ray, fine).value.r, expected, 1e-9 * expected);
    }
    scene.attenuates_light = false;
    const double expected = 0.5 / pi * (100.0 / 5.0 * 2.0 / std::sqrt(5.0) + 40.0 * std::sqrt(0.5) + 3.0 * pi);
    EXPECT_NEAR(radiance(scene, {{3.0, 3.0, 0.0}, {0.0, -1.0, 0.0}}, fine).value.r, expected * std::exp(-sigma * 3.0),
                1e-9);
}

TEST(Reference, NoisyFogEqualsTheSum) {
    Scene scene = homogeneous(0.1F);
    scene.medium.height = {.extinction_per_m = 0.3F, .base_height_m = 0.5F, .falloff_per_m = 0.4F};
    scene.medium.noise = {
        .amplitude = 0.9F, .scale_m = 1.7F, .wind_m_s = {1.0F, 0.5F, -0.3F}, .octaves = 2, .gain = 0.6F};
    scene.time_s = 3.0;
    scene.medium.ambient_radiance = glm::vec3(1.0F);
    const Ray ray{{-300.0, 0.2, 4.0}, glm::normalize(glm::dvec3(1.0, 0.2, -0.4))};
    const Fog fog(scene.medium, scene.time_s);
    double tau = 0.0;
    constexpr int count = 2000000;
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
        const double dt = 25.0 / count;
        const double sigma = fog.at(point_at(ray, (i + 0.5) * dt)).extinction.r;
        sum += sigma * std::exp(-(tau + 0.5 * sigma * dt)) * dt;
        tau += sigma * dt;
    }
    const Tolerance tolerance{1e-7, 0.0};
    EXPECT_NEAR(airlight(scene, ray, 25.0, tolerance).value.r, sum, 1e-7 * sum);
    const double passed = transmittance(scene, ray, 25.0, tolerance).value.r;
    EXPECT_NEAR(passed, std::exp(-tau), 1e-7 * passed);
}

TEST(Reference, NoiseMovesWithTheWind) {
    Medium medium;
    medium.homogeneous.extinction_per_m = 1.0F;
    medium.noise = {.amplitude = 0.9F, .scale_m = 1.5F, .wind_m_s = {1.0F, -0.5F, 0.25F}};
    const glm::dvec3 p{3.3, 4.4, 5.5};
    const double here = Fog(medium, 2.0).at(p).extinction.r;
    EXPECT_NE(here, 1.0);
    EXPECT_NEAR(Fog(medium, 6.0).at(p + glm::dvec3(4.0, -2.0, 1.0)).extinction.r, here, 1e-12);
    EXPECT_NE(Fog(medium, 6.0).at(p).extinction.r, here);
}

TEST(Reference, TheWayToTheSky) {
    Medium medium;
    medium.homogeneous.extinction_per_m = 5.0F; // endless: not counted
    medium.height = {.extinction_per_m = 0.7F, .base_height_m = 2.0F, .falloff_per_m = 0.3F};
    const Ray up{{0.0, -1.0, 0.0}, glm::normalize(glm::dvec3(1.0, 0.5, 0.0))};
    const double expected = 0.7F * midpoints(0.0, 300.0, 1000000, [&](double t) {
                                return std::exp(-0.3F * std::fmax(0.0, point_at(up, t).y - 2.0));
                            });
    EXPECT_NEAR(Fog(medium, 0.0).closed_optical_depth_of_sky(up).r, expected, 1e-7 * expected);
    const Ray level{up.origin, {1.0, 0.0, 0.0}};
    EXPECT_EQ(Fog(medium, 0.0).closed_optical_depth_of_sky(level).r, 0.0);
    // Noise leaves the mean over a far way as it is.
    medium.noise = {.amplitude = 0.9F, .scale_m = 0.3F};
    double sum = 0.0;
    for (int i = 0; i < 40; ++i) {
        const Ray ray{up.origin + glm::dvec3(i * 7.0, 0.0, i * 3.0), up.direction};
        sum += optical_depth_of_sky(Fog(medium, 0.0), ray, 1e-6).value.r / 40.0;
    }
    EXPECT_NEAR(sum, expected, 0.02 * expected);
}

TEST(Reference, Background) {
    const Surroundings around{.zenith = glm::dvec3(8.0), .horizon = glm::dvec3(1.0), .ground = glm::dvec3(3.0)};
    EXPECT_EQ(background_radiance(around, {0.0, 1.0, 0.0}).r, 8.0);
    EXPECT_EQ(background_radiance(around, {1.0, 0.0, 0.0}).r, 1.0);
    EXPECT_NEAR(background_radiance(around, {0.0, 0.5, 0.0}).r, 1.0 + 7.0 * 0.875, 1e-12);
    EXPECT_NEAR(background_radiance(around, {0.0, -1.0 / 16.0, 0.0}).r, 2.0, 1e-12);
    EXPECT_EQ(background_radiance(around, {0.0, -1.0, 0.0}).r, 3.0);
}

/// Every kind of source, through media with and without closed form: the error that is claimed bounds the true one.
TEST(Reference, ClaimsNoSmallerErrorThanItHas) {
    std::size_t loose = 0;
    std::size_t cases = 0;
    double tightest = 0.0;
    for (const float amplitude : {0.0F, 0.8F}) {
        Scene scene = homogeneous(0.05F);
        scene.medium.height = {.extinction_per_m = 0.4F, .falloff_per_m = 0.6F};
        scene.medium.noise = {.amplitude = amplitude, .scale_m = 2.0F};
        scene.medium.phase_g = 0.8F;
        scene.medium.ambient_radiance = glm::vec3(0.1F);
        scene.sun = DirectionalLight{glm::normalize(glm::dvec3(0.4, -1.0, 0.3)), glm::dvec3(20.0)};
        scene.lights = {Light{.position = {1.0, 2.0, -6.0}, .intensity_cd = glm::dvec3(90.0), .range_m = 8.0},
                        Light{.position = {-2.0, 3.0, -9.0},
                              .intensity_cd = glm::dvec3(200.0),
                              .range_m = 9.0,
                              .cone = Cone{glm::normalize(glm::dvec3(0.2, -1.0, 0.1)), 0.2, 0.6}}};
        std::vector<Triangle> bars;
        for (int i = -10; i < 10; ++i) {
            add_rectangle(bars, {i, 1.0, -20.0}, {0.4, 0.0, 0.0}, {0.0, 0.2, 30.0}, 0.4);
        }
        add_rectangle(bars, {-50.0, -50.0, -12.0}, {100.0, 0.0, 0.0}, {0.0, 100.0, 0.0}, 0.4);
        scene.geometry = Geometry(std::move(bars));
        const Camera camera{.world_from_camera = glm::dmat4(1.0), .fov_y_rad = 1.2};
        const ImageSize size{amplitude > 0.0F ? 4U : 16U, amplitude > 0.0F ? 3U : 9U};
        const std::vector<Pixel> pixels = all_pixels(size);
        const std::vector<Estimate> exact = render(scene, camera, size, pixels, {1e-9, 0.0});
        for (const double relative : {1e-2, 1e-4, 1e-6}) {
            const std::vector<Estimate> found = render(scene, camera, size, pixels, {relative, 0.0});
            for (std::size_t i = 0; i < pixels.size(); ++i) {
                const double error = std::abs(found[i].value.r - exact[i].value.r);
                EXPECT_LE(error, found[i].error.r + 2e-9 * exact[i].value.r) << relative << " " << i;
                EXPECT_LE(found[i].error.r, 1.01 * relative * exact[i].value.r) << relative << " " << i;
                tightest = std::max(tightest, found[i].error.r > 0.0 ? error / found[i].error.r : 0.0);
                loose += error < 0.1 * found[i].error.r ? 1 : 0;
                ++cases;
            }
        }
    }
    std::printf("true error / claimed error: at most %.2g; below a tenth in %zu of %zu pixels\n", tightest, loose,
                cases);
}

TEST(Reference, ChoosesPixelsBySeed) {
    const ImageSize size{20, 10};
    const auto key = [](const Pixel& p) { return p.y * 20 + p.x; };
    const std::vector<Pixel> a = random_pixels(size, 50, 7);
    const std::vector<Pixel> b = random_pixels(size, 50, 7);
    const std::vector<Pixel> c = random_pixels(size, 50, 8);
    ASSERT_EQ(a.size(), 50U);
    EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), [&](auto& p, auto& q) { return key(p) == key(q); }));
    EXPECT_FALSE(std::equal(a.begin(), a.end(), c.begin(), [&](auto& p, auto& q) { return key(p) == key(q); }));
    for (std::size_t i = 1; i < a.size(); ++i) {
        EXPECT_LT(key(a[i - 1]), key(a[i]));
    }
    EXPECT_EQ(random_pixels(size, 1000, 7).size(), 200U);
}

} // namespace
} // namespace tyndall::volumetrics::reference
