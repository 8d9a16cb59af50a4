// Fog beyond the grid's range against the fog that a longer range holds in froxels, and across the range itself.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

/// All that the far field knows of: two fogs, a sun without shadow, lobes of every form, ambient with a direction; the
/// camera turned and rolled, above the base of the height fog.
Scene hazy_scene() {
    Scene scene = plain_scene();
    scene.image = {160, 90};
    FrameInputs& in = scene.inputs;
    in.medium.homogeneous = {.extinction_per_m = 0.004F, .albedo = {0.9F, 0.8F, 0.7F}};
    in.medium.height.extinction_per_m = 0.02F;
    in.medium.height.falloff_per_m = 0.05F;
    in.medium.height.base_height_m = -6.0F;
    in.medium.height.albedo = in.medium.homogeneous.albedo;
    in.medium.ambient_radiance = glm::vec3(0.5F);
    in.medium.ambient_sh_1[0] = {0.3F, 0.2F, 0.1F};
    in.medium.ambient_sh_1[1] = {0.1F, 0.3F, 0.2F};
    in.medium.ambient_sh_1[2] = {0.2F, 0.1F, 0.3F};
    in.medium.phase_lobes.count = 4;
    in.medium.phase_lobes.lobes = {{{PhaseFunction::henyey_greenstein, 0.7F, 0.4F},
                                    {PhaseFunction::schlick, -0.5F, 0.3F},
                                    {PhaseFunction::cornette_shanks, 0.6F, 0.2F},
                                    {PhaseFunction::rayleigh, 0.0F, 0.1F}}};
    in.sun = Sun{.direction = glm::normalize(glm::vec3(0.3F, -0.5F, 0.8F)),
                 .illuminance_lux = glm::vec3(20.0F, 15.0F, 10.0F)};
    const double a = 0.4;
    const glm::dvec3 x(std::cos(a), 0.2 * std::sin(a), -std::sin(a));
    const glm::dvec3 unit_x = glm::normalize(x);
    const glm::dvec3 unit_y = glm::normalize(glm::cross(glm::dvec3(0.1, 0.0, 1.0), unit_x));
    const glm::dvec3 unit_z = glm::cross(unit_x, unit_y);
    in.camera.view_from_render = glm::dmat4(glm::transpose(glm::dmat3(unit_x, unit_y, unit_z)));
    in.settings.grid.slices = 128;
    return scene;
}

double largest_relative_difference(const Result& a, const Result& b) {
    double worst = 0.0;
    for (std::size_t i = 0; i < a.color.size(); ++i) {
        for (int channel = 0; channel < 3; ++channel) {
            const auto x = static_cast<double>(a.color[i][channel]);
            const auto y = static_cast<double>(b.color[i][channel]);
            worst = std::max(worst, std::isfinite(x) && std::isfinite(y) && y > 0.0 ? std::abs(x - y) / y : 1e9);
        }
    }
    return worst;
}

class FarField : public FogTest {
protected:
    Result at_range(Scene scene, float range_m) {
        scene.inputs.settings.grid.range_m = range_m;
        scene.inputs.settings.grid.shape_m = range_m / 4.0F;
        return render(scene);
    }
};

TEST_F(FarField, ContinuesWhatALongerRangeHolds) {
    Scene scene = hazy_scene();
    scene.depth_m = [](std::uint32_t x, std::uint32_t y) {
        return 2.0 * std::pow(150.0, ((x * 37 + y * 101) % 509) / 508.0);
    };
    const auto expect = [&](const char* what, double allowed) {
        const double worst = largest_relative_difference(at_range(scene, 20.0F), at_range(scene, 300.0F));
        std::printf("%s, range 20 m against 300 m: %.2e\n", what, worst);
        EXPECT_LE(worst, allowed) << what;
    };
    scene.inputs.settings.light_path = LightPath::none;
    expect("two fogs", 5e-3);
    scene.inputs.settings.light_path = LightPath::closed_form;
    expect("two fogs that weaken the sun", 2e-2);
    scene.inputs.medium.homogeneous.extinction_per_m = 0.0F;
    expect("height fog that weakens the sun", 5e-3);
}

std::shared_ptr<const DensityTexels> even_texels(std::uint8_t value) {
    return *DensityTexels::create({1, 1, 1}, {value});
}

