// What the stability study asks of a frame, by hand; and the study itself on the extremes.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "samples/stability/bounds.hpp"
#include "samples/stability/case.hpp"
#include "tests/samples/tool_process.hpp"

namespace tyndall::test {
namespace {

using samples::BoundsReport;
using samples::StageValues;

/// Two froxels behind each other, and a picture of two pixels, all within bounds.
struct Frame {
    std::vector<StageValues> stages{
        {.name = "density", .slices = 2, .values = {0.5F, 0.5F, 0.5F, 1.0F, 2.0F, 0.0F, 1.0F, 2.0F}},
        {.name = "esm", .values = {-30.0F, 400.0F}},
        {.name = "lighting", .slices = 2, .values = {3.0F, 2.0F, 1.0F, 1.0F, 3.0F, 4.0F, 0.0F, 1.0F}},
        {.name = "accumulated",
         .slices = 3,
         .values = {0.0F, 0.0F, 0.0F, 0.0F, 1.0F, 1.0F, 1.0F, 0.5F, 2.0F, 4.0F, 1.0F, 0.5F}}};
    std::vector<glm::dvec3> picture{glm::dvec3(1.0), glm::dvec3(0.0)};

    [[nodiscard]] BoundsReport report() const { return samples::check_bounds(stages, picture, 1e-3); }
};

TEST(StabilityBounds, HoldOfAFrameWithinThem) {
    const BoundsReport report = Frame{}.report();
    EXPECT_EQ(samples::to_text(report, 1e-3), "");
    EXPECT_EQ(report.over_source, 1.0);
    EXPECT_TRUE(samples::holds(report, 1e-3));
}

TEST(StabilityBounds, SeeEachThingThatIsBroken) {
    const auto text = [](std::size_t stage, std::size_t at, float value) {
        Frame frame;
        frame.stages[stage].values[at] = value;
        return samples::to_text(frame.report(), 1e-3);
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (std::size_t stage = 0; stage < 4; ++stage) {
        EXPECT_NE(text(stage, 0, nan).find("1 values not finite"), std::string::npos) << stage;
    }
    EXPECT_EQ(text(0, 2, -0.1F), "1 values below 0");
    EXPECT_EQ(text(0, 2, 1.1F), "1 scattering coefficients above the extinction");
    EXPECT_EQ(text(2, 1, -0.1F), "1 values below 0");
    EXPECT_EQ(text(3, 4, -0.1F), "1 values below 0");
    EXPECT_EQ(text(3, 11, 0.4F), "1 optical depths below the one before");
    EXPECT_EQ(text(3, 9, 4.5F), "1.125000 times the brightest source");
    EXPECT_EQ(text(3, 9, 4.001F), "");
    Frame frame;
    frame.picture[1].g = std::numeric_limits<double>::infinity();
    EXPECT_EQ(samples::to_text(frame.report(), 1e-3), "1 values not finite");
}

TEST(StabilityBounds, TheWorstPixelCountsInPartsOfItsOwnValue) {
    const std::vector<glm::dvec3> exact{glm::dvec3(1.0), glm::dvec3(0.01), glm::dvec3(0.0)};
    std::vector<glm::dvec3> found = exact;
    EXPECT_EQ(samples::worst_relative_error(found, exact), 0.0);
    found[1].b = 0.012;
    EXPECT_NEAR(samples::worst_relative_error(found, exact), 0.2, 1e-12);
    EXPECT_NEAR(samples::worst_relative_error(found, exact, 1.0), 0.002 / (1.01 / 3.0), 1e-12);
    found[2].r = 1e-6; // where the exact value is 0, a thousandth of the mean stands for it
    EXPECT_NEAR(samples::worst_relative_error(found, exact), 0.2, 1e-12);
    found[0].r = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(std::isinf(samples::worst_relative_error(found, exact)));
    const std::vector<glm::dvec3> black(2, glm::dvec3(0.0));
    EXPECT_EQ(samples::worst_relative_error(black, black), 0.0);
    EXPECT_TRUE(std::isinf(samples::worst_relative_error(std::vector(2, glm::dvec3(1e-9)), black)));
    EXPECT_NEAR(samples::worst_relative_error(std::vector(2, glm::dvec3(1e-9)), black, 1.0, 0.1), 1e-8, 1e-20);
}

TEST(Stability, TheExtremesHoldAndTheFilesHoldWhatIsPrinted) {
    const std::filesystem::path folder = fresh_folder();
    const ToolRun run = run_tool({"stability", "--quick", "--out", folder.string(), "--json"});
    EXPECT_EQ(run.exit_code, 0) << run.errors << run.output;
    const nlohmann::json printed = nlohmann::json::parse(run.output);
    std::vector<std::string> names;
    int lights_in_froxels = 0;
    for (const nlohmann::json& row : printed["rows"]) {
        EXPECT_TRUE(row["holds"]) << row.dump();
        names.push_back(row["case"]);
        // A light in the view is judged in the froxels too, whose error is far above rounding.
        if (row["case"] == "light_place" || row["case"] == "light_motion") {
            const bool in_froxels = row["parameter"].get<std::string>().ends_with(", froxels");
            EXPECT_EQ(row["worst"].get<double>() > 1e-4, in_froxels) << row.dump();
            lights_in_froxels += in_froxels ? 1 : 0;
        }
    }
    EXPECT_EQ(lights_in_froxels, 2);
    for (const samples::StabilityCase& test : samples::stability_cases()) {
        EXPECT_EQ(std::count(names.begin(), names.end(), test.name) > 0, true) << test.name << " has no quick case";
    }
    for (const char* series : {"monotone", "leak", "light_motion", "time_step", "many_frames", "refusal"}) {
        EXPECT_GT(std::count(names.begin(), names.end(), series), 0) << series;
    }
    std::ifstream file(folder / "stability.json");
    EXPECT_EQ(nlohmann::json::parse(file), printed);
    std::ifstream csv(folder / "stability.csv");
    EXPECT_EQ(std::count(std::istreambuf_iterator<char>(csv), {}, '\n'),
              1 + static_cast<std::ptrdiff_t>(printed["rows"].size()));
    if (run.errors.find("no plots are drawn") == std::string::npos) {
        EXPECT_TRUE(std::filesystem::exists(folder / "stability.png"));
        EXPECT_TRUE(std::filesystem::exists(folder / "stability.svg"));
    }
    std::filesystem::remove_all(folder);
}

/// Keys that are parsed into another parameter, that the fog file alone has, or that another file has.
const std::set<std::string> of_the_file_only{"medium.volumes[].radius_m", "medium.volumes[].density.slices",
                                             "shadow_near_m"};

std::vector<std::string> split(const std::string& text, char between) {
    std::vector<std::string> parts;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, between);) {
        parts.push_back(part);
    }
    return parts;
}

TEST(Stability, EveryRangeOfTheFogFileHasARefusal) {
    std::set<std::string> refused;
    for (const samples::Refusal& refusal : samples::stability_refusals()) {
        std::string key = refusal.parameter;
        if (const std::size_t first = key.find("[0]"); first != std::string::npos) {
            key.replace(first, 3, "[]");
        }
        refused.insert(key);
    }
    std::ifstream docs(TYNDALL_SAMPLES "/../docs/fog.md");
    std::size_t keys = 0;
    for (std::string line; std::getline(docs, line);) {
        // | `key` or `key`, `key` | meaning | range | default |
        const std::vector<std::string> cells = split(line, '|');
        if (cells.size() < 5 || cells[1].rfind(" `", 0) != 0 ||
            cells[cells.size() - 2].find_first_of("0123456789") == std::string::npos) {
            continue;
        }
        const std::vector<std::string> names = split(cells[1], '`');
        for (std::size_t i = 1; i < names.size(); i += 2) {
            ++keys;
            EXPECT_TRUE(refused.contains(names[i]) || of_the_file_only.contains(names[i])) << names[i];
        }
    }
    EXPECT_GT(keys, 40U);
}

TEST(Stability, RefusesACaseThatThereIsNot) {
    const ToolRun run = run_tool({"stability", "--case", "storm"});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
    EXPECT_NE(run.errors.find("case"), std::string::npos) << run.errors;
}

} // namespace
} // namespace tyndall::test
