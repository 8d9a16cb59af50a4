// The measures of an error by hand, the scenes' two forms, and the study end to end at a tiny size.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "samples/precision/choice.hpp"
#include "samples/precision/metrics.hpp"
#include "samples/precision/scene.hpp"
#include "tests/samples/tool_process.hpp"

namespace tyndall::test {
namespace {

using samples::compare_images;
using samples::ErrorMetrics;

TEST(PrecisionMetrics, ByHand) {
    // 100 pixels of 2, each 0.1 too bright, but one that is 1 too dark.
    std::vector<glm::dvec3> exact(100, glm::dvec3(2.0));
    std::vector<glm::dvec3> found(100, glm::dvec3(2.1));
    found[17] = glm::dvec3(1.0);
    const ErrorMetrics e = compare_images(found, exact);
    EXPECT_NEAR(e.rmse, std::sqrt((99 * 0.01 + 1.0) / 100.0), 1e-12);
    EXPECT_NEAR(e.relative_l2, e.rmse / 2.0, 1e-12);
    EXPECT_NEAR(e.percentile99, 0.05, 1e-12);
    EXPECT_NEAR(e.maximum, 0.5, 1e-12);
    EXPECT_NEAR(e.bias, (99 * 0.1 - 1.0) / 200.0, 1e-12);
    const ErrorMetrics none = compare_images(exact, exact);
    EXPECT_EQ(none.relative_l2, 0.0);
    EXPECT_EQ(none.standard_error, 0.0);
}

TEST(PrecisionMetrics, TheStandardErrorIsTheSpreadOfSmallChoices) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::vector<double> values;
    double claimed = 0.0;
    constexpr int trials = 400;
    for (int trial = 0; trial < trials; ++trial) {
        std::vector<glm::dvec3> exact;
        std::vector<glm::dvec3> found;
        for (int i = 0; i < 300; ++i) {
            exact.emplace_back(1.0 + uniform(random));
            found.push_back(exact.back() + glm::dvec3(0.3 * std::pow(uniform(random), 4.0)));
        }
        const ErrorMetrics e = compare_images(found, exact);
        values.push_back(e.relative_l2);
        claimed += e.standard_error / trials;
    }
    double mean = 0.0;
    for (const double v : values) {
        mean += v / trials;
    }
    double variance = 0.0;
    for (const double v : values) {
        variance += (v - mean) * (v - mean) / (trials - 1);
    }
    EXPECT_NEAR(claimed, std::sqrt(variance), 0.15 * claimed);
}

TEST(PrecisionChoice, FrontAndBounds) {
    using samples::Measured;
    const std::vector<Measured> all{{0.05, 10.0}, {0.02, 20.0}, {0.03, 25.0}, {0.01, 40.0}, {0.02, 22.0}, {0.05, 10.0}};
    EXPECT_EQ(samples::pareto_front(all), (std::vector<bool>{true, true, false, true, false, true}));
    EXPECT_EQ(samples::cheapest_within(all, 0.04), 1U);
    EXPECT_EQ(samples::cheapest_within(all, 0.01), 3U);
    EXPECT_EQ(samples::cheapest_within(all, 0.009), std::nullopt);
    EXPECT_EQ(samples::most_exact_within(all, 30.0), 1U); // 22 ms are no better than 20
    EXPECT_EQ(samples::most_exact_within(all, 10.0), 0U);
    EXPECT_EQ(samples::most_exact_within(all, 9.0), std::nullopt);
}

TEST(PrecisionChoice, Bounds) {
    EXPECT_DOUBLE_EQ(samples::parse_error_bound("2%").value(), 0.02);
    EXPECT_DOUBLE_EQ(samples::parse_error_bound("0.5").value(), 0.5);
    EXPECT_DOUBLE_EQ(samples::parse_budget_ms("30ms").value(), 30.0);
    EXPECT_DOUBLE_EQ(samples::parse_budget_ms("1.5").value(), 1.5);
    for (const char* wrong : {"", "%", "2 %", "-1%", "nan", "101%", "2ms", "inf", "0"}) {
        const auto parsed = samples::parse_error_bound(wrong);
        ASSERT_FALSE(parsed) << wrong;
        EXPECT_NE(parsed.error().find("'" + std::string(wrong) + "'"), std::string::npos);
    }
    for (const char* wrong : {"", "ms", "-1ms", "nan", "2%", "inf", "0", "1e7"}) {
        EXPECT_FALSE(samples::parse_budget_ms(wrong)) << wrong;
    }
}

TEST(PrecisionScenes, BothFormsHaveTheSameSurfacesFacingTheirOutside) {
    for (const samples::PrecisionScene& scene : samples::precision_scenes()) {
        const engine::Scene drawn = samples::engine_scene(scene);
        const samples::reference::Scene exact = samples::reference_scene(scene, {});
        std::size_t triangles = 0;
        for (const engine::Primitive& primitive : drawn.primitives) {
            for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
                const auto corner = [&](std::size_t k) { return primitive.positions[primitive.indices[i + k]]; };
                const glm::vec3 area = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
                EXPECT_GT(glm::dot(area, primitive.normals[primitive.indices[i]]), 0.0F) << scene.name;
                const auto& truth = exact.geometry.triangles()[triangles].corners;
                for (std::size_t k = 0; k < 3; ++k) {
                    EXPECT_LT(glm::distance(glm::dvec3(corner(k)), truth[k]), 1e-5) << scene.name;
                }
                ++triangles;
            }
        }
        EXPECT_EQ(triangles, exact.geometry.triangles().size()) << scene.name;
        // Every ray ends on a surface within the grid.
        const samples::reference::ImageSize size{32, 18};
        const glm::dvec3 forward = -glm::normalize(glm::dvec3(scene.camera.world_from_camera[2]));
        for (const samples::reference::Pixel& pixel : samples::reference::all_pixels(size)) {
            const samples::reference::Ray ray = samples::reference::pixel_ray(scene.camera, size, pixel);
            const auto hit = exact.geometry.hit(ray);
            ASSERT_TRUE(hit.has_value()) << scene.name << " " << pixel.x << " " << pixel.y;
            EXPECT_LT(hit->distance_m * glm::dot(ray.direction, forward),
                      static_cast<double>(scene.fog.settings.grid.range_m))
                << scene.name;
        }
    }
}

