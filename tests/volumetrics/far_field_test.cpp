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

TEST_F(FarField, SkyIsTheLimitOfDistance) {
    Scene scene = hazy_scene();
    scene.depth_m = [](std::uint32_t, std::uint32_t) { return 1e6; };
    const Result far = at_range(scene, 64.0F);
    scene.depth_m = [](std::uint32_t, std::uint32_t) { return std::numeric_limits<double>::infinity(); };
    EXPECT_LE(largest_relative_difference(at_range(scene, 64.0F), far), 1e-5);
}

} // namespace
} // namespace tyndall::volumetrics::test
