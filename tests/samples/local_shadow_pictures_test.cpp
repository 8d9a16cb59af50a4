// Shadows of local lights on surfaces: the whole tool against the double-precision reference, from the same glTF.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "engine/image_io.hpp"
#include "samples/precision/scene.hpp"
#include "tests/engine/gltf_fixture.hpp"
#include "tests/samples/tool_process.hpp"

namespace tyndall::test {
namespace {

namespace reference = volumetrics::reference;
using engine::test::GltfFile;
using engine::test::json;
using samples::make_box;
using samples::make_room;

constexpr std::uint32_t width = 320;
constexpr std::uint32_t height = 180;

class LocalShadowPictures : public ::testing::Test {
protected:
    void SetUp() override {
        folder_ = fresh_folder();
        scene_.camera.fov_y_rad = 0.9;
        scene_.surfaces = {make_room({-5.0, -2.0, -12.0}, {5.0, 4.0, 1.0}, glm::dvec3(0.6))};
        file_.add("cameras",
                  {{"type", "perspective"},
                   {"perspective",
                    {{"yfov", scene_.camera.fov_y_rad}, {"aspectRatio", double{width} / height}, {"znear", 0.1}}}});
        file_.add("nodes", {{"camera", 0}});
        for (const char* name : {"KHR_lights_punctual", "KHR_materials_specular"}) {
            file_.root["extensionsUsed"].push_back(name);
        }
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    void add_surface(const samples::Surface& surface, double alpha = 1.0) {
        std::vector<float> positions;
        std::vector<float> normals;
        std::vector<std::uint16_t> indices;
        for (const auto& quad : surface.quads) {
            const auto first = static_cast<std::uint16_t>(positions.size() / 3);
            const glm::dvec3 normal = glm::normalize(glm::cross(quad[1] - quad[0], quad[2] - quad[0]));
            for (const glm::dvec3& corner : quad) {
                for (int i = 0; i < 3; ++i) {
                    positions.push_back(static_cast<float>(corner[i]));
                    normals.push_back(static_cast<float>(normal[i]));
                }
            }
            for (const int corner : {0, 1, 2, 0, 2, 3}) {
                indices.push_back(static_cast<std::uint16_t>(first + corner));
            }
        }
        const glm::dvec3& albedo = surface.albedo;
        file_.add_shown_mesh(
            {{"attributes",
              {{"POSITION", file_.add_accessor(positions, "VEC3", engine::test::type_float)},
               {"NORMAL", file_.add_accessor(normals, "VEC3", engine::test::type_float)}}},
             {"indices", file_.add_accessor(indices, "SCALAR", engine::test::type_unsigned_short)},
             {"material",
              file_.add("materials", {{"pbrMetallicRoughness",
                                       {{"baseColorFactor", {albedo.x, albedo.y, albedo.z, alpha}},
                                        {"metallicFactor", 0.0},
                                        {"roughnessFactor", 1.0}}},
                                      {"doubleSided", true},
                                      {"alphaMode", alpha < 1.0 ? "BLEND" : "OPAQUE"},
                                      {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0.0}}}}}})}});
    }

    /// A light of 100 cd; `extras` as in the file.
    void add_light(const reference::Light& light, const json& extras) {
        json node = {{"translation", {light.position.x, light.position.y, light.position.z}}};
        json described = {{"type", light.cone ? "spot" : "point"}, {"intensity", 100.0}, {"range", light.range_m}};
        if (light.cone) {
            described["spot"] = {{"innerConeAngle", light.cone->inner_rad}, {"outerConeAngle", light.cone->outer_rad}};
            // The rotation that turns -z into the direction.
            const glm::dvec3 d = light.cone->direction;
            const glm::dvec3 axis = glm::cross(glm::dvec3(0.0, 0.0, -1.0), d);
            const double w = 1.0 - d.z;
            const double norm = std::hypot(glm::length(axis), w);
            node["rotation"] = {axis.x / norm, axis.y / norm, axis.z / norm, w / norm};
        }
        if (!extras.empty()) {
            described["extras"] = extras;
        }
        json& lights = file_.root["extensions"]["KHR_lights_punctual"]["lights"];
        lights.push_back(std::move(described));
        node["extensions"]["KHR_lights_punctual"]["light"] = lights.size() - 1;
        file_.add("nodes", std::move(node));
    }

    [[nodiscard]] engine::Pixels<float> render(const std::vector<std::string>& more) {
        write_text(folder_ / "scene.gltf", file_.text());
        std::vector<std::string> arguments = {"render",     (folder_ / "scene.gltf").string(),
                                              "--size",     std::to_string(width) + "x" + std::to_string(height),
                                              "--validate", "--fp32",
                                              "--frames",   "2",
                                              "--out",      (folder_ / "out.exr").string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const ToolRun run = run_tool(arguments);
        EXPECT_EQ(run.exit_code, 0) << run.errors;
        const auto image = engine::read_exr(folder_ / "out.exr");
        EXPECT_TRUE(image.has_value());
        return image.value_or(engine::Pixels<float>{});
    }

    /// Each pixel lies, to 1 %, between the darkest and the brightest that the exact picture has beside it: neither
    /// dots on lit surfaces nor light behind walls, and edges in the right pixel. Returns the relative L2 error.
    [[nodiscard]] double compare(const engine::Pixels<float>& image) {
        const reference::ImageSize size{width, height};
        const std::vector<reference::Estimate> exact = reference::render(
            samples::reference_scene(scene_, {}), scene_.camera, size, reference::all_pixels(size), {1e-4, 0.0});
        const auto exact_at = [&](std::uint32_t x, std::uint32_t y) {
            return exact[std::size_t{y} * width + x].value.g;
        };
        double brightest = 0.0;
        for (const reference::Estimate& pixel : exact) {
            brightest = std::max(brightest, pixel.value.g);
        }
        std::size_t wrong = 0;
        double errors = 0.0;
        double squares = 0.0;
        dark_ = lit_ = 0;
        for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = 0; x < width; ++x) {
                double low = exact_at(x, y);
                double high = low;
                for (std::uint32_t v = std::max(y, 1U) - 1; v <= std::min(y + 1, height - 1); ++v) {
                    for (std::uint32_t u = std::max(x, 1U) - 1; u <= std::min(x + 1, width - 1); ++u) {
                        low = std::min(low, exact_at(u, v));
                        high = std::max(high, exact_at(u, v));
                    }
                }
                const double found = image.values[(std::size_t{y} * width + x) * image.channels + 1];
                const double slack = 0.01 * high + 1e-4 * brightest;
                if (!(found >= low - slack && found <= high + slack)) {
                    ++wrong;
                    if (wrong < 6) {
                        ADD_FAILURE() << "pixel " << x << ", " << y << ": " << found << ", not in " << low << " to "
                                      << high;
                    }
                }
                errors += (found - exact_at(x, y)) * (found - exact_at(x, y));
                squares += exact_at(x, y) * exact_at(x, y);
                ++(exact_at(x, y) == 0.0 ? dark_ : lit_);
            }
        }
        EXPECT_EQ(wrong, 0U);
        return std::sqrt(errors / squares);
    }

    void add_surfaces() {
        for (const samples::Surface& surface : scene_.surfaces) {
            add_surface(surface);
        }
    }

    std::filesystem::path folder_;
    GltfFile file_;
    samples::PrecisionScene scene_;
    std::size_t dark_ = 0; ///< pixels of the exact picture
    std::size_t lit_ = 0;
};

