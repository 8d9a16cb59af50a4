// Phase functions of the shader against their formulas in double precision, and their integrals over the sphere.
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "features/volumetrics/reference/medium.hpp"
#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

constexpr double pi = std::numbers::pi;

/// Angles between which each function is smooth on the scale of the part, up to |g| = 0.999.
constexpr std::array<double, 12> angles{0.0,      0.002,     0.01,      0.05,      0.25,       1.0,
                                        pi - 1.0, pi - 0.25, pi - 0.05, pi - 0.01, pi - 0.002, pi};

PhaseLobes one_lobe(PhaseFunction function, double g) {
    PhaseLobes phase{.count = 1};
    phase.lobes[0] = {.function = function, .g = static_cast<float>(g)};
    return phase;
}

PhaseLobes four_lobes() {
    PhaseLobes phase{.count = 4};
    phase.lobes = {PhaseLobe{PhaseFunction::henyey_greenstein, 0.9F, 0.4F},
                   PhaseLobe{PhaseFunction::rayleigh, 0.0F, 0.25F}, PhaseLobe{PhaseFunction::schlick, -0.6F, 0.1F},
                   PhaseLobe{PhaseFunction::isotropic, 0.0F, 0.05F}};
    return phase;
}

std::vector<PhaseLobes> all_phases() {
    std::vector<PhaseLobes> phases{one_lobe(PhaseFunction::isotropic, 0.0), one_lobe(PhaseFunction::rayleigh, 0.0)};
    for (const PhaseFunction function :
         {PhaseFunction::henyey_greenstein, PhaseFunction::schlick, PhaseFunction::cornette_shanks}) {
        for (const double g : {-0.999, -0.7, 0.0, 0.3, 0.9, 0.999}) {
            phases.push_back(one_lobe(function, g));
        }
    }
    phases.push_back(four_lobes());
    return phases;
}

/// Composite Simpson's rule on an even number of parts.
template <typename Value>
double simpson(std::size_t parts, double length, Value value) {
    double sum = 0.0;
    for (std::size_t i = 0; i <= parts; ++i) {
        sum += value(i) * (i == 0 || i == parts ? 1.0 : i % 2 == 1 ? 4.0 : 2.0);
    }
    return sum * length / (3.0 * static_cast<double>(parts));
}

double integral(const Medium& medium, bool times_cosine) {
    double sum = 0.0;
    for (std::size_t part = 0; part + 1 < angles.size(); ++part) {
        const double length = angles[part + 1] - angles[part];
        sum += simpson(512, length, [&](std::size_t i) {
            const double theta = angles[part] + length * static_cast<double>(i) / 512.0;
            const double value = reference::phase(medium, std::cos(theta)) * 2.0 * pi * std::sin(theta);
            return times_cosine ? value * std::cos(theta) : value;
        });
    }
    return sum;
}

TEST(Phase, IntegratesToOneInDoubleAndHasItsMeanCosine) {
    for (const PhaseLobes& phase : all_phases()) {
        Medium medium;
        medium.phase_lobes = phase;
        const double g = static_cast<double>(phase.lobes[0].g);
        EXPECT_NEAR(integral(medium, false), 1.0, 1e-6) << "function " << packed_functions(phase) << " g " << g;
        EXPECT_NEAR(integral(medium, true), mean_cosine(phase), 1e-6) << packed_functions(phase) << " g " << g;
    }
    for (const double k : {0.019, 0.021}) { // where its mean cosine changes from series to closed form
        Medium medium;
        medium.phase_lobes = one_lobe(PhaseFunction::schlick, k);
        EXPECT_NEAR(integral(medium, true), mean_cosine(medium.phase_lobes), 1e-9);
    }
}

TEST(Phase, PeakAndSteepnessBoundTheFunction) {
    for (const PhaseLobes& phase : all_phases()) {
        Medium medium;
        medium.phase_lobes = phase;
        double largest = 0.0;
        double before = 0.0;
        for (int i = 0; i <= 4000; ++i) {
            const double theta = pi * i / 4000.0;
            const double value = reference::phase(medium, std::cos(theta));
            largest = std::max(largest, value);
            if (i > 0) {
                EXPECT_LE(std::abs(std::log(value / before)), steepness(phase) * pi / 4000.0 * (1.0 + 1e-9) + 1e-12);
            }
            before = value;
        }
        EXPECT_LE(largest, peak(phase) * (1.0 + 1e-9));
        EXPECT_GE(largest, phase.count == 1 ? peak(phase) * (1.0 - 1e-9) : 0.0);
    }
}

class PhaseOnDevice : public FogTest {
protected:
    static constexpr std::uint32_t columns = 513;

