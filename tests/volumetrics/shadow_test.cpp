// The exponential shadow map against double precision, and the sun's shadow in the fog.
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

/// ln of the filtered e^(k z), all in double: box over the texels of an ESM texel, then 1 4 6 4 1 in both directions.
class EsmReference {
public:
    EsmReference(const Scene& scene, std::uint32_t size, std::uint32_t layer) : size_(static_cast<int>(size)) {
        const int ratio = static_cast<int>(scene.cascade_size) / size_;
        const double k = static_cast<double>(scene.inputs.settings.shadow.esm_exponent[layer]);
        for (int y = 0; y < size_; ++y) {
            for (int x = 0; x < size_; ++x) {
                long double sum = 0.0L;
                for (int i = 0; i < ratio * ratio; ++i) {
                    const int sx = x * ratio + i % ratio;
                    const int sy = y * ratio + i / ratio;
                    const std::size_t at =
                        (static_cast<std::size_t>(layer) * scene.cascade_size + static_cast<std::size_t>(sy)) *
                            scene.cascade_size +
                        static_cast<std::size_t>(sx);
                    sum += std::exp(static_cast<long double>(k) * static_cast<long double>(scene.cascade_depths[at]));
                }
                texels_.push_back(sum / (ratio * ratio));
            }
        }
        blur(1, 0);
        blur(0, 1);
    }
    [[nodiscard]] double log_at(int x, int y) const { return static_cast<double>(std::log(at(x, y))); }

private:
    [[nodiscard]] long double at(int x, int y) const {
        return texels_[static_cast<std::size_t>(std::clamp(y, 0, size_ - 1)) * static_cast<std::size_t>(size_) +
                       static_cast<std::size_t>(std::clamp(x, 0, size_ - 1))];
    }
    void blur(int dx, int dy) {
        const long double weights[] = {1, 4, 6, 4, 1};
        std::vector<long double> result;
        for (int y = 0; y < size_; ++y) {
            for (int x = 0; x < size_; ++x) {
                long double sum = 0.0L;
                for (int i = -2; i <= 2; ++i) {
                    sum += weights[i + 2] / 16.0L * at(x + i * dx, y + i * dy);
                }
                result.push_back(sum);
            }
        }
        texels_ = result;
    }
    int size_;
    std::vector<long double> texels_; ///< 80-bit: e^1000 fits
};

/// By size of a cascade.
class EsmTest : public FogTest, public testing::WithParamInterface<std::uint32_t> {};

TEST_P(EsmTest, DownsampleAndBlurMatchDoublePrecisionUpToTheLargestExponent) {
    Scene scene = sunlit_scene(64.0F);
    scene.cascade_size = GetParam();
    scene.inputs.settings.shadow.esm_size = 32;
    scene.inputs.settings.shadow.esm_exponent = {1.0F, 80.0F, 400.0F, 1000.0F};
    std::mt19937 random(7);
    std::uniform_real_distribution<float> depth(0.0F, 1.0F);
    scene.cascade_depths.resize(std::size_t{4} * scene.cascade_size * scene.cascade_size);
    for (std::size_t i = 0; i < scene.cascade_depths.size(); ++i) {
        // Steps as at silhouettes on the left, noise on the right.
        const bool left = i % scene.cascade_size < scene.cascade_size / 2;
        scene.cascade_depths[i] = left ? (i / 97 % 2 == 0 ? 0.25F : 1.0F) : depth(random);
    }
    const Result result = render(scene);
    ASSERT_EQ(result.esm.size(), std::size_t{4} * 32 * 32);
    for (std::uint32_t layer = 0; layer < 4; ++layer) {
        const EsmReference reference(scene, 32, layer);
        double worst = 0.0;
        for (int y = 0; y < 32; ++y) {
            for (int x = 0; x < 32; ++x) {
                const double found = static_cast<double>(
                    result.esm[(layer * 32 + static_cast<std::uint32_t>(y)) * 32 + static_cast<std::uint32_t>(x)]);
                ASSERT_TRUE(std::isfinite(found));
                worst = std::max(worst, std::abs(found - reference.log_at(x, y)));
            }
        }
        // An error of 1e-3 in the logarithm is one of 0.1 % in visibility.
        EXPECT_LE(worst, 1e-3) << "cascade " << layer;
    }
}

