// Fog behind casters in the light of spot and point lights: maps that the test fills by intersecting rays with boxes,
// and froxels that must be dark or lit as the way to the light says, all in double precision.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "tests/volumetrics/fog_fixture.hpp"

namespace tyndall::volumetrics::test {
namespace {

struct Box {
    glm::dvec3 low;
    glm::dvec3 high;
};

/// Part of the way along `d` at which a ray from `from` enters the box; infinity where it passes by. It does not begin
/// inside.
double entry(const Box& box, const glm::dvec3& from, const glm::dvec3& d) {
    double enter = 0.0;
    double leave = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
        if (d[i] == 0.0) {
            if (from[i] < box.low[i] || from[i] > box.high[i]) {
                return std::numeric_limits<double>::infinity();
            }
            continue;
        }
        const double a = (box.low[i] - from[i]) / d[i];
        const double b = (box.high[i] - from[i]) / d[i];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return enter < leave ? enter : std::numeric_limits<double>::infinity();
}

/// Where a map looks: x and y across, z along its view; uv - 0.5 is `scale` times x / z.
struct MapView {
    glm::dmat3 axes; ///< columns x, y, z in the world
    double scale = 0.5;
};

class LocalShadow : public FogTest {
protected:
    static constexpr std::uint32_t size = 256;
    static constexpr double near_distance_m = 0.1;
    const std::vector<Box> boxes_{{{-1.6, -3.0, -9.0}, {-0.8, 3.0, -8.2}},
                                  {{1.2, 0.9, -12.0}, {2.8, 1.5, -7.0}},
                                  {{-6.0, -1.0, -20.0}, {-3.0, -0.5, -4.0}},
                                  {{0.2, -2.2, -6.0}, {0.9, -1.2, -5.2}}};

    void SetUp() override {
        FogTest::SetUp();
        scene_ = plain_scene();
        scene_.inputs.medium.homogeneous = {.extinction_per_m = 0.01F, .albedo = glm::vec3(1.0F)};
        scene_.inputs.settings.grid = {.width = 80, .height = 46, .slices = 32, .range_m = 25.0F, .shape_m = 25.0F};
        scene_.local_shadow_size = size;
    }

    /// What the nearest box leaves of each texel's ray.
    void draw(const glm::dvec3& light, const MapView& view) {
        for (std::uint32_t y = 0; y < size; ++y) {
            for (std::uint32_t x = 0; x < size; ++x) {
                const glm::dvec3 ray = view.axes * glm::dvec3(((x + 0.5) / size - 0.5) / view.scale,
                                                              ((y + 0.5) / size - 0.5) / view.scale, 1.0);
                double z = std::numeric_limits<double>::infinity();
                for (const Box& box : boxes_) {
                    z = std::min(z, entry(box, light, ray));
                }
                scene_.local_depths.push_back(static_cast<float>(near_distance_m / std::max(z, near_distance_m)));
            }
        }
    }

    void add_light(const glm::vec3& position, const MapView* spot) {
        const std::size_t maps = scene_.local_depths.size() / (size * size);
        const auto layer = static_cast<float>(maps);
        gpu::GpuLight light{.position_range = glm::vec4(position, 40.0F),
                            .intensity_type = glm::vec4(100.0F, 100.0F, 100.0F, spot != nullptr ? 1.0F : 0.0F),
                            .direction_radius = {0.0F, -1.0F, 0.0F, 0.0F},
                            .cone = {0.0F, 1.0F, static_cast<float>(scene_.local_shadows.size() + 1), 0.0F}};
        const double scale = spot != nullptr ? spot->scale : 0.5 * (1.0 - 4.0 / size);
        glm::dmat3 rows(1.0);
        if (spot != nullptr) {
            const double cos_outer = std::cos(std::atan(0.48 / spot->scale)); // a little within the map
            light.direction_radius = glm::vec4(glm::vec3(spot->axes[2]), 0.0F);
            light.cone.x = static_cast<float>(1.0 / (1.0 - cos_outer));
            light.cone.y = static_cast<float>(-cos_outer / (1.0 - cos_outer));
            rows = glm::transpose(spot->axes);
            draw(position, *spot);
        } else {
            const glm::dvec3 x(1.0, 0.0, 0.0);
            const glm::dvec3 y(0.0, 1.0, 0.0);
            const glm::dvec3 z(0.0, 0.0, 1.0);
            const std::array<glm::dmat3, 6> sides{glm::dmat3(y, z, x),  glm::dmat3(y, z, -x), glm::dmat3(z, x, y),
                                                  glm::dmat3(z, x, -y), glm::dmat3(x, y, z),  glm::dmat3(x, y, -z)};
            for (const glm::dmat3& side : sides) {
                draw(position, {side, scale});
            }
        }
        const glm::dvec3 moved = rows * -glm::dvec3(position);
        const auto row = [&](int i) { return glm::vec4(glm::dvec4(rows[0][i], rows[1][i], rows[2][i], moved[i])); };
        scene_.lights.push_back(light);
        scene_.local_shadows.push_back({.row_x = row(0),
                                        .row_y = row(1),
                                        .row_z = row(2),
                                        .lens = glm::vec4(scale, near_distance_m, layer, spot != nullptr ? 0.0F : 1.0F),
                                        .texel = glm::vec4(1.0 / (scale * size), size, 1.0 / size, 0.0)});
    }

