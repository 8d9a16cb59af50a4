// The parts of rays that are lit, computed from edges, against Embree's answer at single points; the noise's
// definition.
#include <cmath>
#include <cstdio>
#include <limits>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "features/volumetrics/reference/geometry.hpp"
#include "features/volumetrics/reference/noise.hpp"
#include "tests/random_geometry.hpp"

namespace tyndall::volumetrics::reference {
namespace {

std::vector<Triangle> soup(test::RandomGeometry& random, int count, double size) {
    std::vector<Triangle> triangles;
    for (int i = 0; i < count; ++i) {
        const glm::dvec3 p = random.point(10.0);
        triangles.push_back({{p, p + random.point(size), p + random.point(size)}, glm::dvec3(0.0), glm::dvec3(0.0)});
    }
    return triangles;
}

bool is_in(const std::vector<Interval>& parts, double t) {
    for (const Interval& part : parts) {
        if (t >= part.begin && t <= part.end) {
            return true;
        }
    }
    return false;
}

double distance_to_end(const std::vector<Interval>& parts, double t) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Interval& part : parts) {
        nearest = std::min({nearest, std::abs(t - part.begin), std::abs(t - part.end)});
    }
    return nearest;
}

TEST(ReferenceGeometry, LitPartsAreWhatEmbreeSees) {
    test::RandomGeometry random(5);
    for (const int count : {1, 30, 400}) {
        const Geometry geometry(soup(random, count, 40.0 / count + 2.0));
        int lit = 0;
        int blocked = 0;
        for (int i = 0; i < 300; ++i) {
            const Ray ray{random.point(12.0), random.direction()};
            const glm::dvec3 sun = random.direction();
            const glm::dvec3 light = random.point(12.0);
            const Interval part{0.0, 20.0};
            const std::vector<Interval> by_sun = geometry.lit_from_direction(ray, part, sun);
            const std::vector<Interval> by_light = geometry.lit_from_point(ray, part, light);
            for (int k = 0; k < 20; ++k) {
                const double t = random.in(0.0, 20.0);
                const glm::dvec3 p = point_at(ray, t);
                if (distance_to_end(by_sun, t) > 1e-4) { // beyond single precision's doubt
                    const bool seen = !geometry.is_blocked({p, sun}, std::numeric_limits<double>::infinity());
                    EXPECT_EQ(is_in(by_sun, t), seen) << count << " sun " << i << " at " << t;
                    ++(seen ? lit : blocked);
                }
                const glm::dvec3 way = light - p;
                const double distance_m = glm::length(way);
                if (distance_to_end(by_light, t) > 1e-3) {
                    const bool seen = !geometry.is_blocked({p, way / distance_m}, distance_m);
                    EXPECT_EQ(is_in(by_light, t), seen) << count << " light " << i << " at " << t;
                    ++(seen ? lit : blocked);
                }
            }
        }
        std::printf("%d triangles: %d points lit, %d not\n", count, lit, blocked);
        EXPECT_GT(lit, 500);
        EXPECT_GT(blocked, 100);
    }
}

TEST(ReferenceGeometry, NeighboursLeaveNoGap) {
    // A bent sheet of many triangles hides the sun: no part between them may be lit.
    std::vector<Triangle> sheet;
    const auto corner = [](int i, int k) {
        return glm::dvec3(0.37 * i, 3.0 + 0.3 * std::sin(1.7 * i + 0.9 * k), 0.41 * k);
    };
    for (int i = -20; i < 20; ++i) {
        for (int k = -20; k < 20; ++k) {
            sheet.push_back({{corner(i, k), corner(i + 1, k), corner(i, k + 1)}, glm::dvec3(0.0), glm::dvec3(0.0)});
            sheet.push_back(
                {{corner(i + 1, k), corner(i + 1, k + 1), corner(i, k + 1)}, glm::dvec3(0.0), glm::dvec3(0.0)});
        }
    }
    const Geometry geometry(std::move(sheet));
    test::RandomGeometry random(5);
    for (int i = 0; i < 200; ++i) {
        const Ray ray{{random.in(-1.0, 1.0), random.in(0.0, 1.0), random.in(-1.0, 1.0)},
                      glm::normalize(glm::dvec3(random.in(0.5, 1.0), 0.1, random.in(-1.0, 1.0)))};
        EXPECT_TRUE(geometry.lit_from_direction(ray, {0.0, 3.0}, glm::normalize(glm::dvec3(0.2, 1.0, 0.1))).empty());
        EXPECT_TRUE(geometry.lit_from_point(ray, {0.0, 3.0}, {0.3, 8.0, 0.2}).empty());
    }
}

