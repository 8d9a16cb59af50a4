#include <cmath>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>

#include "samples/stability/case.hpp"

namespace tyndall::samples {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
/// Five times what is seen with the light at the eye itself, 2e-5; elsewhere it is 2e-6.
constexpr double pixels_smooth = 1e-4;

/// In air so thin that light loses less than a part in a thousand on its way of `reach_m`.
StabilityCase lit_air(std::string name, std::string parameter, const reference::Light& light, double reach_m = 100.0) {
    StabilityCase test{.name = std::move(name), .parameter = std::move(parameter)};
    test.scene = fog_before_a_wall(static_cast<float>(1e-3 / reach_m));
    test.scene.lights = {light};
    test.scene.fog.settings.storage = volumetrics::StorageFormat::fp32;
    return test;
}

/// The picture twice: the light in the froxels, and along each pixel's own ray as by default, where nothing lies
/// between columns and slices and only single precision is left.
void add_both(std::vector<StabilityCase>& cases, StabilityCase test, double froxels_bound,
              double pixels_bound = pixels_smooth) {
    const std::string parameter = test.parameter;
    test.parameter = parameter + ", froxels";
    test.scene.fog.settings.airlight.max_lights = 0;
    test.bound = froxels_bound;
    cases.push_back(test);
    test.parameter = parameter + ", pixels";
    test.scene.fog.settings.airlight = {};
    test.bound = pixels_bound;
    cases.push_back(std::move(test));
}

void add_intensities(std::vector<StabilityCase>& cases) {
    for (const double candela : {1e-6, 1.0, 1e3, 1e6, 1e9}) {
        StabilityCase test = lit_air("light_intensity", value_text(candela, "cd"),
                                     {.position = {4.0, 20.0, -15.0}, .intensity_cd = glm::dvec3(candela)});
        test.bound = 5e-2;
        test.quick = candela == 1e-6 || candela == 1e9;
        cases.push_back(test);
        test.parameter += ", fp16";
        test.scene.fog.settings.storage = volumetrics::StorageFormat::fp16;
        cases.push_back(std::move(test));
    }
}

void add_distances(std::vector<StabilityCase>& cases) {
    // To the side of the eye, as bright there as 100 cd at 10 m.
    for (const double distance_m : {0.0, 0.1, 10.0, 1e3, 1e5}) {
        const double candela = distance_m * distance_m + 1e-3;
        StabilityCase test =
            lit_air("light_distance", value_text(distance_m, "m"),
                    {.position = {0.0, distance_m, 0.0}, .intensity_cd = glm::dvec3(candela)}, 100.0 + distance_m);
        test.quick = distance_m == 0.0 || distance_m == 1e5;
        if (distance_m < 1.0) {
            // At the eye all rays pass the light within a froxel.
            add_both(cases, std::move(test), distance_m > 0.0 ? 2e-2 : 0.4);
        } else { // out of the view: in the froxels
            test.bound = 2e-2;
            cases.push_back(std::move(test));
        }
    }
}

/// In the view: next to the light no grid holds the picture, but nothing may leave its bounds.
void add_places(std::vector<StabilityCase>& cases) {
    const volumetrics::GridSettings grid = fog_before_a_wall(0.0F).fog.settings.grid;
    const auto boundary_m = [&](double k) {
        const double s = static_cast<double>(grid.shape_m);
        return s * (std::pow(1.0 + static_cast<double>(grid.range_m) / s, k / grid.slices) - 1.0);
    };
    for (const auto& [parameter, slice] : {std::pair("inside a froxel", 8.5), std::pair("on a slice boundary", 8.0),
                                           std::pair("in the first slice", 0.5)}) {
        StabilityCase test = lit_air("light_place", parameter,
                                     {.position = {0.0, 0.0, -boundary_m(slice)}, .intensity_cd = glm::dvec3(10.0)});
        test.quick = slice == 8.0;
        add_both(cases, std::move(test), 0.5);
    }
}

/// The beam stands in the view, in the plane of the rays right of the middle, so that the narrowest is met.
void add_spots(std::vector<StabilityCase>& cases) {
    const double x_m = 15.0 * std::tan(25.0 * degree) / 18.0; // of 18 rows of pixels, 50 degrees
    for (const double outer_degrees : {89.0, 30.0, 1.0, 1e-2, 0.0}) {
        StabilityCase test =
            lit_air("spot_angle", value_text(outer_degrees, "degrees"),
                    {.position = {x_m, 25.0, -15.0},
                     .intensity_cd = glm::dvec3(100.0),
                     .cone = reference::Cone{glm::dvec3(0.0, -1.0, 0.0), 0.0, outer_degrees * degree}});
        test.floor = 1.0; // a beam narrower than a froxel is in another pixel, or in none
        test.quick = outer_degrees == 0.0 || outer_degrees == 89.0;
        if (outer_degrees >= 30.0) {
            // So wide that it counts as out of the view, and stays in froxels 4 degrees wide as the light sees them.
            test.bound = outer_degrees > 45.0 ? 5e-2 : 0.2;
            cases.push_back(std::move(test));
        } else if (outer_degrees == 1.0) {
            // The cone's edge is 1.5e-4 of cosine wide, of which single precision tells 6e-8 apart.
            add_both(cases, std::move(test), 12.0, 5e-3);
        } else {
            // As good as dark, against the light without its cone: s I / (4 h) on an endless ray h beside it.
            test.least_mean = 1e-5 * 100.0 / (4.0 * 25.0);
            add_both(cases, std::move(test), 1e-9, 1e-9);
        }
    }
}

} // namespace

std::vector<StabilityCase> light_cases() {
    std::vector<StabilityCase> cases;
    add_intensities(cases);
    add_distances(cases);
    add_places(cases);
    add_spots(cases);
    return cases;
}

} // namespace tyndall::samples