TEST(Precision, SlabIsExactAndTheFilesHoldWhatIsPrinted) {
    const std::filesystem::path folder = fresh_folder();
    const ToolRun run = run_tool({"precision", "--scene", "slab", "--size", "32x18", "--frames", "2", "--integrator",
                                  "euler,exponential", "--out", folder.string(), "--json"});
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const nlohmann::json printed = nlohmann::json::parse(run.output);
    std::ifstream file(folder / "precision.json");
    EXPECT_EQ(nlohmann::json::parse(file), printed);
    double euler = 0.0;
    double exponential = 0.0;
    for (const nlohmann::json& row : printed["rows"]) {
        const double error = row["relative_l2"];
        (row["integrator"] == "euler" ? euler : exponential) = error;
        EXPECT_LT(row["reference_error"], 1e-5);
        EXPECT_GT(row["fog_ms"], 0.0);
    }
    EXPECT_LT(exponential, 1e-3);
    EXPECT_GT(euler, 1e-3);
    std::ifstream csv(folder / "precision.csv");
    const auto lines = std::count(std::istreambuf_iterator<char>(csv), {}, '\n');
    EXPECT_EQ(lines, 1 + static_cast<std::ptrdiff_t>(printed["rows"].size()));

    // The pictures, and the plots of all that on a page.
    const auto pixels = std::filesystem::file_size(folder / "slab_exact.pfm");
    EXPECT_EQ(pixels, std::string("PF\n32 18\n-1.0\n").size() + 32 * 18 * 3 * sizeof(float));
    EXPECT_EQ(std::filesystem::file_size(folder / "slab_picture.pfm"), pixels);
    if (run.errors.find("no plots are drawn") == std::string::npos) {
        for (const char* name : {"precision_slab.png", "precision_slab.svg", "error_slab.png", "precision.html"}) {
            EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
        }
    } else {
        std::printf("matplotlib is not installed; scripts/setup --test installs it\n");
    }

    // Again: the exact picture of the first run serves, and is the same.
    const ToolRun again = run_tool({"precision", "--scene", "slab", "--size", "32x18", "--frames", "2", "--integrator",
                                    "euler,exponential", "--out", folder.string()});
    EXPECT_NE(again.output.find("slab: exact pictures of an earlier run are used"), std::string::npos) << again.output;
    std::ifstream second_file(folder / "precision.json");
    const nlohmann::json second = nlohmann::json::parse(second_file);
    for (std::size_t i = 0; i < printed["rows"].size(); ++i) {
        EXPECT_EQ(second["rows"][i]["relative_l2"], printed["rows"][i]["relative_l2"]);
        EXPECT_EQ(second["rows"][i]["reference_error"], printed["rows"][i]["reference_error"]);
    }
    const std::string plot = "/usr/bin/python3 " TYNDALL_SAMPLES "/precision/plot.py ";
    write_text(folder / "precision.csv", "scene,grid\n");
    EXPECT_NE(std::system((plot + folder.string() + " 2>/dev/null").c_str()), 0);
    std::filesystem::remove_all(folder);
}