    [[nodiscard]] glm::dvec3 froxel_centre(std::uint32_t x, std::uint32_t y, std::uint32_t k) const {
        const GridSettings& grid = scene_.inputs.settings.grid;
        const double s = static_cast<double>(grid.shape_m);
        const auto boundary = [&](double i) {
            return s * (std::pow(1.0 + static_cast<double>(grid.range_m) / s, i / grid.slices) - 1.0);
        };
        return glm::dvec3((2.0 * x / (grid.width - 1.0) - 1.0) * tan_x, (1.0 - 2.0 * y / (grid.height - 1.0)) * tan_y,
                          -1.0) *
               (0.5 * (boundary(k) + boundary(k + 1.0)));
    }

    [[nodiscard]] bool is_dark(const glm::dvec3& point, const glm::dvec3& light, double grown_m) const {
        return std::any_of(boxes_.begin(), boxes_.end(), [&](Box box) {
            box.low -= grown_m;
            box.high += grown_m;
            return entry(box, light, point - light) < 1.0;
        });
    }

    /// Of the froxels whose shadow is certain, the numbers of dark and of lit ones; wrong ones fail the test.
    [[nodiscard]] std::array<std::size_t, 2> check(const Result& with, const Result& without) {
        const GridSettings& grid = scene_.inputs.settings.grid;
        const glm::dvec3 light(scene_.lights[0].position_range);
        std::array<std::size_t, 2> counts{};
        std::size_t wrong = 0;
        for (std::uint32_t k = 0; k < grid.slices; ++k) {
            for (std::uint32_t y = 0; y < grid.height; ++y) {
                for (std::uint32_t x = 0; x < grid.width; ++x) {
                    const std::size_t i = (std::size_t{k} * grid.height + y) * grid.width + x;
                    const glm::dvec3 point = froxel_centre(x, y, k);
                    // A texel is no wider than this where the boxes are.
                    const double margin_m = 2.0 / (size * 0.4) * 12.0;
                    const bool dark = is_dark(point, light, -margin_m);
                    if (without.in_scattered[i].r == 0.0F || dark != is_dark(point, light, margin_m)) {
                        continue;
                    }
                    const float expected = dark ? 0.0F : without.in_scattered[i].r;
                    wrong += with.in_scattered[i].r == expected ? 0U : 1U;
                    ++counts[dark ? 0 : 1];
                }
            }
        }
        EXPECT_EQ(wrong, 0U) << "of " << counts[0] << " dark and " << counts[1] << " lit";
        return counts;
    }

    [[nodiscard]] Result render_without() {
        Scene open = scene_;
        for (gpu::GpuLight& light : open.lights) {
            light.cone.z = 0.0F;
        }
        open.inputs.cut = true;
        return render(open);
    }