TEST(ReferenceGeometry, RaysThroughTheLight) {
    const Geometry geometry({{{glm::dvec3(-1.0, -1.0, -5.0), glm::dvec3(3.0, -1.0, -5.0), glm::dvec3(-1.0, 3.0, -5.0)},
                              glm::dvec3(0.0),
                              glm::dvec3(0.0)}});
    const Ray ray{{0.0, 0.0, 0.0}, {0.0, 0.0, -1.0}};
    const Interval part{0.0, 5.0};
    EXPECT_EQ(geometry.lit_from_point(ray, part, {0.0, 0.0, -2.0}).size(), 1U);
    EXPECT_EQ(geometry.lit_from_point(ray, part, {0.0, 0.0, -7.0}).size(), 0U);
    EXPECT_EQ(geometry.lit_from_point(ray, part, {0.0, 0.0, 7.0}).size(), 1U);
    EXPECT_EQ(geometry.lit_from_direction(ray, part, {0.0, 0.0, -1.0}).size(), 0U);
    EXPECT_EQ(geometry.lit_from_direction(ray, part, {0.0, 0.0, 1.0}).size(), 1U);
    EXPECT_NEAR(geometry.hit(ray)->distance_m, 5.0, 1e-15);
    EXPECT_EQ(geometry.hit(ray)->normal, glm::dvec3(0.0, 0.0, 1.0));
    EXPECT_FALSE(geometry.hit({ray.origin, -ray.direction}).has_value());
}

TEST(ReferenceNoise, IsSmoothPeriodicAndNothingAtLatticePoints) {
    test::RandomGeometry random(5);
    double sum = 0.0;
    double squares = 0.0;
    constexpr int count = 20000;
    for (int i = 0; i < count; ++i) {
        const glm::dvec3 p = random.point(500.0);
        const double value = gradient_noise(p);
        EXPECT_LE(std::abs(value), 1.0);
        EXPECT_NEAR(gradient_noise(p + glm::dvec3(256.0, -512.0, 0.0)), value, 1e-10);
        EXPECT_EQ(gradient_noise(glm::floor(p)), 0.0);
        // Across a lattice plane value and slope go on.
        const glm::dvec3 plane(std::floor(p.x), p.y, p.z);
        const glm::dvec3 step(1e-5, 0.0, 0.0);
        const double here = gradient_noise(plane);
        EXPECT_NEAR(gradient_noise(plane + step) - here, here - gradient_noise(plane - step), 1e-9);
        sum += value;
        squares += value * value;
    }
    EXPECT_NEAR(sum / count, 0.0, 0.01);
    EXPECT_GT(squares / count, 0.01);
}

/// Across the seam of the tile differences are those of the inside, whose like is a tile away.
TEST(ReferenceNoise, OctavesAreTheirWeightedMeanAndTile) {
    const glm::dvec3 p{12.3, 200.7, 99.1};
    const glm::dvec3 second = 2.0 * p + glm::dvec3(17.375, 5.625, 11.125);
    EXPECT_EQ(octave_noise(p, 1, 0.5), gradient_noise(p));
    EXPECT_NEAR(octave_noise(p, 2, 0.25), (gradient_noise(p) + 0.25 * gradient_noise(second)) / 1.25, 1e-15);
    for (int i = 0; i < 100; ++i) {
        const glm::dvec3 below(256.0 - 1e-3, 2.37 * i, 1.61 * i);
        const glm::dvec3 above(1e-3, 2.37 * i, 1.61 * i);
        const glm::dvec3 inside = below + glm::dvec3(2e-3, 0.0, 0.0);
        EXPECT_NEAR(octave_noise(above, 5, 0.6), octave_noise(inside, 5, 0.6), 1e-10);
        EXPECT_LE(std::abs(octave_noise(above, 5, 0.6) - octave_noise(below, 5, 0.6)), 0.05);
    }
}

} // namespace
} // namespace tyndall::volumetrics::reference