/// docs/measurements.md, "Fog against its reference": what every change has to keep of it, with the default
/// configuration.
TEST(Precision, TheDefaultConfigurationKeepsItsErrors) {
    const std::array<std::pair<const char*, double>, 3> bounds{
        {{"slab", 0.02}, {"height_fog", 0.02}, {"point_light", 0.05}}};
    for (const auto& [scene, bound] : bounds) {
        const ToolRun run = run_tool({"precision", "--scene", scene, "--size", "160x90", "--frames", "2", "--json"});
        ASSERT_EQ(run.exit_code, 0) << run.errors;
        const nlohmann::json printed = nlohmann::json::parse(run.output);
        int judged = 0;
        for (const nlohmann::json& row : printed["rows"]) {
            if (row["frame"] == 1 && row["physics"] == "full") {
                ++judged;
                EXPECT_LE(row["relative_l2"], bound) << row;
                EXPECT_LE(std::abs(row["bias"].get<double>()), 0.005) << row;
                EXPECT_LT(row["reference_error"].get<double>(), 0.01 * row["relative_l2"].get<double>()) << row;
            }
        }
        EXPECT_EQ(judged, 1) << scene;
    }
}

TEST(Precision, ChoosesAndRunsTheChoice) {
    const ToolRun run =
        run_tool({"precision", "--scene", "slab", "--size", "32x18", "--frames", "2", "--slices", "8,64",
                  "--integrator", "euler,exponential", "--error", "0.5%", "--budget", "0.000001ms", "--causes"});
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const std::size_t choice = run.output.find("slab, the cheapest within 0.5 %: exponential, ");
    ASSERT_NE(choice, std::string::npos) << run.output;
    EXPECT_NE(run.output.find("; run again: ", choice), std::string::npos) << run.output;
    EXPECT_NE(run.output.find("slab, the most exact within 1e-06 ms: unreachable"), std::string::npos) << run.output;
    // Euler's error in a slab is that of its slices and of the integrator.
    const auto left = [&](const std::string& cause) {
        const std::size_t at = run.output.find("slab          " + cause + " ");
        return at == std::string::npos ? -1.0 : std::strtod(run.output.c_str() + at + 46, nullptr);
    };
    EXPECT_GT(left("none removed"), 0.5);
    EXPECT_LT(left("4 times the slices"), 0.5 * left("none removed"));
    EXPECT_LT(left("quadratic integrator"), 0.5 * left("none removed"));
    EXPECT_NEAR(left("fp32 storage"), left("none removed"), 0.1 * left("none removed"));
    EXPECT_GE(left("64 frames averaged"), 0.0);
}

TEST(Precision, AShortSweepKeepsItsWordAndItsFrontIsMonotone) {
    const std::filesystem::path folder = fresh_folder();
    const std::vector<std::string> common{
        "precision", "--scene",  "point_light", "--size",   "32x18",        "--frames",
        "2",         "--grid",   "8x5,16x9",    "--slices", "8,16",         "--error",
        "99%",       "--budget", "1e6ms",       "--quick",  "--integrator", "euler,exponential"};
    std::vector<std::string> arguments = common;
    arguments.insert(arguments.end(), {"--out", folder.string()});
    const ToolRun run = run_tool(arguments);
    ASSERT_EQ(run.exit_code, 0) << run.errors;

    std::ifstream file(folder / "precision.json");
    const nlohmann::json all = nlohmann::json::parse(file)["rows"];
    // Two integrators, two grids, two numbers of slices and the scene's own configuration; no sun: one visibility.
    std::vector<nlohmann::json> judged;
    for (const nlohmann::json& row : all) {
        EXPECT_GT(row["relative_l2"].get<double>(), 100.0 * row["reference_error"].get<double>());
        EXPECT_GT(row["relative_time"], 0.0);
        if (row["frame"] == 2 && row["physics"] == "full") {
            judged.push_back(row);
        }
    }
    ASSERT_EQ(judged.size(), 9U);
    EXPECT_EQ(std::count_if(judged.begin(), judged.end(), [](const auto& row) { return row["own"] == true; }), 1);
    const nlohmann::json* cheapest = nullptr;
    for (const nlohmann::json& row : judged) {
        const bool beaten = std::any_of(judged.begin(), judged.end(), [&](const nlohmann::json& other) {
            return other["fog_ms"] < row["fog_ms"] && other["relative_l2"] < row["relative_l2"];
        });
        EXPECT_TRUE(row["on_front"] == false || !beaten) << row;
        cheapest = cheapest == nullptr || row["fog_ms"] < (*cheapest)["fog_ms"] ? &row : cheapest;
    }
    EXPECT_EQ((*cheapest)["on_front"], true);

    // Everything is within these bounds: the cheapest of all is chosen by one, the most exact by the other.
    const auto sentence = [&](const std::string& wish, const nlohmann::json& row) {
        return "point_light, " + wish + ": " + row["integrator"].get<std::string>() + ", one_tap, " +
               row["grid"].get<std::string>() + "x" + std::to_string(row["slices"].get<int>()) + ": ";
    };
    const nlohmann::json& most_exact = *std::min_element(
        judged.begin(), judged.end(), [](const auto& a, const auto& b) { return a["relative_l2"] < b["relative_l2"]; });
    EXPECT_NE(run.output.find(sentence("the cheapest within 99 %", *cheapest)), std::string::npos) << run.output;
    EXPECT_NE(run.output.find(sentence("the most exact within 1e+06 ms", most_exact)), std::string::npos) << run.output;
    EXPECT_NE(run.output.find("because 9 of 9 measured are within that bound"), std::string::npos) << run.output;
    EXPECT_NE(run.output.find("point_light, the scene's own configuration, "), std::string::npos) << run.output;
    std::filesystem::remove_all(folder);
}