    Scene scene_;
};

bool has(const std::vector<std::string>& list, const std::string& sentence) {
    return std::find(list.begin(), list.end(), sentence) != list.end();
}

TEST_F(LocalShadow, FogBehindPillarsIsDarkInTheLightOfASpot) {
    const glm::dvec3 z = glm::normalize(glm::dvec3(0.1, -0.15, -1.0));
    const glm::dvec3 x = glm::normalize(glm::cross(glm::dvec3(0.0, 1.0, 0.0), z));
    const MapView view{glm::dmat3(x, glm::cross(z, x), z), 0.5};
    add_light({0.4F, 1.2F, -2.0F}, &view);
    const Result with = render(scene_);
    const auto [dark, lit] = check(with, render_without());
    std::printf("spot: %zu froxels dark, %zu lit\n", dark, lit);
    EXPECT_GT(dark, 2000U);
    EXPECT_GT(lit, 10000U);
    EXPECT_FALSE(has(with.omissions, "shadows of local lights: no local light casts one"));
}

TEST_F(LocalShadow, FogBehindPillarsIsDarkOnAllSidesOfAPointLight) {
    for (const glm::vec3 position : {glm::vec3(0.4F, 0.1F, -6.5F), glm::vec3(-2.2F, -2.5F, -12.0F)}) {
        scene_.lights.clear();
        scene_.local_shadows.clear();
        scene_.local_depths.clear();
        add_light(position, nullptr);
        const auto [dark, lit] = check(render(scene_), render_without());
        std::printf("point: %zu froxels dark, %zu lit\n", dark, lit);
        EXPECT_GT(dark, 5000U);
        EXPECT_GT(lit, 40000U);
    }
}

TEST_F(LocalShadow, EachLightLooksIntoItsOwnMap) {
    const MapView down{glm::dmat3({1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, {0.0, -1.0, 0.0}), 0.4};
    add_light({-1.2F, 5.0F, -8.6F}, &down);
    add_light({0.4F, 0.1F, -6.5F}, nullptr);
    const Scene both = scene_;
    const Result sum = render(both);
    std::vector<Result> alone;
    for (std::size_t i = 0; i < 2; ++i) {
        scene_.lights = {both.lights[i]};
        scene_.inputs.cut = true;
        alone.push_back(render(scene_));
        const auto [dark, lit] = check(alone[i], render_without());
        EXPECT_GT(dark, 500U) << i;
        EXPECT_GT(lit, 1000U) << i;
    }
    std::size_t shared = 0;
    for (std::size_t i = 0; i < sum.in_scattered.size(); ++i) {
        const float a = alone[0].in_scattered[i].r;
        const float b = alone[1].in_scattered[i].r;
        ASSERT_NEAR(sum.in_scattered[i].r, a + b, 1e-5F * (a + b));
        shared += a > 0.0F && b > 0.0F ? 1U : 0U;
    }
    EXPECT_GT(shared, 500U);
}

TEST_F(LocalShadow, NothingWithinTheNearDistanceCastsAShadow) {
    add_light({0.4F, 0.1F, -6.5F}, nullptr);
    std::fill(scene_.local_depths.begin(), scene_.local_depths.end(), 1.0F); // casters at the near distance itself
    const Result with = render(scene_);
    const Result without = render_without();
    std::size_t lit = 0;
    for (std::size_t i = 0; i < with.in_scattered.size(); ++i) {
        lit += with.in_scattered[i].r > 0.0F ? 1U : 0U;
    }
    EXPECT_LT(lit, 10U); // those beside the light

    scene_.local_shadows[0].lens.y = 100.0F; // all of the view
    scene_.inputs.cut = true;
    EXPECT_EQ(render(scene_).in_scattered, without.in_scattered);
}

TEST_F(LocalShadow, AreLeftOutWithAReason) {
    add_light({0.4F, 0.1F, -6.5F}, nullptr);
    EXPECT_TRUE(has(render_without().omissions, "shadows of local lights: no local light casts one"));
    scene_.lights.clear();
    EXPECT_TRUE(has(render(scene_).omissions, "shadows of local lights: there is no local light"));
}

TEST_F(LocalShadow, MapsMustBeGivenWhereALightCastsShadows) {
    scene_.lights = {{.position_range = {0.0F, 0.0F, -5.0F, 10.0F},
                      .intensity_type = {1.0F, 1.0F, 1.0F, 0.0F},
                      .direction_radius = {0.0F, -1.0F, 0.0F, 0.0F},
                      .cone = {0.0F, 1.0F, 1.0F, 0.0F}}};
    scene_.inputs.image_size = scene_.image;
    scene_.inputs.lights = scene_.lights;
    rg::GraphBuilder graph;
    ASSERT_TRUE(feature().begin_frame(scene_.inputs));
    const rg::Buffer lights = graph.create_buffer("lights", {.size_bytes = sizeof(gpu::GpuLight)});
    ASSERT_TRUE(feature().declare_frame_begin(graph, {.lights = lights}));
    const auto declared = feature().declare_after_shadow_maps(graph, {});
    ASSERT_FALSE(declared);
    EXPECT_EQ(declared.error().message, "A local light casts shadows (GpuLight::cone.z), so declare_after_shadow_maps "
                                        "needs local_maps and local_records.");
}

} // namespace
} // namespace tyndall::volumetrics::test
