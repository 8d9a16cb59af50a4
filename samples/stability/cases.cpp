#include "samples/stability/case.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace tyndall::samples {
namespace {

/// On the far boundary of the eleventh slice, 16 (5^(11/16) - 1): what is behind the wall, in its shadow, is in no
/// slice before it.
constexpr double wall_m = 32.379;
constexpr double degree = std::numbers::pi / 180.0;
/// Froxels of the test grid agree with the exact picture within this in a smooth medium.
constexpr double smooth_bound = 5e-3;

reference::DirectionalLight even_sun() {
    return {glm::normalize(glm::dvec3(0.4, -1.0, -0.6)), glm::dvec3(10.0), true};
}

void add_extinctions(std::vector<StabilityCase>& cases) {
    for (const double extinction : {0.0, 1e-8, 1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6}) {
        StabilityCase test{.name = "extinction", .parameter = value_text(extinction, "1/m")};
        test.scene = fog_before_a_wall(static_cast<float>(extinction));
        test.scene.sun = even_sun();
        test.scene.fog.medium.ambient_radiance = glm::vec3(0.5F);
        test.bound = smooth_bound;
        test.quick = extinction == 1e-8 || extinction == 1.0 || extinction == 1e6;
        cases.push_back(std::move(test));
    }
    for (const double albedo : {0.0, 1e-6, 0.5, 1.0}) {
        StabilityCase test{.name = "albedo", .parameter = value_text(albedo)};
        test.scene = fog_before_a_wall(0.05F);
        test.scene.fog.medium.homogeneous.albedo = glm::vec3(static_cast<float>(albedo));
        test.scene.sun = even_sun();
        test.bound = smooth_bound;
        test.quick = albedo == 0.0;
        cases.push_back(std::move(test));
    }
}

/// The channels up to 8 orders of magnitude apart: 16-bit floats hold no more of one medium.
void add_colors(std::vector<StabilityCase>& cases) {
    for (const glm::vec3& extinction :
         {glm::vec3(0.0F, 1e-3F, 1.0F), glm::vec3(1e-2F, 0.1F, 1e6F), glm::vec3(0.5F, 0.0F, 0.02F)}) {
        StabilityCase test{.name = "colored_extinction",
                           .parameter = value_text(static_cast<double>(extinction.r)) + ", " +
                                        value_text(static_cast<double>(extinction.g)) + ", " +
                                        value_text(static_cast<double>(extinction.b), "1/m")};
        const float most = std::max({extinction.r, extinction.g, extinction.b});
        test.scene = fog_before_a_wall(most);
        test.scene.fog.medium.homogeneous.extinction_color = extinction / most;
        test.scene.sun = even_sun();
        test.scene.fog.medium.ambient_radiance = glm::vec3(0.5F);
        test.bound = smooth_bound;
        test.quick = extinction.b == 1e6F;
        cases.push_back(std::move(test));
    }
}

void add_phases(std::vector<StabilityCase>& cases) {
    for (const double g : {-0.999, -0.9, -0.5, 0.0, 0.5, 0.9, 0.999}) {
        StabilityCase test{.name = "phase_g", .parameter = value_text(g)};
        test.scene = fog_before_a_wall(0.05F);
        test.scene.fog.medium.phase_g = static_cast<float>(g);
        test.scene.sun = even_sun();
        // The sun behind the eye: what scatters back comes from the middle of the picture.
        test.scene.sun->direction = glm::normalize(glm::dvec3(0.05, -0.1, -1.0));
        // Columns are 2 degrees apart; the peak is 63 degrees wide at 0.5, 9 at 0.9 and 0.09 at 0.999.
        test.bound = std::abs(g) <= 0.5 ? 2e-2 : std::abs(g) <= 0.9 ? 0.15 : 12.0;
        test.quick = g == -0.999;
        cases.push_back(std::move(test));
    }
}

void add_ranges(std::vector<StabilityCase>& cases) {
    for (const double slice_m : {1e-3, 1e-1, 10.0, 1e4}) {
        StabilityCase test{.name = "slice_length", .parameter = value_text(slice_m, "m")};
        const double range_m = 16.0 * slice_m;
        test.scene = fog_before_a_wall(static_cast<float>(1.0 / range_m));
        const double scale = 0.9 * range_m / wall_m;
        for (auto& corner : test.scene.surfaces.front().quads.front()) {
            corner *= scale;
        }
        test.scene.fog.settings.grid.range_m = static_cast<float>(range_m);
        test.scene.fog.settings.grid.shape_m = static_cast<float>(100.0 * range_m);
        test.scene.fog.medium.ambient_radiance = glm::vec3(0.5F);
        test.near_m = std::min(0.1, 1e-3 * range_m);
        test.bound = smooth_bound;
        test.quick = slice_m == 1e-3 || slice_m == 1e4;
        cases.push_back(std::move(test));
    }
}

void add_views(std::vector<StabilityCase>& cases) {
    for (const double angle : {0.1, 1.0, 50.0, 120.0, 170.0}) {
        StabilityCase test{.name = "field_of_view", .parameter = value_text(angle, "degrees")};
        test.scene = fog_before_a_wall(0.02F);
        test.scene.camera.fov_y_rad = angle * degree;
        test.scene.sun = even_sun();
        test.scene.fog.medium.ambient_radiance = glm::vec3(0.5F);
        // Of the widest view a column of froxels sees several times another length of fog than its neighbour.
        test.bound = angle < 150.0 ? 1e-2 : 0.2;
        test.quick = angle == 0.1 || angle == 170.0;
        cases.push_back(std::move(test));
    }
    StabilityCase test{.name = "near_and_far", .parameter = "1e-3 m and 1e7 m"};
    test.scene = fog_before_a_wall(1e-7F);
    for (auto& corner : test.scene.surfaces.front().quads.front()) {
        corner *= 9e6 / wall_m;
    }
    test.scene.fog.settings.grid.range_m = 1e7F;
    test.scene.fog.settings.grid.shape_m = 1e6F;
    test.scene.fog.medium.ambient_radiance = glm::vec3(0.5F);
    test.near_m = 1e-3;
    test.far_m = 1e7;
    // Device depth in single precision places the wall within 2e-3 of its distance.
    test.bound = smooth_bound;
    test.quick = true;
    cases.push_back(std::move(test));
}

/// Metres of a ray, up to `length_m`, in a box along the axes.
double length_in_box(const reference::Ray& ray, double length_m, const volumetrics::LocalVolume& box) {
    double enter = 0.0;
    double leave = length_m;
    for (int axis = 0; axis < 3; ++axis) {
        const double center = static_cast<double>(box.center_m[axis]) - ray.origin[axis];
        const double half = static_cast<double>(box.half_size_m[axis]);
        const double toward = ray.direction[axis];
        if (toward == 0.0) {
            leave = std::abs(center) <= half ? leave : enter;
        } else {
            enter = std::max(enter, std::min((center - half) / toward, (center + half) / toward));
            leave = std::min(leave, std::max((center - half) / toward, (center + half) / toward));
        }
    }
    return std::max(0.0, leave - enter);
}

void add_volumes(std::vector<StabilityCase>& cases) {
    using volumetrics::LocalVolume;
    using volumetrics::VolumeBlend;
    using volumetrics::VolumeShape;
    constexpr double even_per_m = 0.01;
    /// `per_m`: what is added inside the volume.
    const auto add = [&](const char* parameter, const LocalVolume& volume, double per_m) {
        StabilityCase test{.name = "local_volume", .parameter = parameter};
        test.scene = fog_before_a_wall(static_cast<float>(even_per_m));
        test.scene.fog.medium.ambient_radiance = glm::vec3(0.5F);
        test.scene.fog.medium.volumes = {volume};
        test.closed_form = [=](const reference::Ray& ray, double length_m) {
            const double depth = even_per_m * length_m + per_m * length_in_box(ray, length_m, volume);
            return glm::dvec3(-0.5 * std::expm1(-depth));
        };
        test.bound = smooth_bound;
        test.quick = true;
        cases.push_back(std::move(test));
    };
    const glm::vec3 ahead(0.0F, 0.0F, -10.0F);
    const glm::vec3 huge(1e3F);
    add("without extinction", {.center_m = ahead, .extinction_per_m = 0.0F}, 0.0);
    add("box of no size", {.center_m = ahead, .half_size_m = glm::vec3(0.0F), .extinction_per_m = 1e6F}, 0.0);
    add("ellipsoid of no height",
        {.shape = VolumeShape::ellipsoid,
         .center_m = ahead,
         .half_size_m = {5.0F, 0.0F, 5.0F},
         .extinction_per_m = 1e6F},
        0.0);
    add("the eye in a face",
        {.center_m = {0.0F, 0.0F, -500.0F}, .half_size_m = {1e3F, 1e3F, 500.0F}, .extinction_per_m = 0.1F}, 0.1);
    add("the eye in a side",
        {.center_m = {500.0F, 0.0F, 0.0F}, .half_size_m = {500.0F, 1e3F, 1e3F}, .extinction_per_m = 0.1F}, 0.1);
    add("the eye in it", {.half_size_m = huge, .extinction_per_m = 0.1F}, 0.1);
    add("subtracts all", {.blend = VolumeBlend::subtract, .half_size_m = huge, .extinction_per_m = 1e6F}, -even_per_m);
}

void add_shadow_maps(std::vector<StabilityCase>& cases) {
    for (const float exponent : {1.0F, 40.0F, 400.0F, 1000.0F}) {
        StabilityCase test{.name = "esm_exponent",
                           .parameter = value_text(static_cast<double>(exponent)) + ", occluders 1 km off"};
        test.scene = fog_before_a_wall(0.02F);
        // Slats far above the air that they shadow; the wall as small as the view, so that the map's texels are.
        for (auto& corner : test.scene.surfaces.front().quads.front()) {
            corner *= glm::dvec3(0.06, 0.06, 1.0);
        }
        for (int i = -3; i < 3; ++i) {
            test.scene.surfaces.push_back(
                make_box({20.0 * i + 5.0, 1000.0, -60.0}, {20.0 * i + 15.0, 1001.0, 10.0}, glm::dvec3(0.0)));
        }
        test.scene.sun = even_sun();
        test.scene.sun->direction = glm::dvec3(0.0, -1.0, 0.0);
        test.scene.fog.settings.visibility.method = volumetrics::SunVisibility::prefiltered;
        test.scene.fog.settings.shadow.esm_exponent = {exponent, exponent, exponent, exponent};
        test.floor = 1.0; // a blurred map lights what the exact picture has in full shadow
        test.bound = 0.8; // slats and gaps are as wide as the blur
        test.quick = exponent == 1000.0F;
        cases.push_back(std::move(test));
    }
}

void add_times(std::vector<StabilityCase>& cases) {
    for (const double time_s : {0.0, 1e-9, 1e4, 1e9}) {
        StabilityCase test{.name = "time", .parameter = value_text(time_s, "s")};
        test.scene = fog_before_a_wall(0.02F);
        test.scene.fog.medium.noise = {.amplitude = 0.5F, .scale_m = 16.0F, .wind_m_s = {0.5F, 0.25F, -0.5F}};
        test.scene.fog.medium.ambient_radiance = glm::vec3(0.5F);
        test.scene.time_s = time_s;
        test.bound = 5e-2; // a cell of noise is a few froxels wide
        test.quick = time_s == 1e9;
        cases.push_back(std::move(test));
    }
}

/// Albedo 1 and the same radiance from everywhere, also behind: nothing is to be seen.
void add_furnaces(std::vector<StabilityCase>& cases) {
    using volumetrics::StorageFormat;
    for (const StorageFormat storage : {StorageFormat::fp32, StorageFormat::fp16}) {
        for (const double depth : {1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6}) {
            StabilityCase test{.name = storage == StorageFormat::fp32 ? "furnace_fp32" : "furnace_fp16",
                               .parameter = "optical depth " + value_text(depth)};
            const float range_m = volumetrics::GridSettings{}.range_m;
            test.scene = fog_before_a_wall(static_cast<float>(depth) / range_m);
            test.scene.surfaces.clear();
            test.scene.fog.settings.storage = storage;
            test.scene.fog.medium.ambient_radiance = glm::vec3(3.0F);
            test.scene.surroundings.zenith = test.scene.surroundings.horizon = test.scene.surroundings.ground =
                glm::dvec3(3.0);
            test.closed_form = [](const reference::Ray&, double) { return glm::dvec3(3.0); };
            test.bound = storage == StorageFormat::fp32 ? 1e-4 : 1e-3;
            test.quick = depth == 1e-6 || depth == 1.0 || depth == 1e6;
            cases.push_back(std::move(test));
        }
    }
}

/// Denser than anything in sight is deep: the air before the eye is all there is.
void add_dense_slabs(std::vector<StabilityCase>& cases) {
    using volumetrics::Integrator;
    for (const Integrator integrator : {Integrator::exponential, Integrator::exponential_quadratic}) {
        for (const float extinction : {10.0F, 1e3F, 1e6F}) {
            StabilityCase test{.name = "dense_slab",
                               .parameter = value_text(static_cast<double>(extinction), "1/m") +
                                            (integrator == Integrator::exponential ? "" : ", quadratic")};
            test.scene = fog_before_a_wall(extinction);
            test.scene.sun = even_sun();
            test.scene.fog.settings.integrator = integrator;
            test.bound = smooth_bound;
            test.quick = extinction == 1e6F;
            cases.push_back(std::move(test));
        }
    }
}

} // namespace