INSTANTIATE_TEST_SUITE_P(FootprintsOfWholeGathers, EsmTest, testing::Values(64U, 128U, 192U));

/// Centre of a froxel in render space (the camera looks along -Z).
glm::dvec3 froxel_centre(const Scene& scene, std::uint32_t x, std::uint32_t y, std::uint32_t slice) {
    const GridSettings& grid = scene.inputs.settings.grid;
    const double s = static_cast<double>(grid.shape_m);
    const double ratio = 1.0 + static_cast<double>(grid.range_m) / s;
    const auto boundary = [&](double k) { return s * (std::pow(ratio, k / grid.slices) - 1.0); };
    const double depth_m = 0.5 * (boundary(slice) + boundary(slice + 1.0));
    return {(2.0 * x / (grid.width - 1.0) - 1.0) * tan_x * depth_m,
            (1.0 - 2.0 * y / (grid.height - 1.0)) * tan_y * depth_m, -depth_m};
}

class SunShadow : public FogTest {};

TEST_F(SunShadow, HalfSpaceUnderARoofIsDarkAndTheRestIsLit) {
    Scene scene = sunlit_scene(140.0F);
    scene.cascade_size = 256;
    scene.cascade_depths.assign(std::size_t{4} * 256 * 256, 1.0F);
    const double roof_m = 40.0; // above everything that the camera sees, over x < 0
    for (std::size_t i = 0; i < scene.cascade_depths.size(); ++i) {
        if (i % 256 < 128) {
            scene.cascade_depths[i] = static_cast<float>(0.5 - roof_m / 140.0);
        }
    }
    const Result result = render(scene);
    const double lit = 10.0 / (4.0 * 3.14159265358979);
    std::size_t dark_count = 0;
    std::size_t lit_count = 0;
    for (std::uint32_t i = 0; i < result.in_scattered.size(); ++i) {
        const glm::dvec3 centre = froxel_centre(scene, i % 160, i / 160 % 90, i / (160 * 90));
        const double found = static_cast<double>(result.in_scattered[i].r) / lit;
        // ESM texels are 140 / 128 m wide; the blur reaches 2.5 of them beyond the edge.
        if (centre.x < -4.0) {
            ++dark_count;
            ASSERT_LE(found, 1e-4) << centre.x << " " << centre.y << " " << centre.z;
        } else if (centre.x > 4.0) {
            ++lit_count;
            ASSERT_NEAR(found, 1.0, 1e-4) << centre.x << " " << centre.y << " " << centre.z;
        }
    }
    EXPECT_GT(dark_count, 100000U);
    EXPECT_GT(lit_count, 100000U);
}

