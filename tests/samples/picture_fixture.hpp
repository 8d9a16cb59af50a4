// Scenes of a few rectangles and lights before a camera at the origin, through the whole tool: glTF in, linear EXR out.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/image_io.hpp"
#include "tests/engine/gltf_fixture.hpp"
#include "tests/samples/tool_process.hpp"

namespace tyndall::test {
using engine::test::GltfFile;
using engine::test::json;

inline constexpr std::uint32_t width = 320;
inline constexpr std::uint32_t height = 180;
inline constexpr double vertical_fov_rad = 0.8;

using Color = std::array<double, 3>;

/// Direction of the ray through a pixel's centre, at view depth 1. The camera is at the origin and looks along -z.
inline std::array<double, 3> ray(std::uint32_t x, std::uint32_t y) {
    const double slope = std::tan(0.5 * vertical_fov_rad);
    return {(2.0 * (x + 0.5) / width - 1.0) * slope * width / height, (1.0 - 2.0 * (y + 0.5) / height) * slope, -1.0};
}

inline double length(const std::array<double, 3>& v) {
    return std::hypot(v[0], v[1], v[2]);
}

class ClosedFormPictures : public ::testing::Test {
protected:
    void SetUp() override {
        folder_ = fresh_folder();
        file_.add("cameras", {{"type", "perspective"},
                              {"perspective",
                               {{"yfov", vertical_fov_rad}, {"aspectRatio", double{width} / height}, {"znear", 0.1}}}});
        file_.add("nodes", {{"camera", 0}});
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    /// A rectangle across the view, `half` wide to both sides of x, facing the camera.
    void add_rectangle(double x, double z, double half, json material) {
        const auto at = [](double v) { return static_cast<float>(v); };
        const std::vector<float> positions = {at(x - half), at(-half), at(z), at(x + half), at(-half), at(z),
                                              at(x + half), at(half),  at(z), at(x - half), at(half),  at(z)};
        const std::vector<float> normals = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
        const std::vector<std::uint16_t> indices = {0, 1, 2, 0, 2, 3};
        file_.add_shown_mesh({{"attributes",
                               {{"POSITION", file_.add_accessor(positions, "VEC3", engine::test::type_float)},
                                {"NORMAL", file_.add_accessor(normals, "VEC3", engine::test::type_float)}}},
                              {"indices", file_.add_accessor(indices, "SCALAR", engine::test::type_unsigned_short)},
                              {"material", file_.add("materials", std::move(material))}});
    }

    void add_light(json light, json node) {
        json& lights = file_.root["extensions"]["KHR_lights_punctual"]["lights"];
        lights.push_back(std::move(light));
        node["extensions"]["KHR_lights_punctual"]["light"] = lights.size() - 1;
        file_.add("nodes", std::move(node));
    }
    /// One that lights nothing in view: without any the tool would add a sun.
    void add_dark_light() { add_light({{"type", "point"}, {"range", 0.1}}, {{"translation", {0, 0, 50}}}); }

    [[nodiscard]] engine::Pixels<float> render(const std::vector<std::string>& more) {
        for (const char* name : {"KHR_lights_punctual", "KHR_materials_unlit", "KHR_materials_specular"}) {
            file_.root["extensionsUsed"].push_back(name);
        }
        write_text(folder_ / "scene.gltf", file_.text());
        file_.root.erase("extensionsUsed");
        std::vector<std::string> arguments = {"render",
                                              (folder_ / "scene.gltf").string(),
                                              "--size",
                                              std::to_string(width) + "x" + std::to_string(height),
                                              "--validate",
                                              "--frames",
                                              "2",
                                              "--out",
                                              (folder_ / "out.exr").string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const ToolRun run = run_tool(arguments);
        EXPECT_EQ(run.exit_code, 0) << run.errors;
        const auto image = engine::read_exr(folder_ / "out.exr");
        EXPECT_TRUE(image.has_value());
        return image.value_or(engine::Pixels<float>{});
    }

    /// The largest error of a channel, relative to `expected(x, y)`.
    template <typename Expected>
    static double largest_error(const engine::Pixels<float>& image, Expected&& expected) {
        EXPECT_EQ(image.values.size(), std::size_t{width} * height * image.channels);
        double largest = 0.0;
        for (std::uint32_t y = 0; y < image.height; ++y) {
            for (std::uint32_t x = 0; x < image.width; ++x) {
                const Color color = expected(x, y);
                for (std::size_t c = 0; c < 3; ++c) {
                    const double got = image.values[(std::size_t{y} * width + x) * image.channels + c];
                    largest = std::max(largest, std::abs(got - color[c]) / color[c]);
                }
            }
        }
        return largest;
    }

    std::filesystem::path folder_;
    GltfFile file_;
};

inline json unlit(const Color& color, double alpha, const char* mode) {
    return {{"pbrMetallicRoughness", {{"baseColorFactor", {color[0], color[1], color[2], alpha}}}},
            {"alphaMode", mode},
            {"extensions", {{"KHR_materials_unlit", json::object()}}}};
}

} // namespace tyndall::test
