// What simpler treatments of light in fog cost, in double precision: the reasons why lamps near the view are evaluated
// per pixel, why light loses on its own way, and why that way is followed beyond the view.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "features/volumetrics/reference/medium.hpp"
#include "features/volumetrics/reference/render.hpp"

namespace tyndall::volumetrics::test {
namespace {

constexpr double pi = 3.14159265358979323846;

/// Airlight of one unshadowed lamp in grey homogeneous fog on the way to `end_m`: the chord of its sphere, where the
/// light no longer grows, and both sides of it by angle as seen from the lamp, where the inverse square is even.
double lamp_airlight(const reference::Light& lamp, double extinction_per_m, const reference::Ray& ray, double end_m) {
    constexpr int nodes = 48;
    const glm::dvec3 to_lamp = lamp.position - ray.origin;
    const double nearest_m = glm::dot(to_lamp, ray.direction);
    const double off_m = std::sqrt(std::max(glm::dot(to_lamp, to_lamp) - nearest_m * nearest_m, 1e-12));
    const double half_chord_m = std::sqrt(std::max(lamp.radius_m * lamp.radius_m - off_m * off_m, 0.0));
    double sum = 2.0 * half_chord_m / (lamp.radius_m * lamp.radius_m) * std::exp(-extinction_per_m * nearest_m);
    const auto side = [&](double begin_m, double end_of_side_m) {
        const double from = std::atan((begin_m - nearest_m) / off_m);
        const double step = (std::atan((end_of_side_m - nearest_m) / off_m) - from) / nodes;
        for (int i = 0; i < nodes; ++i) {
            const double along_m = off_m * std::tan(from + (i + 0.5) * step);
            sum += std::exp(-extinction_per_m * (nearest_m + along_m + std::hypot(off_m, along_m))) * step / off_m;
        }
    };
    side(0.0, nearest_m - half_chord_m);
    side(nearest_m + half_chord_m, end_m);
    return sum * extinction_per_m * lamp.intensity_cd.r / (4.0 * pi);
}

/// Relative L2 error of an image that is exact at every `every`-th pixel and bilinear between them.
double error_of_every(const std::vector<double>& exact, reference::ImageSize size, std::uint32_t every) {
    const auto at = [&](std::uint32_t x, std::uint32_t y) { return exact[y * size.width + x]; };
    const std::uint32_t first = every / 2;
    // The sample before a pixel, and how far the pixel is behind it; the image ends with its last samples.
    const auto place = [&](std::uint32_t pixel, std::uint32_t count) {
        const std::uint32_t last = first + (count - 1 - first) / every * every;
        const double clamped = std::clamp<double>(pixel, first, last);
        const auto before =
            std::min(first + static_cast<std::uint32_t>((clamped - first) / every) * every, last - every);
        return std::pair(before, (clamped - before) / every);
    };
    double squares = 0.0;
    double total = 0.0;
    for (std::uint32_t y = 0; y < size.height; ++y) {
        const auto [y0, fy] = place(y, size.height);
        for (std::uint32_t x = 0; x < size.width; ++x) {
            const auto [x0, fx] = place(x, size.width);
            const double above = at(x0, y0) * (1.0 - fx) + at(x0 + every, y0) * fx;
            const double below = at(x0, y0 + every) * (1.0 - fx) + at(x0 + every, y0 + every) * fx;
            const double difference = above * (1.0 - fy) + below * fy - at(x, y);
            squares += difference * difference;
            total += at(x, y) * at(x, y);
        }
    }
    return std::sqrt(squares / total);
}

TEST(LightFigures, NoGridHoldsALampInItsFog) {
    // 5 cm wide, 15 m before the eye, 320x180 pixels.
    constexpr double extinction_per_m = 0.02;
    constexpr double end_m = 40.0;
    const reference::Light lamp{
        .position = {0.1, 0.05, -15.0}, .intensity_cd = glm::dvec3(1.0), .radius_m = 0.05, .casts_shadows = false};
    const reference::Camera camera{.fov_y_rad = 60.0 * pi / 180.0};
    const reference::ImageSize size{320, 180};
    std::vector<double> exact;
    for (const reference::Pixel& pixel : reference::all_pixels(size)) {
        exact.push_back(lamp_airlight(lamp, extinction_per_m, reference::pixel_ray(camera, size, pixel), end_m));
    }
    reference::Scene scene;
    scene.medium.homogeneous.extinction_per_m = static_cast<float>(extinction_per_m);
    scene.lights = {lamp};
    for (const reference::Pixel& pixel : reference::random_pixels(size, 20, 4)) {
        const double expected =
            reference::airlight(scene, reference::pixel_ray(camera, size, pixel), end_m, {1e-7, 0.0}).value.r;
        EXPECT_NEAR(exact[pixel.y * size.width + pixel.x], expected, 1e-4 * expected);
    }
    const double every_4th = error_of_every(exact, size, 4);
    const double every_10th = error_of_every(exact, size, 10);
    std::printf("a lamp in fog, exact at every 4th pixel: %.0f %%, at every 10th: %.0f %%\n", 100.0 * every_4th,
                100.0 * every_10th);
    EXPECT_NEAR(every_4th, 0.37, 0.08); // with the lamp's place between pixels
    EXPECT_NEAR(every_10th, 0.60, 0.05);
}

constexpr double view_fov_y_rad = 1.0;

/// Some of the rays of a view along -Z, 16:9.
std::vector<reference::Ray> view_rays() {
    const reference::Camera camera{.world_from_camera = glm::dmat4(1.0), .fov_y_rad = view_fov_y_rad};
    const reference::ImageSize size{64, 36};
    std::vector<reference::Ray> rays;
    for (const reference::Pixel& pixel : reference::random_pixels(size, 300, 5)) {
        rays.push_back(reference::pixel_ray(camera, size, pixel));
    }
    return rays;
}

/// What the fog's light is off where it arrives unweakened, relative L2 over the view.
double cost_of_free_light(reference::Scene& scene) {
    double squares = 0.0;
    double total = 0.0;
    for (const reference::Ray& ray : view_rays()) {
        const reference::Tolerance tolerance{1e-5, 0.0};
        scene.attenuates_light = true;
        const double weakened = reference::airlight(scene, ray, 60.0, tolerance).value.r;
        scene.attenuates_light = false;
        const double free = reference::airlight(scene, ray, 60.0, tolerance).value.r;
        squares += (free - weakened) * (free - weakened);
        total += weakened * weakened;
    }
    return std::sqrt(squares / total);
}

/// Ground fog, seen from 2 m above its base, that takes `zenith_depth` from a light in the zenith.
reference::Scene ground_fog(double zenith_depth, double half_height_m, double sun_elevation_rad) {
    const double falloff_per_m = std::log(2.0) / half_height_m;
    reference::Scene scene;
    scene.medium.height = {.extinction_per_m = static_cast<float>(zenith_depth * falloff_per_m),
                           .base_height_m = -2.0F,
                           .falloff_per_m = static_cast<float>(falloff_per_m)};
    scene.sun =
        reference::DirectionalLight{.direction = {-std::cos(sun_elevation_rad), -std::sin(sun_elevation_rad), 0.0},
                                    .illuminance_lux = glm::dvec3(1.0),
                                    .casts_shadows = false};
    return scene;
}

TEST(LightFigures, LightThatLosesNothingOnItsWay) {
    reference::Scene lamp;
    lamp.medium.homogeneous.extinction_per_m = 0.05F;
    lamp.lights = {{.position = {0.0, 3.0, -12.0}, .intensity_cd = glm::dvec3(1.0), .casts_shadows = false}};
    reference::Scene sun_high = ground_fog(0.15, 10.0, 60.0 * pi / 180.0);
    reference::Scene sun_low = ground_fog(0.15, 10.0, 30.0 * pi / 180.0);
    const double high = cost_of_free_light(sun_high);
    const double low = cost_of_free_light(sun_low);
    const double near_lamp = cost_of_free_light(lamp);
    std::printf(
        "light that loses nothing on its way: sun at 60 degrees over ground fog %.0f %%, at 30 degrees %.0f %%, "
        "a lamp in fog %.0f %%\n",
        100.0 * high, 100.0 * low, 100.0 * near_lamp);
    EXPECT_NEAR(high, 0.18, 0.05);
    EXPECT_NEAR(low, 0.40, 0.06);
    EXPECT_NEAR(near_lamp, 0.24, 0.03);
}

/// How far a way from inside the view stays in it, the view being `far_m` deep.
double way_in_view(double far_m, const reference::Ray& way) {
    constexpr double aspect = 16.0 / 9.0;
    const double tangent_y = std::tan(0.5 * view_fov_y_rad);
    double length = 1e30;
    const auto leave_through = [&](const glm::dvec3& outward, double offset_m) {
        const double speed = glm::dot(outward, way.direction);
        if (speed > 0.0) {
            length = std::min(length, (offset_m - glm::dot(outward, way.origin)) / speed);
        }
    };
    leave_through({0.0, 1.0, tangent_y}, 0.0);
    leave_through({0.0, -1.0, tangent_y}, 0.0);
    leave_through({1.0, 0.0, tangent_y * aspect}, 0.0);
    leave_through({-1.0, 0.0, tangent_y * aspect}, 0.0);
    leave_through({0.0, 0.0, -1.0}, far_m);
    return length;
}

TEST(LightFigures, LightThatMeetsFogInsideTheViewOnly) {
    constexpr double far_m = 60.0;
    constexpr int nodes = 200;
    const reference::Scene scene = ground_fog(0.2, 20.0, 60.0 * pi / 180.0);
    const HeightFog& fog = scene.medium.height;
    const double falloff = fog.falloff_per_m;
    const double extinction = fog.extinction_per_m;
    const double eye_m = -static_cast<double>(fog.base_height_m);
    const auto optical_depth = [&](const reference::Ray& way, double length_m) {
        const double from_m = way.origin.y + eye_m;
        const double to_m = from_m + length_m * way.direction.y;
        return extinction * reference::height_integral(falloff, from_m, to_m, length_m);
    };
    double squares = 0.0;
    double total = 0.0;
    for (const reference::Ray& ray : view_rays()) {
        const double ground_m = ray.direction.y < 0.0 ? eye_m / -ray.direction.y : far_m;
        const double end_m = std::min(far_m, ground_m);
        double everywhere = 0.0;
        double in_view = 0.0;
        for (int i = 0; i < nodes; ++i) {
            const double t = end_m * (i + 0.5) / nodes;
            const reference::Ray way{ray.origin + t * ray.direction, -scene.sun->direction};
            const double scattered =
                std::exp(-falloff * (way.origin.y + eye_m) - optical_depth(ray, t)) * end_m / nodes;
            const double inside_m = way_in_view(far_m, way);
            everywhere += scattered * std::exp(-optical_depth(way, 1e4));
            in_view += scattered * std::exp(-optical_depth(way, std::min(inside_m, 1e4)));
        }
        squares += (in_view - everywhere) * (in_view - everywhere);
        total += everywhere * everywhere;
    }
    const double cost = std::sqrt(squares / total);
    std::printf("light that meets fog inside the view only: %.0f %% too bright\n", 100.0 * cost);
    EXPECT_NEAR(cost, 0.18, 0.05);
}

} // namespace
} // namespace tyndall::volumetrics::test
