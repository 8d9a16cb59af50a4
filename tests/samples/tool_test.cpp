// Bad input ends with one sentence that names the culprit and exit code 2.
#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/samples/tool_process.hpp"

namespace tyndall::test {
namespace {

class BadInput : public ::testing::Test {
protected:
    void SetUp() override { folder_ = fresh_folder(); }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    /// The hall at a tiny size, and `more`.
    static std::vector<std::string> render(std::vector<std::string> more) {
        std::vector<std::string> arguments = {"render", TYNDALL_HALL, "--size", "64x36", "--frames", "1"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return arguments;
    }

    static void expect_refused(const std::vector<std::string>& arguments, const std::vector<std::string>& names) {
        const ToolRun run = run_tool(arguments);
        EXPECT_EQ(run.exit_code, 2) << run.errors;
        EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
        for (const std::string& name : names) {
            EXPECT_NE(run.errors.find(name), std::string::npos) << "no '" << name << "' in: " << run.errors;
        }
    }

    std::string fog(const std::string& text) {
        write_text(folder_ / "fog.json", text);
        return (folder_ / "fog.json").string();
    }

    std::filesystem::path folder_;
};

TEST_F(BadInput, NoSubcommand) {
    expect_refused({}, {"subcommand"});
}
TEST_F(BadInput, UnknownSubcommand) {
    expect_refused({"frobnicate"}, {"subcommand", "frobnicate"});
}
TEST_F(BadInput, UnknownOption) {
    expect_refused(render({"--sise", "1x1"}), {"--sise"});
}
TEST_F(BadInput, MissingScene) {
    expect_refused({"render", "no/such/scene.gltf"}, {"no/such/scene.gltf"});
}
TEST_F(BadInput, SceneIsAFolder) {
    expect_refused({"render", folder_.string()}, {folder_.string()});
}
TEST_F(BadInput, BrokenScene) {
    write_text(folder_ / "broken.gltf", "{\"asset\":");
    expect_refused({"render", (folder_ / "broken.gltf").string()}, {"broken.gltf"});
}
TEST_F(BadInput, SceneIsNoScene) {
    write_text(folder_ / "picture.png", "not a scene");
    expect_refused({"render", (folder_ / "picture.png").string()}, {"picture.png"});
}
TEST_F(BadInput, RequiredExtensionUnknown) {
    write_text(folder_ / "draco.gltf", R"({"asset":{"version":"2.0"},"extensionsUsed":["KHR_draco_mesh_compression"],)"
                                       R"("extensionsRequired":["KHR_draco_mesh_compression"]})");
    expect_refused({"render", (folder_ / "draco.gltf").string()}, {"KHR_draco_mesh_compression"});
}
TEST_F(BadInput, SizeZero) {
    expect_refused({"render", TYNDALL_HALL, "--size", "0x720"}, {"--size", "0x720"});
}
TEST_F(BadInput, SizeNotASize) {
    expect_refused({"render", TYNDALL_HALL, "--size", "big"}, {"--size", "big"});
}
TEST_F(BadInput, SizeTooLarge) {
    expect_refused({"render", TYNDALL_HALL, "--size", "100000x1"}, {"--size", "16384"});
}
TEST_F(BadInput, FramesZero) {
    expect_refused({"render", TYNDALL_HALL, "--frames", "0"}, {"--frames"});
}
TEST_F(BadInput, NoSuchCamera) {
    expect_refused(render({"--camera", "99"}), {"camera 99"});
}
TEST_F(BadInput, NoSuchDevice) {
    expect_refused(render({"--device", "imaginary"}), {"imaginary"});
}
TEST_F(BadInput, UnknownImageFormat) {
    expect_refused(render({"--out", "picture.bmp"}), {"picture.bmp", ".png", ".exr"});
}
TEST_F(BadInput, UnwritableImage) {
    expect_refused(render({"--out", (folder_ / "no" / "such" / "picture.png").string()}), {"picture.png"});
}
TEST_F(BadInput, TimeNotFinite) {
    expect_refused(render({"--time", "nan"}), {"--time"});
}
TEST_F(BadInput, ExposureNotFinite) {
    expect_refused(render({"--exposure", "inf"}), {"--exposure"});
}
TEST_F(BadInput, MissingFog) {
    expect_refused(render({"--fog", "no/such/fog.json"}), {"no/such/fog.json"});
}
TEST_F(BadInput, FogIsNoJson) {
    expect_refused(render({"--fog", fog("{")}), {"fog.json"});
}
TEST_F(BadInput, FogWithUnknownKey) {
    expect_refused(render({"--fog", fog(R"({"medium":{"homogenous":{}}})")}), {"fog.json", "medium.homogenous"});
}
TEST_F(BadInput, FogWithImpossibleValue) {
    expect_refused(render({"--fog", fog(R"({"phase":{"g":2}})")}), {"fog.json", "phase.g", "0.999"});
    expect_refused(render({"--fog", fog(R"({"medium":{"homogeneous":{"extinction_per_m":-1}}})")}),
                   {"medium.homogeneous.extinction_per_m"});
}
TEST_F(BadInput, ParticlesWithUnknownKey) {
    write_text(folder_ / "particles.json", R"({"emitters":[],"nonsense":1})");
    expect_refused(render({"--particles", (folder_ / "particles.json").string()}), {"particles.json", "nonsense"});
}

TEST(Tool, HelpIsNotAnError) {
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"--help"}, {"render", "--help"}, {"info", "--help"}}) {
        const ToolRun run = run_tool(arguments);
        EXPECT_EQ(run.exit_code, 0);
        EXPECT_NE(run.output.find("--help"), std::string::npos);
    }
}

TEST(Tool, InfoListsDevicesAndQueues) {
    const ToolRun text = run_tool({"info"});
    ASSERT_EQ(text.exit_code, 0) << text.errors;
    EXPECT_NE(text.output.find("queue"), std::string::npos);
    const ToolRun json = run_tool({"info", "--json"});
    ASSERT_EQ(json.exit_code, 0) << json.errors;
    const nlohmann::json document = nlohmann::json::parse(json.output, nullptr, false);
    ASSERT_TRUE(document.is_object()) << json.output;
    ASSERT_FALSE(document.at("devices").empty());
    EXPECT_FALSE(document.at("devices").at(0).at("queues").empty());
}

} // namespace
} // namespace tyndall::test