TEST_F(LocalShadowPictures, BoxesInTheLightOfASpot) {
    scene_.surfaces.push_back(make_box({-1.6, -2.0, -7.0}, {-0.6, 0.4, -6.0}, glm::dvec3(0.5)));
    scene_.surfaces.push_back(make_box({0.8, -0.9, -9.0}, {2.6, -0.4, -6.5}, glm::dvec3(0.7)));
    scene_.surfaces.push_back(make_box({0.2, 0.2, -5.02}, {0.8, 0.9, -5.0}, glm::dvec3(0.7))); // a board
    reference::Light light{.position = {-2.5, 3.2, -2.0}, .intensity_cd = glm::dvec3(100.0), .range_m = 30.0};
    light.cone = reference::Cone{glm::normalize(glm::dvec3(0.45, -0.5, -0.8)), 0.4, 0.75};
    scene_.lights = {light};
    add_surfaces();
    add_light(light, {});
    const double error = compare(render({}));
    std::printf("boxes in the light of a spot: %.2f %%, %zu pixels dark\n", 100.0 * error, dark_);
    EXPECT_GT(dark_, 5000U);
    EXPECT_GT(lit_, 20000U);
    EXPECT_LE(error, 0.04);
}

// The sides of the cube meet on every wall. What stands about the light within the near distance, its lantern say,
// casts no shadow.
TEST_F(LocalShadowPictures, BoxesAroundAPointLight) {
    scene_.surfaces.push_back(make_box({-2.2, -2.0, -8.4}, {-1.4, 1.0, -7.6}, glm::dvec3(0.5)));
    scene_.surfaces.push_back(make_box({1.4, -0.7, -9.0}, {3.0, -0.3, -6.5}, glm::dvec3(0.7)));
    scene_.surfaces.push_back(make_box({-0.9, 1.8, -9.5}, {-0.2, 2.2, -6.0}, glm::dvec3(0.7)));
    scene_.lights = {{.position = {0.4, 0.6, -7.3}, .intensity_cd = glm::dvec3(100.0), .range_m = 30.0}};
    add_surfaces();
    const GltfFile unlit = file_;
    add_light(scene_.lights[0], {{"shadow", true}});
    const engine::Pixels<float> image = render({});
    const double error = compare(image);
    std::printf("boxes around a point light: %.2f %%, %zu pixels dark\n", 100.0 * error, dark_);
    EXPECT_GT(dark_, 2000U);
    EXPECT_GT(lit_, 20000U);
    EXPECT_LE(error, 0.05);

    // How many pixels a lid above the light makes darker.
    const auto darkened = [&](double near_m) {
        file_ = unlit;
        add_surface(make_box({0.3, 0.65, -7.4}, {0.5, 0.7, -7.2}, glm::dvec3(0.0)));
        add_light(scene_.lights[0], {{"shadow", true}, {"shadow_near_m", near_m}});
        const engine::Pixels<float> with_lid = render({});
        std::size_t count = 0;
        for (std::size_t i = 1; i < image.values.size(); i += image.channels) {
            count += with_lid.values[i] < 0.9F * image.values[i] ? 1U : 0U;
        }
        return count;
    };
    EXPECT_LT(darkened(0.2), 100U);    // the lid itself
    EXPECT_GT(darkened(0.001), 3000U); // and the ceiling
}

