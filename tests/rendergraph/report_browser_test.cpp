// The report's page in a real browser: headless Chromium, as a user opens it, with clicks. Skipped where there is none.
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "rendergraph/json.hpp"
#include "rendergraph/report.hpp"
#include "tests/rendergraph/frames.hpp"

namespace tyndall::rg::test {
namespace {

std::string read_all(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

/// Clicks through the page as a user would, then leaves what it saw as attributes of the body.
constexpr const char* visitor = R"page(<script>
addEventListener("securitypolicyviolation", event => { document.body.dataset.refused = event.blockedURI; });
addEventListener("load", () => setTimeout(() => {
  const seen = document.body.dataset;
  const click = key => {
    const target = document.querySelector(`svg [data-key="${key}"]`);
    target.dispatchEvent(new MouseEvent("click", { bubbles: true }));
    const reason = document.querySelector("#detail .reason");
    return reason ? reason.textContent : "nothing";
  };
  const shown = kind => [...document.querySelectorAll(`#timeline [data-key^="${kind}-"]`)].map(one => one.dataset.key);
  const all = (kind, list) => list.every((entry, i) => click(`${kind}-${i}`) === entry.why);
  seen.passes = new Set(shown("pass")).size;
  seen.waits = new Set(shown("wait")).size;
  seen.rightPasses = all("pass", data.passes);
  seen.rightWaits = all("wait", data.waits);
  seen.rightBarriers = data.barriers.every((b, i) => b.before < 0 || click(`barrier-${i}`) === b.why);
  seen.rightResources = data.resources.every((r, i) => r.heap < 0 || click(`resource-${i}`) === r.why);
  seen.listed = document.querySelectorAll("tr[data-key^='pass-']").length;
  seen.first = click("barrier-0");
  seen.requests = performance.getEntriesByType("resource").length;
}, 0));
</script>)page";

struct Visit {
    bool ran = false;
    std::string dom;
    std::string console; ///< lines that the page wrote there
    [[nodiscard]] std::string seen(const std::string& name) const {
        const std::string begin = "data-" + name + "=\"";
        const std::size_t at = dom.find(begin);
        const std::size_t from = at + begin.size();
        return at == std::string::npos ? "missing" : dom.substr(from, dom.find('"', from) - from);
    }
};

class ReportInBrowser : public ::testing::Test {
protected:
    void SetUp() override {
        if (std::system("command -v chromium >/dev/null 2>&1") != 0) {
            GTEST_SKIP() << "chromium is not installed";
        }
        folder_ = std::filesystem::temp_directory_path() / ("tyndall_report_" + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    /// No name resolves for this browser, so that nothing can be fetched whatever the page asks for.
    Visit visit(const std::string& page) {
        const std::string file = (folder_ / "page.html").string();
        std::ofstream(file) << page << visitor;
        const std::string command = "HOME='" + folder_.string() +
                                    "' timeout 100 chromium --headless --no-sandbox --disable-gpu --no-first-run "
                                    "--disable-background-networking --disable-component-update "
                                    "--host-resolver-rules='MAP * ~NOTFOUND' --window-size=1400,1200 "
                                    "--user-data-dir='" +
                                    (folder_ / "profile").string() +
                                    "' --enable-logging=stderr --virtual-time-budget=3000 --dump-dom 'file://" + file +
                                    "' >'" + (folder_ / "dom").string() + "' 2>'" + (folder_ / "log").string() + "'";
        Visit result;
        const int status = std::system(command.c_str());
        result.ran = WIFEXITED(status) && WEXITSTATUS(status) == 0;
        result.dom = read_all(folder_ / "dom");
        std::istringstream log(read_all(folder_ / "log"));
        for (std::string line; std::getline(log, line);) {
            result.console += line.find("CONSOLE") != std::string::npos ? line + "\n" : "";
        }
        return result;
    }

    std::filesystem::path folder_;
};

void expect_sound(const Visit& seen, const Plan& plan) {
    EXPECT_TRUE(seen.ran);
    EXPECT_EQ(seen.console, "");
    EXPECT_EQ(seen.seen("passes"), std::to_string(plan.passes.size()));
    EXPECT_EQ(seen.seen("listed"), std::to_string(plan.passes.size()));
    EXPECT_EQ(seen.seen("waits"), std::to_string(plan.statistics.wait_count));
    for (const char* list : {"right-passes", "right-waits", "right-barriers", "right-resources"}) {
        EXPECT_EQ(seen.seen(list), "true") << list;
    }
    EXPECT_EQ(seen.seen("requests"), "0");
    EXPECT_EQ(seen.seen("refused"), "missing");
}

TEST_F(ReportInBrowser, SampleFrameShowsAllAndEveryClickItsReason) {
    for (const char* name : {"deferred", "wronski_2014", "hall"}) {
        SCOPED_TRACE(name);
        const auto frame = frame_from_json(read_all(std::string(TYNDALL_SAMPLE_FRAMES) + "/" + name + ".json"));
        ASSERT_TRUE(frame) << to_text(frame.error());
        const auto plan = compile(frame->graph, frame->topology, estimate_memory(frame->graph), {}, frame->costs);
        ASSERT_TRUE(plan);
        const Visit seen = visit(to_html(name, frame->about, frame->graph, *plan, frame->costs));
        expect_sound(seen, *plan);
        EXPECT_NE(seen.seen("first").find(" -&gt; "), std::string::npos) << seen.seen("first");
    }
}

TEST_F(ReportInBrowser, NamesAreTextAndNothingElse) {
    GraphBuilder graph;
    graph.add_pass("</script><script>document.body.dataset.broken = 1</script>", PassKind::compute)
        .has_side_effect("<img src='https://example.org/x' onerror='document.body.dataset.broken = 1'>");
    Image image = graph.create_image("<b>bold</b>", color_image());
    graph.add_pass("${1 + 1}", PassKind::compute).writes(image, Access::storage_compute).has_side_effect("\"'`");
    const DeclaredGraph declared = graph.finish();
    const Plan plan = compiled(declared.desc, one_queue());
    const Visit seen = visit(to_html("<i>title</i>", "&amp;", declared.desc, plan, {}));
    expect_sound(seen, plan);
    EXPECT_EQ(seen.seen("broken"), "missing");
}

/// The observers observe: a page that asks for something and one whose script fails are found out.
TEST_F(ReportInBrowser, ARequestAndAnErrorAreSeen) {
    const DeclaredGraph fog = fog_frame();
    const Plan plan = compiled(fog.desc, two_queues());
    const std::string page = to_html("fog", "", fog.desc, plan, {});
    const Visit asking = visit(page + "<img src='https://example.org/picture.png'>");
    EXPECT_NE(asking.seen("refused"), "missing");
    EXPECT_NE(asking.console, "");
    const Visit failing = visit(page + "<script>undefinedFunction();</script>");
    EXPECT_NE(failing.console.find("undefinedFunction"), std::string::npos) << failing.console;
}

} // namespace
} // namespace tyndall::rg::test
