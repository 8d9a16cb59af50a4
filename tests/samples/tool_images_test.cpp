// The pictures that the tool makes, from files to files, under the validation layer.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/image_io.hpp"
#include "tests/samples/tool_process.hpp"

namespace tyndall::test {
namespace {

class Pictures : public ::testing::Test {
protected:
    void SetUp() override { folder_ = fresh_folder(); }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_ / name; }

    /// The hall, small, to `name` and whatever `more` says; fails the test on a validation message.
    void render(const std::string& name, const std::vector<std::string>& more, const std::string& driver = {}) {
        render_scene(TYNDALL_HALL, name, more, driver);
    }
    void render_scene(const std::string& scene, const std::string& name, const std::vector<std::string>& more,
                      const std::string& driver = {}) {
        std::vector<std::string> arguments = {"render",     scene,   "--size",           "192x108",
                                              "--frames",   "3",     "--exposure",       exposure_ev100_,
                                              "--validate", "--out", file(name).string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const ToolRun run = run_tool(arguments, driver);
        ASSERT_EQ(run.exit_code, 0) << run.errors;
    }
    [[nodiscard]] engine::Pixels<float> radiance(const std::string& name) const {
        const auto image = engine::read_exr(file(name));
        EXPECT_TRUE(image.has_value());
        return image.value_or(engine::Pixels<float>{});
    }
    [[nodiscard]] std::string text(const std::string& name) const {
        std::ifstream stream(file(name));
        std::stringstream content;
        content << stream.rdbuf();
        return content.str();
    }

    std::filesystem::path folder_;
    std::string exposure_ev100_ = "9";
};

/// sqrt(sum (a - b)^2 / sum b^2)
double relative_l2(const engine::Pixels<float>& a, const engine::Pixels<float>& b) {
    double difference = 0.0;
    double norm = 0.0;
    for (std::size_t i = 0; i < a.values.size(); ++i) {
        const double d = double{a.values[i]} - double{b.values[i]};
        difference += d * d;
        norm += double{b.values[i]} * double{b.values[i]};
    }
    return std::sqrt(difference / norm);
}

/// Standard deviation of the 8-bit values.
double contrast(const engine::Pixels<std::uint8_t>& image) {
    double sum = 0.0;
    double squares = 0.0;
    for (const std::uint8_t value : image.values) {
        sum += value;
        squares += double{static_cast<double>(value)} * value;
    }
    const auto count = static_cast<double>(image.values.size());
    return std::sqrt(std::max(0.0, squares / count - sum / count * (sum / count)));
}

TEST_F(Pictures, TheHallIsFiniteLitAndFogged) {
    render("fogged.exr",
           {"--explain-file", file("explain.txt").string(), "--timing-file", file("timing.txt").string()});
    render("clear.exr", {"--no-fog"});
    const engine::Pixels<float> fogged = radiance("fogged.exr");
    const engine::Pixels<float> clear = radiance("clear.exr");
    ASSERT_EQ(fogged.values.size(), 192U * 108U * 3U);
    for (const float value : fogged.values) {
        ASSERT_TRUE(std::isfinite(value) && value >= 0.0F);
    }
    EXPECT_GT(relative_l2(fogged, clear), 0.1);
    const std::string explain = text("explain.txt");
    for (const char* pass :
         {"density injection", "light clustering", "froxel lighting", "fog accumulation", "fog on opaque",
          "transparents", "particle sort", "depth pre-pass", "tone mapping", "after_shadow_maps", "barrier: "}) {
        EXPECT_NE(explain.find(pass), std::string::npos) << pass;
    }
    EXPECT_NE(text("timing.txt").find("froxel lighting"), std::string::npos);
}

TEST_F(Pictures, FogOfZeroDensityGivesTheVeryBitsOfNoFog) {
    std::ofstream(file("zero.json")) << R"({"medium":{"homogeneous":{"extinction_per_m":0}}})";
    render("zero.exr", {"--fog", file("zero.json").string()});
    render("none.exr", {"--no-fog"});
    EXPECT_EQ(radiance("zero.exr").values, radiance("none.exr").values);
}

TEST_F(Pictures, TwoQueuesGiveTheBitsOfOne) {
    render("one.exr", {"--queues", "one"});
    render("two.exr", {"--queues", "two"});
    EXPECT_EQ(radiance("one.exr").values, radiance("two.exr").values);
}

// Any number made from a transient that nobody wrote would be NaN or far off.
TEST_F(Pictures, NothingOfTheHallIsMadeFromWhatNobodyWrote) {
    for (const char* queues : {"one", "two"}) {
        render("plain.exr", {"--queues", queues});
        render("poisoned.exr", {"--queues", queues, "--poison"});
        EXPECT_EQ(radiance("plain.exr").values, radiance("poisoned.exr").values) << queues;
    }
}

TEST_F(Pictures, TheTraceHoldsTheMeasuredTimelineBesideThePredictedOne) {
    render("picture.png", {"--trace", file("trace.json").string()});
    const nlohmann::json events = nlohmann::json::parse(text("trace.json"))["traceEvents"];
    const auto durations_of = [&](int timeline) {
        std::set<double> out;
        for (const nlohmann::json& event : events) {
            if (event["ph"] == "X" && event["pid"] == timeline) {
                out.insert(event["dur"].get<double>());
            }
        }
        return out;
    };
    constexpr int predicted = 1;
    constexpr int measured = 2;
    EXPECT_GT(durations_of(predicted).size(), 10U) << "each pass lasts as long as it was measured to";
    EXPECT_GT(durations_of(measured).size(), 10U);
}

TEST_F(Pictures, TheSameRunGivesTheSamePicture) {
    render("first.png", {});
    render("second.png", {});
    const auto first = engine::read_png(file("first.png"));
    const auto second = engine::read_png(file("second.png"));
    ASSERT_TRUE(first.has_value() && second.has_value());
    EXPECT_EQ(first->values, second->values);
    EXPECT_GT(contrast(*first), 20.0);
}

TEST_F(Pictures, StagesAreDumped) {
    render("picture.png", {"--fog", TYNDALL_SAMPLES "/fog/hall_esm.json", "--dump-stages", file("stages").string()});
    for (const char* stage :
         {"density", "esm", "lighting", "accumulated", "transmittance", "clusters", "with_fog", "without_fog"}) {
        const auto image = engine::read_png(file("stages") / (std::string(stage) + ".png"));
        ASSERT_TRUE(image.has_value()) << stage;
        EXPECT_GT(contrast(*image), 2.0) << stage;
    }
}

TEST_F(Pictures, ModelsOfOthersAreShown) {
    const std::filesystem::path models = "/usr/share/assimp/models";
    if (!std::filesystem::exists(models)) {
        GTEST_SKIP() << "package assimp-testmodels is not installed";
    }
    std::ofstream(file("fog.json")) << R"({"medium":{"homogeneous":{"extinction_per_m":0.02}},)"
                                       R"("ambient":{"radiance":[1000,1100,1250]},"grid":{"range_m":30}})";
    exposure_ev100_ = "14"; // daylight
    for (const char* model :
         {"glTF2/BoxTextured-glTF-Binary/BoxTextured.glb", "glTF2/ClearCoat-glTF/ClearCoatTest.gltf",
          "glTF2/textureTransform/TextureTransformTest.gltf"}) {
        render_scene((models / model).string(), "model.png", {"--fog", file("fog.json").string()});
        const auto image = engine::read_png(file("model.png"));
        ASSERT_TRUE(image.has_value());
        EXPECT_GT(contrast(*image), 5.0) << model;
    }
}

TEST_F(Pictures, BothDriversAgree) {
    const char* second = std::getenv("TYNDALL_SECOND_DRIVER");
    if (second == nullptr) {
        GTEST_SKIP() << "TYNDALL_SECOND_DRIVER names no driver";
    }
    render("here.exr", {});
    render("there.exr", {}, second);
    const double difference = relative_l2(radiance("there.exr"), radiance("here.exr"));
    RecordProperty("relative_l2", std::to_string(difference));
    std::printf("relative L2 between the drivers: %.3g\n", difference);
    EXPECT_LT(difference, 0.01);
}

} // namespace
} // namespace tyndall::test