TEST_F(LocalShadowPictures, WallsKeepTheLightOut) {
    scene_.surfaces.push_back(make_box({-5.0, -2.0, -5.0}, {5.0, 4.0, -4.99}, glm::dvec3(0.5))); // a wall across
    reference::Light light{.position = {0.0, 0.0, -11.0}, .intensity_cd = glm::dvec3(100.0), .range_m = 30.0};
    light.cone = reference::Cone{glm::normalize(glm::dvec3(0.1, 0.05, 1.0)), 0.4, 0.75};
    add_surfaces();
    add_light(light, {});
    const engine::Pixels<float> image = render({});
    for (std::size_t i = 0; i < image.values.size(); i += image.channels) {
        ASSERT_EQ(image.values[i], 0.0F) << "pixel " << i / image.channels;
    }
}

// Panes, fog, several queues: every variant of what binds the maps, under the validation layer.
TEST_F(LocalShadowPictures, EveryKindOfFrameIsValid) {
    reference::Light spot{.position = {-2.5, 3.2, -2.0}, .intensity_cd = glm::dvec3(100.0), .range_m = 30.0};
    spot.cone = reference::Cone{glm::normalize(glm::dvec3(0.45, -0.5, -0.8)), 0.4, 0.75};
    add_surfaces();
    add_surface(make_box({0.2, 0.2, -5.02}, {0.9, 0.9, -5.0}, glm::dvec3(0.7)), 0.5);
    add_light(spot, {});
    write_text(folder_ / "fog.json", R"({"medium":{"homogeneous":{"extinction_per_m":0.06}}})");
    const std::vector<std::string> fog = {"--fog", (folder_ / "fog.json").string()};
    (void)render({});
    (void)render(fog);
    add_light({.position = {1.0, 2.0, -6.0}, .range_m = 20.0}, {{"shadow", true}});
    add_light({.position = {2.0, 1.0, -4.0}, .range_m = 20.0}, {});
    (void)render({fog[0], fog[1], "--queues", "two"});
}

} // namespace
} // namespace tyndall::test