/// A fifth of its fog is left between 50 and 100 m below the camera, all of it behind a range of 20 m, below the sun.
Scene sunken_scene() {
    Scene scene = plain_scene();
    scene.image = {80, 45};
    FrameInputs& in = scene.inputs;
    in.camera.origin_m = {300.0, 120.0, -40.0};
    in.medium.height = {.extinction_per_m = 0.06F, .base_height_m = 40.0F, .falloff_per_m = 0.02F};
    in.medium.map = {.texels = even_texels(51), .bottom_m = 20.0F, .top_m = 70.0F, .fade_m = 0.01F};
    in.medium.ambient_radiance = glm::vec3(0.5F);
    in.sun = Sun{.direction = glm::normalize(glm::vec3(0.3F, -0.8F, 0.5F)), .illuminance_lux = glm::vec3(20.0F)};
    return scene;
}

/// Of a ray that sinks by `sinking` per metre from above all of the fog: ambient and sun, by steps of a millimetre.
double radiance_of_sunken_fog(const Scene& scene, double sinking) {
    const Medium& medium = scene.inputs.medium;
    const double sun_sinking = -static_cast<double>(scene.inputs.sun->direction.y);
    const double sun = static_cast<double>(scene.inputs.sun->illuminance_lux.r) / (4.0 * 3.14159265358979);
    const double mean = medium.map.texels->mean();
    const double step_m = 1e-3;
    double column = 0.0; // above
    double sum = 0.0;
    for (double y = static_cast<double>(medium.map.top_m) - 0.5 * step_m; y > static_cast<double>(medium.map.bottom_m);
         y -= step_m) {
        const double above_m = std::max(0.0, y - static_cast<double>(medium.height.base_height_m));
        const double low = static_cast<double>(medium.height.extinction_per_m) *
                           std::exp(-static_cast<double>(medium.height.falloff_per_m) * above_m);
        const double here = mean * step_m * (static_cast<double>(medium.homogeneous.extinction_per_m) + low);
        const double low_part = low / (low + static_cast<double>(medium.homogeneous.extinction_per_m));
        column += 0.5 * here;
        const double light =
            static_cast<double>(medium.ambient_radiance.r) + sun * std::exp(-low_part * column / sun_sinking);
        sum += here / sinking * std::exp(-column / sinking) * light;
        column += 0.5 * here;
    }
    return sum;
}

TEST_F(FarField, FogBetweenHeightsIsThereOnly) {
    const Scene scene = sunken_scene();
    const Result result = at_range(scene, 20.0F);
    double worst = 0.0;
    for (std::uint32_t y = 0; y < scene.image.y; ++y) {
        for (std::uint32_t x = 0; x < scene.image.x; x += 5) {
            const glm::vec4& found = result.color[y * scene.image.x + x];
            const double sinking = -pixel_ray(scene, x, y).direction.y;
            if (sinking < 1e-3) { // level or upward
                ASSERT_EQ(found.r, 0.0F) << x << " " << y;
                continue;
            }
            const double expected = radiance_of_sunken_fog(scene, sinking);
            worst = std::max(worst, std::abs(static_cast<double>(found.r) / expected - 1.0));
        }
    }
    std::printf("fog below the range, against a double integral: %.2e\n", worst);
    EXPECT_LE(worst, 5e-3);
}

TEST_F(FarField, FogBetweenHeightsEndsAtSurfacesAndAboveTheCamera) {
    // Without the sun the integral is 1 - e^-tau of the ambient light, whatever the way goes through.
    Scene scene = sunken_scene();
    scene.image.y = 46; // no ray is level
    scene.inputs.sun.reset();
    scene.inputs.medium.height.extinction_per_m = 0.0F;
    scene.inputs.medium.homogeneous.extinction_per_m = 0.02F;
    const auto expect = [&](const char* what, double below_m, double above_m, double depth_m) {
        scene.depth_m = [depth_m](std::uint32_t, std::uint32_t) { return depth_m; };
        const Result result = at_range(scene, 20.0F);
        double worst = 0.0;
        for (std::uint32_t y = 0; y < scene.image.y; ++y) {
            const PixelRay ray = pixel_ray(scene, 11, y);
            const double climb = ray.direction.y;
            const double a = -below_m / climb;
            const double b = above_m / climb;
            const double inside_m = std::min(depth_m * ray.stretch, std::max(a, b)) - std::max(0.0, std::min(a, b));
            const double expected = 0.5 * (1.0 - std::exp(-std::max(inside_m, 0.0) * 0.02 * 0.2));
            const double found = static_cast<double>(result.color[y * scene.image.x + 11].r);
            worst = std::max(worst, std::abs(found - expected));
        }
        std::printf("%s: radiance of 0.5 at most %.1e off\n", what, worst);
        EXPECT_LE(worst, 1e-3) << what;
    };
    expect("from above, sky", 100.0, -50.0, std::numeric_limits<double>::infinity());
    expect("from above, a wall", 100.0, -50.0, 250.0);
    scene.inputs.camera.origin_m.y = 0.0;
    expect("from below, sky", -20.0, 70.0, std::numeric_limits<double>::infinity());
    expect("from below, a wall", -20.0, 70.0, 60.0);
}