std::string value_text(double value, const std::string& unit) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%g", value);
    return unit.empty() ? text.data() : std::string(text.data()) + " " + unit;
}

PrecisionScene fog_before_a_wall(float extinction_per_m) {
    PrecisionScene scene;
    constexpr double half = 1000.0;
    scene.surfaces = {{{{glm::dvec3(-half, -half, -wall_m), glm::dvec3(half, -half, -wall_m),
                         glm::dvec3(half, half, -wall_m), glm::dvec3(-half, half, -wall_m)}},
                       glm::dvec3(0.0)}};
    scene.fog.medium.homogeneous = {.extinction_per_m = extinction_per_m, .albedo = glm::vec3(1.0F)};
    volumetrics::GridSettings& grid = scene.fog.settings.grid;
    grid.width = 40;
    grid.height = 23;
    grid.slices = 16;
    scene.fog.settings.visibility.method = volumetrics::SunVisibility::lit_fraction; // the wall's own shadow is sharp
    scene.camera.fov_y_rad = 50.0 * degree;
    return scene;
}

std::vector<StabilityCase> stability_cases() {
    std::vector<StabilityCase> cases;
    add_extinctions(cases);
    add_colors(cases);
    add_phases(cases);
    add_ranges(cases);
    for (StabilityCase& test : light_cases()) {
        cases.push_back(std::move(test));
    }
    add_shadow_maps(cases);
    add_views(cases);
    add_volumes(cases);
    add_times(cases);
    add_furnaces(cases);
    add_dense_slabs(cases);
    return cases;
}

} // namespace tyndall::samples
