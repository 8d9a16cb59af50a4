// Shafts of light under a slotted roof, along the rays through froxel centres, against the exact integral in double
// precision over the shadow map's own geometry.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

constexpr double pi = 3.14159265358979323846;

/// A roof 10 m above the camera with slots, and a sun that shines through it obliquely.
class Shafts : public FogTest {
protected:
    static constexpr double extent_m = 140.0;
    static constexpr double roof_m = 10.0;
    static constexpr double extinction = 0.02;
    static constexpr std::uint32_t size = 1024;

    void SetUp() override {
        FogTest::SetUp();
        scene_ = sunlit_scene(static_cast<float>(extent_m));
        scene_.inputs.medium.homogeneous.extinction_per_m = static_cast<float>(extinction);
        scene_.cascade_size = size;
        // u = 0.5 + (x + 0.5 y) / extent, v = 0.5 + (z + 0.25 y) / extent: planes of light lean toward the sun.
        const glm::dvec3 travel = glm::normalize(glm::dvec3(0.5, -1.0, 0.25));
        scene_.inputs.sun->direction = glm::vec3(travel);
        for (glm::mat4& cascade : scene_.cascades.shadow_from_render) {
            cascade[1][0] = static_cast<float>(0.5 / extent_m);
            cascade[1][1] = static_cast<float>(0.25 / extent_m);
        }
        std::mt19937 random(9);
        std::uniform_int_distribution<std::uint32_t> width(2, 12); // texels of 14 cm
        open_.resize(size);
        bool open = false;
        for (std::uint32_t u = 0; u < size; open = !open) {
            for (std::uint32_t end = std::min(size, u + width(random)); u < end; ++u) {
                open_[u] = open;
            }
        }
        scene_.cascade_depths.resize(std::size_t{4} * size * size);
        for (std::size_t i = 0; i < scene_.cascade_depths.size(); ++i) {
            const bool lit = open_[i % size] || (i / size % size) % 64 < 8; // slots along both axes
            scene_.cascade_depths[i] = lit ? 1.0F : static_cast<float>(0.5 - roof_m / extent_m);
        }
    }

    [[nodiscard]] bool is_lit(const glm::dvec3& p) const {
        const double u = (0.5 + (p.x + 0.5 * p.y) / extent_m) * size;
        const double v = (0.5 + (p.z + 0.25 * p.y) / extent_m) * size;
        if (p.y >= roof_m || u < 0.0 || v < 0.0 || u >= size || v >= size) {
            return true;
        }
        return open_[static_cast<std::size_t>(u)] || static_cast<std::uint32_t>(v) % 64 < 8;
    }

    /// Radiance along the ray of column (x, y) up to the range, with albedo 1 and the isotropic phase function.
    [[nodiscard]] double truth(std::uint32_t x, std::uint32_t y) const {
        const GridSettings& grid = scene_.inputs.settings.grid;
        const glm::dvec3 ray((2.0 * x / (grid.width - 1.0) - 1.0) * tan_x,
                             (1.0 - 2.0 * y / (grid.height - 1.0)) * tan_y, -1.0);
        const double range_m = static_cast<double>(grid.range_m);
        std::vector<double> edges{0.0, range_m, roof_m / ray.y};
        const double du = (ray.x + 0.5 * ray.y) / extent_m;
        const double dv = (ray.z + 0.25 * ray.y) / extent_m;
        for (std::uint32_t i = 0; i <= size; ++i) {
            edges.push_back((static_cast<double>(i) / size - 0.5) / du);
            edges.push_back((static_cast<double>(i) / size - 0.5) / dv);
        }
        std::erase_if(edges, [&](double z) { return !(z >= 0.0 && z <= range_m); });
        std::sort(edges.begin(), edges.end());
        const double per_depth = extinction * glm::length(ray);
        double sum = 0.0;
        for (std::size_t i = 1; i < edges.size(); ++i) {
            if (is_lit(ray * (0.5 * (edges[i - 1] + edges[i])))) {
                sum += std::exp(-per_depth * edges[i - 1]) - std::exp(-per_depth * edges[i]);
            }
        }
        return sum * 10.0 / (4.0 * pi);
    }

    [[nodiscard]] double relative_error(const VisibilitySettings& visibility) {
        scene_.inputs.settings.visibility = visibility;
        const Result result = render(scene_);
        const GridSettings& grid = scene_.inputs.settings.grid;
        const std::size_t last = std::size_t{grid.slices} * grid.width * grid.height;
        double error = 0.0;
        double total = 0.0;
        for (std::uint32_t y = 0; y < grid.height; ++y) {
            for (std::uint32_t x = 0; x < grid.width; ++x) {
                const double expected = truth(x, y);
                const double found = static_cast<double>(result.accumulated[last + y * grid.width + x].r);
                error += (found - expected) * (found - expected);
                total += expected * expected;
            }
        }
        omissions_ = result.omissions;
        return std::sqrt(error / total);
    }

    std::vector<std::string> omissions_;

private:
    Scene scene_;
    std::vector<bool> open_; ///< columns of the roof without roof
};

TEST_F(Shafts, TheLitFractionIsTenTimesAsExactAsOneTap) {
    const double one_tap = relative_error({.method = SunVisibility::one_tap});
    const double four_taps = relative_error({.method = SunVisibility::n_taps, .taps = 4});
    const double eight_taps = relative_error({.method = SunVisibility::n_taps, .taps = 8});
    const double prefiltered = relative_error({.method = SunVisibility::prefiltered});
    EXPECT_EQ(std::count(omissions_.begin(), omissions_.end(),
                         "ESM downsample and blur: fog looks the sun up in the cascades themselves"),
              0);
    const double lit_fraction = relative_error({.method = SunVisibility::lit_fraction});
    EXPECT_EQ(std::count(omissions_.begin(), omissions_.end(),
                         "ESM downsample and blur: fog looks the sun up in the cascades themselves"),
              1);
    std::printf("shafts, 64 slices, relative L2: one tap %.2e, 4 taps %.2e, 8 taps %.2e, prefiltered %.2e, lit "
                "fraction %.2e\n",
                one_tap, four_taps, eight_taps, prefiltered, lit_fraction);
    EXPECT_LE(lit_fraction, 5e-3);
    EXPECT_NEAR(one_tap, 5e-2, 2e-2);
    EXPECT_LE(four_taps, 0.5 * one_tap);
    EXPECT_LE(eight_taps, four_taps);
}

} // namespace
} // namespace tyndall::volumetrics::test