TEST_F(FarField, SkyIsTheSameWhereverTheFarPlaneLies) {
    Scene scene = hazy_scene();
    const Result endless = render(scene);
    glm::dmat4& p = scene.inputs.camera.clip_from_view;
    const double far_m = 100.0;
    const double plane_m = p[3][2];
    p[2][2] = plane_m / (far_m - plane_m);
    p[3][2] = plane_m * far_m / (far_m - plane_m);
    const double worst = largest_relative_difference(render(scene), endless);
    std::printf("sky behind a far plane of 100 m: %.2e\n", worst);
    EXPECT_LE(worst, 1e-5);
}

TEST_F(FarField, TakesTheAlbedoOfTheFogThatIsSeen) {
    // White fog everywhere, blue fog that lies low: the mean over one optical depth of the former stands for the ray.
    Scene scene = hazy_scene();
    scene.inputs.medium.homogeneous.albedo = glm::vec3(1.0F);
    scene.inputs.medium.height.albedo = {0.2F, 0.5F, 0.9F};
    scene.depth_m = [](std::uint32_t x, std::uint32_t y) {
        return 2.0 * std::pow(150.0, ((x * 37 + y * 101) % 509) / 508.0);
    };
    const Result near = at_range(scene, 20.0F);
    const Result far = at_range(scene, 300.0F);
    const double worst = largest_relative_difference(near, far);
    scene.inputs.medium.height.albedo = glm::vec3(1.0F);
    const double all_white = largest_relative_difference(at_range(scene, 300.0F), far);
    std::printf("albedos 1 and 0.2: %.2e; if all were white: %.2f\n", worst, all_white);
    EXPECT_LE(worst, 5e-2);
    EXPECT_GT(all_white, 0.5);
}

TEST_F(FarField, HasNoSeamAtTheRange) {
    Scene scene = hazy_scene();
    const auto at = [&](double depth_m) {
        scene.depth_m = [depth_m](std::uint32_t, std::uint32_t) { return depth_m; };
        return at_range(scene, 64.0F);
    };
    for (const bool map : {false, true}) {
        if (map) {
            scene.inputs.medium.map = {.texels = even_texels(204), .bottom_m = -30.0F, .top_m = 12.0F, .fade_m = 2.0F};
        }
        const Result before = at(64.0 * (1.0 - 1e-3));
        const Result at_the_range = at(64.0);
        const Result behind = at(64.0 * (1.0 + 1e-3));
        const double step_in = largest_relative_difference(before, at_the_range);
        const double step_out = largest_relative_difference(behind, at_the_range);
        std::printf("1e-3 of the range before and behind it: %.2e, %.2e\n", step_in, step_out);
        EXPECT_LE(step_in, 5e-3);
        EXPECT_LE(step_out, 5e-3);
        EXPECT_GT(step_out, 1e-5) << "fog ends at the range";
    }
}

TEST_F(FarField, SkyIsTheLimitOfDistance) {
    Scene scene = hazy_scene();
    scene.depth_m = [](std::uint32_t, std::uint32_t) { return 1e6; };
    const Result far = at_range(scene, 64.0F);
    scene.depth_m = [](std::uint32_t, std::uint32_t) { return std::numeric_limits<double>::infinity(); };
    EXPECT_LE(largest_relative_difference(at_range(scene, 64.0F), far), 1e-5);
}

} // namespace
} // namespace tyndall::volumetrics::test