TEST_F(SunShadow, IsTheBilinearMeanOfTheFourTexelsAround) {
    constexpr double extent_m = 140.0;
    Scene scene = sunlit_scene(static_cast<float>(extent_m));
    scene.inputs.settings.grid = {.width = 40, .height = 23, .slices = 16, .range_m = 64.0F, .shape_m = 16.0F};
    scene.inputs.settings.shadow.esm_size = 32;
    scene.inputs.settings.shadow.esm_exponent = {40.0F, 40.0F, 40.0F, 40.0F};
    std::mt19937 random(5);
    std::uniform_real_distribution<float> depth(0.4F, 0.6F);
    for (float& texel : scene.cascade_depths) {
        texel = depth(random);
    }
    const std::size_t layer = std::size_t{scene.cascade_size} * scene.cascade_size;
    for (std::size_t i = layer; i < scene.cascade_depths.size(); ++i) {
        scene.cascade_depths[i] = scene.cascade_depths[i - layer];
    }
    const Result result = render(scene);
    const EsmReference reference(scene, 32, 0);
    for (std::uint32_t i = 0; i < result.in_scattered.size(); ++i) {
        const glm::dvec3 p = froxel_centre(scene, i % 40, i / 40 % 23, i / (40 * 23));
        const double x = (0.5 + p.x / extent_m) * 32.0 - 0.5;
        const double y = (0.5 + p.z / extent_m) * 32.0 - 0.5;
        const auto texel = [&](int dx, int dy) {
            const double log =
                reference.log_at(static_cast<int>(std::floor(x)) + dx, static_cast<int>(std::floor(y)) + dy);
            return std::exp(log - 40.0 * std::clamp(0.5 - p.y / extent_m, 0.0, 1.0));
        };
        const double fx = x - std::floor(x);
        const double fy = y - std::floor(y);
        const double expected = std::min(1.0, (1.0 - fy) * ((1.0 - fx) * texel(0, 0) + fx * texel(1, 0)) +
                                                  fy * ((1.0 - fx) * texel(0, 1) + fx * texel(1, 1)));
        const double found = static_cast<double>(result.in_scattered[i].r) * 4.0 * 3.14159265358979 / 10.0;
        ASSERT_NEAR(found, expected, 2e-3) << p.x << " " << p.y << " " << p.z;
    }
}

/// Stripes across the view: how much of a slice they light does not depend on x and y.
Scene striped_scene(std::uint32_t width, std::uint32_t height) {
    Scene scene = sunlit_scene(140.0F);
    scene.inputs.settings.grid = {.width = width, .height = height, .slices = 16, .range_m = 64.0F, .shape_m = 16.0F};
    scene.inputs.settings.visibility.method = SunVisibility::lit_fraction;
    for (std::size_t i = 0; i < scene.cascade_depths.size(); ++i) {
        scene.cascade_depths[i] = i / scene.cascade_size % scene.cascade_size % 3 == 0 ? 0.0F : 1.0F;
    }
    return scene;
}

TEST_F(SunShadow, LitFractionIsThatOfTheSliceWhereverItsSampleLies) {
    Scene scene = striped_scene(16, 9);
    const Result at_centres = render(scene);
    scene.inputs.settings.temporal.jitter = true;
    const Result jittered = render(scene);
    for (std::size_t i = 0; i < jittered.in_scattered.size(); ++i) {
        ASSERT_NEAR(jittered.in_scattered[i].r, at_centres.in_scattered[i].r, 1e-3F) << i;
    }
}

TEST_F(SunShadow, SamplesLieEvenlyOverTheirSlices) {
    Scene scene = striped_scene(64, 36);
    const Result exact = render(scene);
    scene.inputs.settings.visibility.method = SunVisibility::one_tap;
    scene.inputs.settings.temporal.jitter = true;
    const Result sampled = render(scene);
    constexpr std::size_t columns = 64 * 36;
    for (std::size_t slice = 0; slice < 16; ++slice) {
        double mean = 0.0;
        for (std::size_t i = slice * columns; i < (slice + 1) * columns; ++i) {
            mean += static_cast<double>(sampled.in_scattered[i].r) / columns;
        }
        // Five times the standard error of as many random samples, of which each is lit or not.
        EXPECT_NEAR(mean, static_cast<double>(exact.in_scattered[slice * columns].r), 0.05 * 10.0 / (4.0 * 3.14159265))
            << slice;
    }
}

