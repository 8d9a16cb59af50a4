// A glTF scene in the precision study: what is read from the engine's pictures of it is what it shows.
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/engine/gltf_fixture.hpp"
#include "tests/samples/tool_process.hpp"

namespace tyndall::test {
namespace {

using engine::test::GltfFile;
using engine::test::json;

/// A wall across the view, metal in the file, and a leaf before it that leans in every axis and shines by itself; a
/// sun, a second one, a lamp and a spot. No shadow falls where the camera sees it.
GltfFile two_quads() {
    GltfFile file;
    file.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}});
    file.add("nodes", {{"camera", 0}});
    const auto add_quad = [&](const std::vector<float>& positions, const std::vector<float>& normal, json material) {
        std::vector<float> normals;
        for (int i = 0; i < 4; ++i) {
            normals.insert(normals.end(), normal.begin(), normal.end());
        }
        const std::vector<std::uint16_t> indices{0, 1, 2, 0, 2, 3};
        file.add_shown_mesh({{"attributes",
                              {{"POSITION", file.add_accessor(positions, "VEC3", engine::test::type_float)},
                               {"NORMAL", file.add_accessor(normals, "VEC3", engine::test::type_float)}}},
                             {"indices", file.add_accessor(indices, "SCALAR", engine::test::type_unsigned_short)},
                             {"material", file.add("materials", std::move(material))}});
    };
    add_quad({-30, -20, -10, 30, -20, -10, 30, 20, -10, -30, 20, -10}, {0.12F, 0.09F, 0.9887F},
             {{"pbrMetallicRoughness", {{"baseColorFactor", {0.7, 0.4, 0.2, 1.0}}, {"metallicFactor", 1.0}}}});
    add_quad({-5, -3, -4.65F, -1, -3, -7.05F, -1, 3, -9.75F, -5, 3, -7.35F}, {0.48F, 0.36F, 0.8F},
             {{"pbrMetallicRoughness", {{"baseColorFactor", {0.2, 0.5, 0.6, 1.0}}, {"metallicFactor", 0.0}}},
              {"emissiveFactor", {0.3, 0.1, 0.0}}});
    add_quad({1, 7, 0.5F, 3, 7, 0.5F, 3, 9, 0.5F, 1, 9, 0.5F}, {0, 0, 1}, json::object());
    json& lights = file.root["extensions"]["KHR_lights_punctual"]["lights"];
    const auto add_light = [&](json light, json node) {
        lights.push_back(std::move(light));
        node["extensions"]["KHR_lights_punctual"]["light"] = lights.size() - 1;
        file.add("nodes", std::move(node));
    };
    // A node's light shines along its -z; these quaternions turn that about y by 26 and by -23 degrees.
    add_light({{"type", "directional"}, {"intensity", 5.0}}, {{"rotation", {0.0, 0.225, 0.0, 0.9744}}});
    add_light({{"type", "directional"}, {"intensity", 2.0}, {"color", {0.2, 0.5, 1.0}}},
              {{"rotation", {0.0, -0.2, 0.0, 0.9798}}});
    add_light({{"type", "point"}, {"intensity", 300.0}, {"range", 20.0}}, {{"translation", {2.0, 8.0, 1.0}}});
    add_light({{"type", "spot"}, {"intensity", 60.0}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.5}}}},
              {{"translation", {1.0, 0.0, 0.0}}});
    file.root["extensionsUsed"] = {"KHR_lights_punctual"};
    return file;
}

TEST(PrecisionFile, APictureWithHardlyAnyFogIsTheTruth) {
    const std::filesystem::path folder = fresh_folder();
    write_text(folder / "quads.gltf", two_quads().text());
    write_text(folder / "quads.fog.json",
               R"({"medium": {"height": {"extinction_per_m": 1e-5, "falloff_per_m": 0.1}}})");
    const ToolRun run = run_tool({"precision", "--scene", "file", "--file", (folder / "quads.gltf").string(), "--size",
                                  "64x36", "--frames", "2", "--grid", "16x9", "--slices", "8", "--json"});
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const json printed = json::parse(run.output);
    for (const json& row : printed["rows"]) {
        EXPECT_EQ(row["scene"], "quads");
        if (row["physics"] != "full") {
            continue;
        }
        EXPECT_LT(row["relative_l2"], 2e-3) << row;
        EXPECT_LT(row["reference_error"], 1e-5);
    }

    // Where it says so, the tool refuses.
    EXPECT_EQ(run_tool({"precision", "--scene", "file"}).exit_code, 2);
    std::filesystem::remove(folder / "quads.fog.json");
    const ToolRun no_fog = run_tool({"precision", "--scene", "file", "--file", (folder / "quads.gltf").string()});
    EXPECT_EQ(no_fog.exit_code, 2);
    EXPECT_NE(no_fog.errors.find("quads.fog.json"), std::string::npos) << no_fog.errors;
    std::filesystem::remove_all(folder);
}

} // namespace
} // namespace tyndall::test
