// tyndall schedule as a user runs it, on a machine without any driver.
#include <algorithm>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/samples/tool_process.hpp"

namespace tyndall::test {
namespace {

std::string frame_file(const std::string& name) {
    return std::string(TYNDALL_SAMPLES) + "/frames/" + name + ".json";
}
std::string read_all(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

class Schedule : public ::testing::Test {
protected:
    void SetUp() override { folder_ = fresh_folder(); }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    /// The only driver that the loader is told of does not exist.
    static ToolRun schedule(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), "schedule");
        return run_tool(arguments, "/no/such/driver.json");
    }
    static void expect_in(const std::string& text, const std::string& part) {
        EXPECT_NE(text.find(part), std::string::npos) << "no '" << part << "' in:\n" << text;
    }
    /// Queue of a pass in the printed table.
    static std::string queue_of(const std::string& table, const std::string& pass) {
        std::istringstream lines(table);
        for (std::string line; std::getline(lines, line);) {
            if (line.rfind(pass + "  ", 0) == 0) {
                return line.find("  compute  ") != std::string::npos ? "compute" : "graphics";
            }
        }
        return "no row";
    }

    std::filesystem::path folder_;
};

TEST_F(Schedule, EverySampleFrameIsProvedOnEveryTopology) {
    for (const char* name : {"deferred", "hall", "wronski_2014"}) {
        for (const char* queues : {"graphics", "graphics,compute", "graphics,compute:0", "graphics,compute,transfer"}) {
            SCOPED_TRACE(std::string(name) + " on " + queues);
            const ToolRun run = schedule({frame_file(name), "--queues", queues, "--verify"});
            EXPECT_EQ(run.exit_code, 0) << run.errors;
            expect_in(run.output, "free of races");
            expect_in(run.output, "\nceiling ");
            expect_in(run.output, "\ntransient memory ");
        }
    }
}

/// What a frame's plan follows from: not what each run measures anew, nor what the host keeps beside the frame and
/// never writes in it, parameter blocks and kept shadow maps.
nlohmann::json graph_of(const std::filesystem::path& file) {
    nlohmann::json frame = nlohmann::json::parse(read_all(file));
    frame.erase("about");
    std::vector<nlohmann::json> read_only;
    nlohmann::json& resources = frame["resources"];
    for (auto resource = resources.begin(); resource != resources.end();) {
        const bool never_written = resource->contains("import") && (*resource)["import"].value("read_only", false);
        if (never_written) {
            read_only.push_back((*resource)["name"]);
        }
        resource = never_written ? resources.erase(resource) : resource + 1;
    }
    for (nlohmann::json& pass : frame["passes"]) {
        pass.erase("duration_ns");
        pass.erase("deviation_ns");
        nlohmann::json& accesses = pass["accesses"];
        for (auto access = accesses.begin(); access != accesses.end();) {
            const bool of_host = access->contains("reads") &&
                                 std::find(read_only.begin(), read_only.end(), (*access)["reads"]) != read_only.end();
            access = of_host ? accesses.erase(access) : access + 1;
        }
    }
    return frame;
}

TEST_F(Schedule, HallIsTheFrameThatTheHallIsRenderedBy) {
    const std::filesystem::path exported = folder_ / "hall.json";
    const ToolRun run = run_tool({"render", TYNDALL_HALL, "--fog", std::string(TYNDALL_SAMPLES) + "/fog/hall_esm.json",
                                  "--size", "1280x720", "--frames", "2", "--export-frame", exported.string()});
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_EQ(graph_of(frame_file("hall")), graph_of(exported))
        << "write it anew: tyndall render hall.gltf --fog samples/fog/hall_esm.json --size 1280x720 --frames 6 "
        << "--export-frame samples/frames/hall.json";
}

TEST_F(Schedule, DeferredFrameHasTheMemoryOfItsKind) {
    const ToolRun run = schedule({frame_file("deferred"), "--queues", "graphics"});
    expect_in(run.output, "transient memory 129.91 MiB, at least 129.91 MiB are needed, met; without sharing "
                          "197.58 MiB");
}

TEST_F(Schedule, FogOfTheHallRunsBesidePrePassAndOpaqueWhereItPays) {
    const std::string costs = std::string(TYNDALL_SAMPLES) + "/costs/console_2013.json";
    const ToolRun two = schedule({frame_file("hall"), "--queues", "graphics,compute:0", "--costs", costs});
    EXPECT_EQ(two.exit_code, 0) << two.errors;
    for (const char* pass : {"density injection", "light clustering", "ESM downsample", "ESM blur x", "ESM blur y",
                             "froxel lighting", "fog accumulation"}) {
        EXPECT_EQ(queue_of(two.output, pass), "compute") << pass;
    }
    for (const char* pass : {"depth pre-pass", "opaque"}) {
        EXPECT_EQ(queue_of(two.output, pass), "graphics") << pass;
    }
    expect_in(two.output, " ms: overlap\n");
    const ToolRun one = schedule({frame_file("hall")});
    EXPECT_EQ(queue_of(one.output, "froxel lighting"), "graphics");
    expect_in(one.output, ": serial, there is one queue\n");
}

TEST_F(Schedule, WritesEveryFormatAndTakesItsOwnPlanBack) {
    const auto file = [&](const char* name) { return (folder_ / name).string(); };
    const ToolRun run =
        schedule({frame_file("wronski_2014"), "--out", file("plan.json"), "--out", file("report.txt"), "--out",
                  file("graph.dot"), "--out", file("page.html"), "--trace", file("trace.json")});
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_EQ(read_all(file("report.txt")), run.output);
    EXPECT_EQ(read_all(file("graph.dot")).rfind("digraph", 0), 0U);
    EXPECT_EQ(read_all(file("page.html")).rfind("<!doctype html>", 0), 0U);
    EXPECT_GT(nlohmann::json::parse(read_all(file("trace.json")))["traceEvents"].size(), 15U);
    const ToolRun again = schedule({frame_file("wronski_2014"), "--plan", file("plan.json"), "--verify"});
    EXPECT_EQ(again.exit_code, 0) << again.errors;
    EXPECT_EQ(again.output.rfind(run.output, 0), 0U);
    const ToolRun json = schedule({frame_file("wronski_2014"), "--json"});
    EXPECT_EQ(json.output, read_all(file("plan.json")));

    // A plan that somebody broke: proved no more.
    nlohmann::ordered_json plan = nlohmann::ordered_json::parse(read_all(file("plan.json")));
    for (auto& dependency : plan["dependencies"]) {
        dependency["src_access"] = nlohmann::ordered_json::array();
        dependency["local_access"] = nlohmann::ordered_json::array();
    }
    write_text(file("broken.json"), plan.dump());
    const ToolRun broken = schedule({frame_file("wronski_2014"), "--plan", file("broken.json"), "--verify"});
    EXPECT_EQ(broken.exit_code, 1);
    EXPECT_EQ(broken.output.find("free of races"), std::string::npos);
    expect_in(broken.errors, "tyndall: ");
}

TEST_F(Schedule, EachSwitchTurnsOneThingOff) {
    const std::string frame = frame_file("deferred");
    const std::string all = schedule({frame}).output;
    expect_in(all, ": overlap\n");
    const std::string serial = schedule({frame, "--switch", "serial"}).output;
    expect_in(serial, ": serial, asynchronous queues are switched off\n");
    expect_in(serial, ", 0 waits between queues");
    const std::string alone = schedule({frame, "--switch", "no-aliasing", "--switch", "serial"}).output;
    expect_in(alone, "transient memory 197.58 MiB, at least");
    expect_in(schedule({frame, "--switch", "full-barriers"}).output, "all commands (memory read|memory write)");
    EXPECT_NE(schedule({frame, "--switch", "no-reordering"}).output, all);
    const std::string unread = (folder_ / "unread.json").string();
    write_text(unread, R"({"resources": [{"name": "sums", "bytes": 64}], "passes": [
        {"name": "add up", "kind": "compute", "accesses": [{"writes": "sums", "as": "storage_compute"}]}]})");
    expect_in(schedule({unread}).output, "left out: nothing reads 'sums'");
    EXPECT_EQ(schedule({unread, "--switch", "no-culling"}).output.find("left out: "), std::string::npos);
    EXPECT_EQ(schedule({unread, "--switch", "no-culling", "--verify"}).exit_code, 0);
    const ToolRun quick = schedule({frame, "--switch", "no-refinement"});
    EXPECT_NE(quick.output, all);
    EXPECT_EQ(quick.errors.find("searched"), std::string::npos);
    expect_in(schedule({frame}).errors, "note: searched 200000 steps: a shorter schedule may exist");
    const ToolRun poison = schedule({frame, "--switch", "poison"});
    EXPECT_EQ(poison.output, all);
    expect_in(poison.errors, "note: poison");
    const ToolRun unknown = schedule({frame, "--switch", "everything"});
    EXPECT_EQ(unknown.exit_code, 2);
    expect_in(unknown.errors, "everything");
}