TEST_F(SunShadow, SlicesThatReachBeyondTheirCascadeLetNoLightIn) {
    // Dark as far as the map reaches, 10 m around the eye; the slices there are 3 m long.
    Scene scene = sunlit_scene(20.0F);
    scene.inputs.settings.grid = {.width = 16, .height = 9, .slices = 16, .range_m = 64.0F, .shape_m = 16.0F};
    scene.cascade_depths.assign(scene.cascade_depths.size(), 0.0F);
    for (const SunVisibility method : {SunVisibility::lit_fraction, SunVisibility::n_taps}) {
        scene.inputs.settings.visibility.method = method;
        const Result result = render(scene);
        std::size_t dark = 0;
        for (std::uint32_t i = 0; i < result.in_scattered.size(); ++i) {
            const glm::dvec3 p = glm::abs(froxel_centre(scene, i % 16, i / 16 % 9, i / (16 * 9)));
            if (std::max({p.x, p.y, p.z}) < 9.9) {
                ++dark;
                ASSERT_EQ(result.in_scattered[i].r, 0.0F) << p.x << " " << p.y << " " << p.z;
            } else if (std::max(p.x, p.z) > 10.1) {
                ASSERT_NEAR(result.in_scattered[i].r, 10.0F / (4.0F * 3.14159265F), 1e-4F);
            }
        }
        EXPECT_GT(dark, 100U);
    }
}

TEST_F(SunShadow, PointsAboveTheOccluderAreLit) {
    Scene scene = sunlit_scene(140.0F);
    scene.cascade_depths.assign(scene.cascade_depths.size(), 0.5F); // a floor at the camera's height, everywhere
    const Result result = render(scene);
    const double lit = 10.0 / (4.0 * 3.14159265358979);
    for (std::uint32_t i = 0; i < result.in_scattered.size(); ++i) {
        const glm::dvec3 centre = froxel_centre(scene, i % 160, i / 160 % 90, i / (160 * 90));
        const double expected = centre.y >= 0.0 ? 1.0 : std::exp(400.0 * centre.y / 140.0);
        ASSERT_NEAR(static_cast<double>(result.in_scattered[i].r) / lit, expected, 2e-3) << centre.y;
    }
}

TEST_F(SunShadow, CascadesAreChosenByDepthAndNothingIsShadowedOutside) {
    Scene scene = sunlit_scene(140.0F);
    const std::size_t layer = std::size_t{scene.cascade_size} * scene.cascade_size;
    // Cascades 0 and 2 are dark, 1 and 3 lit; the fourth ends at 48 m, beyond which there is none.
    std::fill_n(scene.cascade_depths.begin(), layer, 0.0F);
    std::fill_n(scene.cascade_depths.begin() + static_cast<std::ptrdiff_t>(2 * layer), layer, 0.0F);
    scene.cascades.split_depth_m = {8.0F, 16.0F, 32.0F, 48.0F};
    const Result result = render(scene);
    for (std::uint32_t slice = 0; slice < 64; ++slice) {
        const std::uint32_t at = (slice * 90 + 45) * 160 + 80;
        const double depth_m = -froxel_centre(scene, 80, 45, slice).z;
        const bool dark = depth_m < 8.0 || (depth_m > 16.0 && depth_m < 32.0);
        const double visibility = static_cast<double>(result.in_scattered[at].r) * 4.0 * 3.14159265358979 / 10.0;
        EXPECT_NEAR(visibility, dark ? 0.0 : 1.0, 1e-3) << depth_m;
    }
}

TEST_F(SunShadow, IsLeftOutWithAReason) {
    Scene scene = plain_scene();
    scene.inputs.medium.homogeneous.extinction_per_m = 0.01F;
    scene.inputs.sun = Sun{.illuminance_lux = glm::vec3(10.0F), .casts_shadows = false};
    Result result = render(scene);
    const auto has = [&](const char* text) {
        return std::find(result.omissions.begin(), result.omissions.end(), text) != result.omissions.end();
    };
    EXPECT_TRUE(has("sun shadows (ESM downsample and blur): the sun casts no shadow"));
    EXPECT_TRUE(has("light clustering: there is no local light"));
    EXPECT_TRUE(has("density noise: its amplitude is 0"));
    EXPECT_TRUE(has("temporal reprojection: it is switched off"));
    EXPECT_EQ(std::find(result.pass_names.begin(), result.pass_names.end(), "ESM downsample"), result.pass_names.end());
    scene.inputs.sun.reset();
    result = render(scene);
    EXPECT_TRUE(has("sun shadows (ESM downsample and blur): there is no sun"));
}

} // namespace
} // namespace tyndall::volumetrics::test
