// The formats for other programs: what a program reads there is what the plan says.
#include "rendergraph/report.hpp"

#include <map>
#include <set>

#include <nlohmann/json.hpp>

#include "rendergraph/json.hpp"
#include "tests/rendergraph/any_frame.hpp"
#include "tests/rendergraph/frames.hpp"
#include "tests/rendergraph/random_costs.hpp"

namespace tyndall::rg::test {
namespace {

std::size_t count_of(const std::string& text, const std::string& what) {
    std::size_t count = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) {
        ++count;
    }
    return count;
}

TEST(ReportTrace, SlicesAreTheTimelineAndArrowsTheWaits) {
    std::size_t arrows = 0;
    for (std::uint32_t seed = 0; seed < 100; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const AnyFrame made = any_frame(seed);
        const Costs costs = random_costs(seed, made.graph.passes.size(), true);
        const auto plan = compile(made.graph, made.topology, estimate_memory(made.graph), {}, costs);
        ASSERT_TRUE(plan);
        const Timeline timeline = simulate(made.graph, *plan, costs);
        std::vector<TimelinePass> measured = timeline.passes;
        for (TimelinePass& pass : measured) {
            pass.start_ns += 500;
            pass.end_ns += 1'500;
        }
        const auto trace = nlohmann::json::parse(to_trace(made.graph, *plan, timeline, measured));
        std::map<int, std::size_t> slices;
        std::map<std::string, std::size_t> kinds;
        for (const auto& event : trace["traceEvents"]) {
            ++kinds[event["ph"]];
            if (event["ph"] != "X") {
                continue;
            }
            const int process = event["pid"];
            const TimelinePass& pass = (process == 1 ? timeline.passes : measured)[slices[process]++];
            EXPECT_EQ(event["name"], made.graph.passes[pass.pass].name);
            EXPECT_EQ(event["tid"], pass.queue);
            EXPECT_DOUBLE_EQ(event["ts"].get<double>() * 1e3, static_cast<double>(pass.start_ns));
            EXPECT_NEAR(event["dur"].get<double>() * 1e3, static_cast<double>(pass.end_ns - pass.start_ns), 1e-3);
        }
        EXPECT_EQ(slices[1], plan->passes.size());
        EXPECT_EQ(slices[2], plan->passes.size());
        EXPECT_EQ(kinds["s"], timeline.waits.size());
        EXPECT_EQ(kinds["f"], timeline.waits.size());
        EXPECT_EQ(kinds["C"], timeline.memory.size());
        EXPECT_EQ(kinds["M"], (measured.empty() ? 1 : 2) * (1 + made.topology.queues.size()));
        arrows += timeline.waits.size();
    }
    EXPECT_GT(arrows, 0U);
}

TEST(ReportTrace, WithoutAMeasurementThereIsOneProcess) {
    const DeclaredGraph fog = fog_frame();
    const Plan plan = compiled(fog.desc, two_queues());
    const std::string trace = to_trace(fog.desc, plan, simulate(fog.desc, plan, {}));
    EXPECT_EQ(trace.find("\"measured\""), std::string::npos);
    EXPECT_NE(trace.find("\"predicted\""), std::string::npos);
}

TEST(ReportDot, ANodeAPassAndAnEdgeADependency) {
    const DeclaredGraph fog = fog_frame();
    const Plan plan = compiled(fog.desc, two_queues());
    const std::string dot = to_dot(fog.desc, plan);
    std::size_t edges = plan.statistics.wait_count;
    for (const Dependency& dependency : plan.dependencies) {
        edges += dependency.producer != none && dependency.consumer != none ? 1 : 0;
    }
    EXPECT_EQ(count_of(dot, " -> p"), edges);
    EXPECT_EQ(count_of(dot, "subgraph cluster_"), 2U);
    for (const PassDesc& pass : fog.desc.passes) {
        EXPECT_NE(dot.find("[label=\"" + pass.name + "\""), std::string::npos) << pass.name;
    }
    EXPECT_EQ(count_of(dot, "style=dashed, tooltip="), plan.culled_passes.size());
}

TEST(ReportDot, NamesAreEscaped) {
    GraphBuilder graph;
    graph.add_pass("a \"quoted\" \\ name\nof two lines", PassKind::compute).has_side_effect("none");
    const DeclaredGraph declared = graph.finish();
    const std::string dot = to_dot(declared.desc, compiled(declared.desc, one_queue()));
    EXPECT_NE(dot.find("[label=\"a \\\"quoted\\\" \\\\ name\\nof two lines\""), std::string::npos) << dot;
}

/// What the page's script reads.
nlohmann::json data_of(const std::string& page) {
    const std::string begin = "<script type=\"application/json\" id=\"data\">";
    const std::size_t from = page.find(begin) + begin.size();
    return nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
}

TEST(ReportPage, HoldsEverythingOfThePlanWithItsReason) {
    for (std::uint32_t seed = 0; seed < 100; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const AnyFrame made = any_frame(seed);
        const auto plan = compile(made.graph, made.topology, estimate_memory(made.graph));
        ASSERT_TRUE(plan);
        const nlohmann::json data = data_of(to_html("a frame", "", made.graph, *plan, {}));
        EXPECT_EQ(data["passes"].size(), plan->passes.size());
        EXPECT_EQ(data["left_out"].size(), plan->culled_passes.size() + plan->culled_resources.size());
        EXPECT_EQ(data["waits"].size(), plan->statistics.wait_count);
        EXPECT_EQ(data["resources"].size(), made.graph.resources.size());
        EXPECT_GE(data["barriers"].size(), plan->dependencies.size());
        for (const char* list : {"passes", "left_out", "waits", "resources", "barriers"}) {
            for (const auto& entry : data[list]) {
                EXPECT_GE(entry["why"].get<std::string>().size(), 8U) << list << ": " << entry.dump();
            }
        }
    }
}

TEST(ReportPage, NoNameEndsTheScript) {
    GraphBuilder graph;
    graph.add_pass("</script><script>alert(1)</script>", PassKind::compute).has_side_effect("<img src=x>");
    graph.add_pass("bytes \xff that are no text", PassKind::compute).has_side_effect("some");
    const DeclaredGraph declared = graph.finish();
    const Plan plan = compiled(declared.desc, one_queue());
    const std::string page = to_html("<b>", "", declared.desc, plan, {});
    EXPECT_EQ(count_of(page, "</script>"), 2U);
    EXPECT_EQ(data_of(page)["passes"][0]["name"], "</script><script>alert(1)</script>");
    EXPECT_EQ(data_of(page)["title"], "<b>");
    EXPECT_NE(frame_to_json({"", declared.desc, one_queue(), {}}).find("bytes \xef\xbf\xbd that"), std::string::npos);
}

} // namespace
} // namespace tyndall::rg::test