TEST_F(Schedule, AFaultyFrameIsAnsweredWithAllItsMistakes) {
    const std::string file = (folder_ / "faulty.json").string();
    write_text(file, R"({
      "resources": [{"name": "depth", "format": "D32_SFLAOT", "size": [64, 64]},
                    {"name": "color", "format": "R8G8B8A8_UNORM", "size": [64, 64]}],
      "passes": [{"name": "opaque", "kind": "graphics", "accesses": [{"writes": "colour", "as": "color_attachment"}]},
                 {"name": "post", "kind": "compute", "accesses": [{"reads": "color", "as": "sampled_compute"}]},
                 {"name": "idle", "kind": "compute"}]})");
    const ToolRun run = schedule({file});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(run.output, "");
    EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 3) << run.errors;
    expect_in(run.errors, "Resource 'depth' has the unknown format 'D32_SFLAOT'; did you mean 'D32_SFLOAT'?");
    expect_in(run.errors, "Pass 'opaque', access 0, names the unknown resource 'colour'; did you mean 'color'?");
    expect_in(run.errors, "Pass 'idle' accesses nothing");
    expect_in(run.errors, file);
}

TEST_F(Schedule, BadArgumentsEndWithOneSentence) {
    const std::string frame = frame_file("deferred");
    for (const std::vector<std::string>& arguments : {std::vector<std::string>{"no/such/frame.json"},
                                                      {folder_.string()},
                                                      {frame, "--queues", "compute"},
                                                      {frame, "--queues", "graphics,compute:x"},
                                                      {frame, "--queues", ""},
                                                      {frame, "--queues", "graphics,compute,"},
                                                      {frame, "--out", "plan.xml"},
                                                      {frame, "--out", "/no/such/folder/plan.json"},
                                                      {frame, "--costs", frame},
                                                      {frame, "--plan", frame}}) {
        SCOPED_TRACE(arguments.back());
        const ToolRun run = schedule(arguments);
        EXPECT_EQ(run.exit_code, 2) << run.errors;
        EXPECT_EQ(run.errors.rfind("tyndall: ", 0), 0U) << run.errors;
        EXPECT_EQ(run.output, "");
    }
}

} // namespace
} // namespace tyndall::test