    /// The phase function as froxel lighting sees it: the sun's in-scattered radiance along the middle row, whose
    /// columns see it under the angles middle +- atan(half), spaced by the tangent.
    std::vector<double> row(const PhaseLobes& phase, double middle, double half) {
        Scene scene = plain_scene();
        scene.image = {8, 8};
        scene.inputs.settings.grid = {.width = columns, .height = 3, .slices = 8, .range_m = 1.0F, .shape_m = 1.0F};
        scene.inputs.camera.clip_from_view[0][0] = 1.0 / half;
        scene.inputs.medium.homogeneous.extinction_per_m = 1.0F;
        scene.inputs.medium.phase_lobes = phase;
        scene.inputs.sun = Sun{.direction = glm::vec3(glm::dvec3(std::sin(middle), 0.0, std::cos(middle))),
                               .illuminance_lux = glm::vec3(1.0F)};
        const Result result = render(scene);
        std::vector<double> values;
        for (std::size_t x = 0; x < columns; ++x) {
            values.push_back(static_cast<double>(result.in_scattered[columns + x].r));
        }
        return values;
    }
};

TEST_F(PhaseOnDevice, IntegratesToOneAndFollowsItsFormula) {
    double worst_integral = 0.0;
    double worst_value = 0.0;
    for (const PhaseLobes& phase : all_phases()) {
        Medium medium;
        medium.phase_lobes = phase;
        double sum = 0.0;
        for (std::size_t part = 0; part + 1 < angles.size(); ++part) {
            const double middle = 0.5 * (angles[part] + angles[part + 1]);
            const double half = std::tan(0.5 * (angles[part + 1] - angles[part]));
            const std::vector<double> values = row(phase, middle, half);
            sum += simpson(columns - 1, 2.0 * half, [&](std::size_t i) {
                const double t = half * (2.0 * static_cast<double>(i) / (columns - 1) - 1.0);
                const double theta = middle + std::atan(t);
                worst_value =
                    std::max(worst_value, std::abs(values[i] / reference::phase(medium, std::cos(theta)) - 1.0));
                return values[i] * 2.0 * pi * std::sin(theta) / (1.0 + t * t);
            });
        }
        EXPECT_NEAR(sum, 1.0, 1e-4) << "functions " << packed_functions(phase) << " g " << phase.lobes[0].g;
        worst_integral = std::max(worst_integral, std::abs(sum - 1.0));
    }
    std::printf("phase functions on the device: integral off by %.1e, value by %.1e of itself\n", worst_integral,
                worst_value);
    EXPECT_LE(worst_value, 1e-3);
}

TEST_F(PhaseOnDevice, DirectedAmbientIsTheIntegralOfRadianceTimesPhase) {
    for (const PhaseLobes& phase :
         {one_lobe(PhaseFunction::henyey_greenstein, 0.6), one_lobe(PhaseFunction::schlick, -0.7),
          one_lobe(PhaseFunction::cornette_shanks, 0.5), four_lobes()}) {
        Scene scene = plain_scene();
        scene.inputs.settings.grid = {.width = 9, .height = 5, .slices = 8, .range_m = 1.0F, .shape_m = 1.0F};
        Medium& medium = scene.inputs.medium;
        medium.homogeneous.extinction_per_m = 1.0F;
        medium.phase_lobes = phase;
        medium.ambient_radiance = glm::vec3(2.0F, 1.0F, 3.0F);
        medium.ambient_sh_1 = {glm::vec3(2.0F, 0.0F, -1.0F), glm::vec3(1.0F, 0.5F, 0.0F), glm::vec3(-2.0F, 1.0F, 3.0F)};
        const Result result = render(scene);
        const glm::dvec3 axes[] = {glm::dvec3(medium.ambient_sh_1[2]), glm::dvec3(medium.ambient_sh_1[0]),
                                   glm::dvec3(medium.ambient_sh_1[1])};
        for (const std::size_t froxel : {0UL, 8UL, 22UL, 40UL}) {
            const std::size_t column = froxel % 9;
            const std::size_t row = froxel / 9;
            const double x = tan_x * (2.0 * static_cast<double>(column) / 8.0 - 1.0);
            const double y = -tan_y * (2.0 * static_cast<double>(row) / 4.0 - 1.0);
            const glm::dvec3 to_eye = -glm::normalize(glm::dvec3(x, y, -1.0));
            glm::dvec3 expected(0.0);
            const int rings = 600;
            const int spokes = 24; // exact for order 1 around the axis
            const glm::dvec3 side = glm::normalize(glm::cross(to_eye, glm::dvec3(0.0, 1.0, 0.0)));
            const glm::dvec3 up = glm::cross(side, to_eye);
            for (int i = 0; i < rings; ++i) {
                const double theta = pi * (i + 0.5) / rings;
                for (int j = 0; j < spokes; ++j) {
                    const double phi = 2.0 * pi * j / spokes;
                    const glm::dvec3 travel =
                        std::cos(theta) * to_eye + std::sin(theta) * (std::cos(phi) * side + std::sin(phi) * up);
                    const glm::dvec3 from = -travel;
                    const glm::dvec3 directed = from.x * axes[0] + from.y * axes[1] + from.z * axes[2];
                    const glm::dvec3 radiance =
                        glm::dvec3(medium.ambient_radiance) + std::sqrt(3.0 / (4.0 * pi)) * directed;
                    expected += radiance * (reference::phase(medium, std::cos(theta)) * std::sin(theta) * (pi / rings) *
                                            (2.0 * pi / spokes));
                }
            }
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(static_cast<double>(result.in_scattered[froxel][c]) / expected[c], 1.0, 1e-4) << froxel;
            }
        }
    }
}

} // namespace
} // namespace tyndall::volumetrics::test