TEST(Precision, RefusesWhatItCannotMeasure) {
    for (const std::vector<std::string>& arguments : {std::vector<std::string>{"precision", "--scene", "hell"},
                                                      {"precision", "--integrator", "rk4"},
                                                      {"precision", "--slices", "4"},
                                                      {"precision", "--size", "0x3"},
                                                      {"precision", "--frames", "1"},
                                                      {"precision", "--grid", "0x3"},
                                                      {"precision", "--error", "-2%"},
                                                      {"precision", "--budget", "soon"}}) {
        const ToolRun run = run_tool(arguments);
        EXPECT_EQ(run.exit_code, 2) << arguments[1];
        EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
        EXPECT_NE(run.errors.find(arguments[1].substr(2)), std::string::npos) << run.errors;
    }
    // The sentence names the option, and where it takes names, these.
    const auto refusal = [](std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), "precision");
        const ToolRun run = run_tool(arguments);
        EXPECT_EQ(run.exit_code, 2);
        EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
        return run.errors;
    };
    EXPECT_NE(refusal({"--integrator", "foo"}).find("foo not in {euler,half_slice,exponential,exponential_quadratic}"),
              std::string::npos);
    EXPECT_NE(refusal({"--visibility", "foo"}).find("foo not in {one_tap,n_taps,prefiltered,lit_fraction}"),
              std::string::npos);
    EXPECT_EQ(refusal({"--grid", "160x90,1x1"}),
              "tyndall: --grid must be WIDTHxHEIGHT with both from 2 to 1024, not '1x1'\n");
    EXPECT_EQ(refusal({"--scene", "slab", "--file", "hall.gltf"}),
              "tyndall: --file is measured by --scene all or --scene file, not by --scene slab\n");
    for (const char* option : {"--scene=slab", "--error=2%", "--sweep", "--size=32x18"}) {
        const std::string sentence = refusal({"--orders", option});
        EXPECT_NE(sentence.find("--orders"), std::string::npos) << sentence;
        EXPECT_NE(sentence.find(std::string_view(option).substr(0, std::string_view(option).find('='))),
                  std::string::npos)
            << sentence;
    }
}

TEST(Precision, OrdersAreWrittenToo) {
    const std::filesystem::path folder = fresh_folder();
    const ToolRun run = run_tool({"precision", "--orders", "--json", "--out", folder.string()});
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const nlohmann::json rows = nlohmann::json::parse(run.output)["rows"];
    ASSERT_EQ(rows.size(), 16U); // integrators, densities, slices equal or growing
    for (const nlohmann::json& row : rows) {
        EXPECT_NEAR(row["order"].get<double>(), row["expected"].get<double>(), 0.1) << row;
        EXPECT_EQ(row["relative_errors"].size(), 9U);
    }
    std::ifstream csv(folder / "orders.csv");
    EXPECT_EQ(std::count(std::istreambuf_iterator<char>(csv), {}, '\n'), 1 + 16 * 9);
    std::filesystem::remove_all(folder);
}

} // namespace
} // namespace tyndall::test
