// Frames, costs and plans through JSON and back.
#include "rendergraph/json.hpp"

#include <fstream>
#include <limits>
#include <random>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "rendergraph/explain.hpp"
#include "rendergraph/optimality.hpp"
#include "rendergraph/report.hpp"
#include "rendergraph/verify.hpp"
#include "tests/rendergraph/any_frame.hpp"
#include "tests/rendergraph/frames.hpp"
#include "tests/rendergraph/random_graph.hpp"
#include "tests/rendergraph/same_frame.hpp"

namespace tyndall::rg::test {
namespace {

std::string all_of(const Diagnostics& mistakes) {
    return to_text(mistakes);
}

Frame there_and_back(const Frame& frame) {
    const std::string text = frame_to_json(frame);
    tl::expected<Frame, Diagnostics> again = frame_from_json(text);
    EXPECT_TRUE(again) << all_of(again ? Diagnostics{} : again.error()) << text;
    if (!again) {
        return {};
    }
    expect_same(frame, *again);
    EXPECT_EQ(text, frame_to_json(*again));
    return std::move(*again);
}

/// Durations that depend on the seed, some unknown.
Costs some_costs(std::uint32_t seed, std::size_t passes) {
    Costs costs;
    for (std::uint32_t i = 0; i < passes; ++i) {
        costs.of_pass.push_back({1 + (seed * 7919 + i * 104729) % 900'000, i % 3});
    }
    costs.cross_queue_ns = 5'000 + seed % 3 * 7'500;
    return costs;
}

TEST(FrameJson, RandomFramesComeBackTheSameAndPlanTheSame) {
    const std::uint32_t count = random_graph_count(400);
    for (std::uint32_t seed = 0; seed < count && !::testing::Test::HasFailure(); ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        AnyFrame made = any_frame(seed);
        const Frame frame{"seed " + std::to_string(seed), made.graph, made.topology,
                          some_costs(seed, made.graph.passes.size())};
        const Frame again = there_and_back(frame);
        const auto plan = compile(frame.graph, frame.topology, estimate_memory(frame.graph), {}, frame.costs);
        const auto other = compile(again.graph, again.topology, estimate_memory(again.graph), {}, again.costs);
        ASSERT_TRUE(plan && other);
        EXPECT_EQ(plan_to_json(frame.graph, *plan), plan_to_json(again.graph, *other));
    }
}

TEST(FrameJson, FramesOfBuildersComeBackTheSame) {
    for (std::uint32_t seed = 0; seed < 200 && !::testing::Test::HasFailure(); ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        there_and_back({"", random_frame(seed).desc, random_topology(seed), {}});
    }
    there_and_back({"fog", fog_frame().desc, two_queues(), {}});
}

TEST(FrameJson, EverythingThatAFrameCanSay) {
    GraphBuilder builder;
    builder.set_injection_points({"early", "late"});
    Image cube = builder.create_image("a@1", {.format = VK_FORMAT_R8G8B8A8_UINT,
                                              .extent = {8, 8, 1},
                                              .mips = 2,
                                              .layers = 6,
                                              .flags = VK_IMAGE_CREATE_CUBE_COMPATIBLE_BIT,
                                              .extra_usage = VK_IMAGE_USAGE_SAMPLED_BIT});
    Image line =
        builder.create_image("a", {.format = VK_FORMAT_R16_SFLOAT, .extent = {64, 1, 1}, .type = VK_IMAGE_TYPE_1D});
    Image depth = builder.create_image(
        "depth", {.format = VK_FORMAT_D32_SFLOAT_S8_UINT, .extent = {8, 8, 1}, .samples = VK_SAMPLE_COUNT_4_BIT});
    Buffer unknown_bits = builder.create_buffer("b", {.size_bytes = 64, .extra_usage = 1U << 30U});
    const Image before = line;
    builder.begin_injection_point(1);
    builder.add_pass("clears", PassKind::graphics)
        .writes(cube, Access::color_attachment,
                {.range = {0, 1, 2, 1}, .clear = VkClearValue{.color = {.uint32 = {1, 2, 3, 4000000000}}}})
        .has_side_effect("");
    builder.add_pass("depth", PassKind::graphics)
        .writes(depth, Access::depth_attachment, {.clear = clear_depth(0.1F, 7)});
    builder.add_pass("write", PassKind::compute)
        .writes(line, Access::storage_compute)
        .writes(unknown_bits, Access::storage_compute, {16, 32});
    builder.add_pass("again", PassKind::compute).modifies(line, Access::storage_compute);
    Image old = before;
    old.version = 1;
    builder.add_pass("old version", PassKind::compute).reads(old, Access::storage_compute).has_side_effect("looks");
    GraphDesc graph = builder.finish().desc;
    graph.variants.push_back({"form", {"long", "short"}, {}});
    graph.passes[2].variant = 0;
    graph.passes[2].form = 1;
    graph.passes[3].forbidden_queues = queue_bit(QueueKind::compute) | queue_bit(QueueKind::transfer);
    const QueueTopology odd = {{{QueueKind::graphics, 3, can_graphics | can_compute | can_transfer | can_host},
                                {QueueKind::compute, 1, can_compute | can_transfer}}};
    Costs costs;
    costs.of_pass = {{}, {12, 3}, {}, {}, {1, 0}};
    costs.unknown_pass_ns = 7;
    costs.slowdown_permille = 1'250;
    costs.threshold_ns = 0;
    costs.threshold_permille = 0;
    there_and_back({"all \"of\" it\n", graph, odd, costs});
}

TEST(FrameJson, CostsComeBackByTheNamesOfPasses) {
    const DeclaredGraph declared = fog_frame();
    Costs costs = some_costs(5, declared.desc.passes.size());
    costs.threshold_ns = 77;
    const std::string text = costs_to_json("made up", declared.desc, costs);
    const auto again = costs_from_json(text, declared.desc);
    ASSERT_TRUE(again) << all_of(again.error());
    EXPECT_EQ(again->about, "made up");
    EXPECT_EQ(again->costs, costs);
    EXPECT_TRUE(again->without_pass.empty());

    const auto other = costs_from_json(R"({"passes": {"density": {"duration_ns": 5}, "rain": {"duration_ns": 6}}})",
                                       declared.desc, costs);
    ASSERT_TRUE(other);
    EXPECT_EQ(other->without_pass, std::vector<std::string>{"rain"});
    EXPECT_EQ(other->costs.of_pass[0], (PassCost{5, 0}));
    EXPECT_EQ(other->costs.of_pass[1], costs.of_pass[1]);
}

TEST(PlanJson, PlansOfRandomFramesComeBackTheSameAndAreProvedAgain) {
    const std::uint32_t count = random_graph_count(400);
    for (std::uint32_t seed = 0; seed < count && !::testing::Test::HasFailure(); ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const AnyFrame made = any_frame(seed);
        const auto plan = compile(made.graph, made.topology, estimate_memory(made.graph), {},
                                  some_costs(seed, made.graph.passes.size()));
        ASSERT_TRUE(plan);
        const std::string text = plan_to_json(made.graph, *plan);
        const auto again = plan_from_json(text, made.graph);
        ASSERT_TRUE(again) << all_of(again.error());
        EXPECT_EQ(text, plan_to_json(made.graph, *again));
        EXPECT_EQ(to_text(made.graph, *plan), to_text(made.graph, *again));
        EXPECT_EQ(verify(made.graph, *again).size(), verify(made.graph, *plan).size());
    }
}

TEST(PlanJson, APlanOfAnotherFrameIsRefused) {
    const DeclaredGraph fog = fog_frame();
    const GraphDesc other = random_frame(1).desc;
    const auto plan = plan_from_json(plan_to_json(fog.desc, compiled(fog.desc, two_queues())), other);
    ASSERT_FALSE(plan);
    EXPECT_EQ(all_of(plan.error()), "file: The plan is of another frame: 'pass_names' differ\n"
                                    "file: The plan is of another frame: 'resource_names' differ\n");
}

TEST(PlanJson, AnIndexOutsideItsTableIsRefused) {
    const DeclaredGraph fog = fog_frame();
    Plan plan = compiled(fog.desc, two_queues());
    plan.dependencies[0].resource = 1000;
    plan.batches[0].pass_count = 1000;
    plan.placements.pop_back();
    const auto again = plan_from_json(plan_to_json(fog.desc, plan), fog.desc);
    ASSERT_FALSE(again);
    EXPECT_EQ(all_of(again.error()), "file: The plan has an index outside its table as 'batches[0].first_pass'\n"
                                     "file: The plan has an index outside its table as 'dependencies[0].resource'\n"
                                     "file: The plan needs one of 'placements' for each resource\n");
}

/// The text of a plan of the fog frame with one value changed.
std::string changed_plan(const GraphDesc& graph, const std::string& at, const nlohmann::json& value) {
    nlohmann::json plan = nlohmann::json::parse(plan_to_json(graph, compiled(graph, two_queues())));
    plan.at(nlohmann::json::json_pointer(at)) = value;
    return plan.dump();
}

TEST(PlanJson, WhatAPlanCannotSayIsRefused) {
    GraphBuilder builder;
    const std::uint32_t variant = builder.add_variant("way");
    Buffer out = builder.import_buffer("out", {.size_bytes = 64}, {.has_final = true});
    Buffer way[2] = {builder.create_buffer("way", {.size_bytes = 64})};
    way[1] = way[0];
    for (std::size_t i = 0; i < 2; ++i) {
        builder.begin_form(variant, i == 0 ? "a" : "b");
        builder.add_pass(i == 0 ? "first" : "second", PassKind::compute).writes(way[i], Access::storage_compute);
    }
    builder.end_form();
    builder.add_pass("use", PassKind::compute)
        .reads(either(way[0], way[1]), Access::storage_compute)
        .writes(out, Access::storage_compute);
    const GraphDesc graph = builder.finish().desc;
    const auto answer = [&](const std::string& at, const nlohmann::json& value) {
        const auto plan = plan_from_json(changed_plan(graph, at, value), graph);
        return plan ? "" : all_of(plan.error());
    };
    const nlohmann::json null = nullptr;
    const auto outside = [](const std::string& what) {
        return "file: The plan has an index outside its table as '" + what + "'\n";
    };
    const auto needs = [](const std::string& what, const std::string& where) {
        return "file: The plan needs " + what + " as '" + where + "'\n";
    };
    EXPECT_EQ(answer("/passes/0/slot", 0), "");
    EXPECT_EQ(answer("/passes/0/keep_for", null), ""); // culling may be switched off
    EXPECT_EQ(answer("/passes/1/keep_for", null), outside("passes[1].keep_for"));
    EXPECT_EQ(answer("/culled_passes/0/because_of", null), outside("culled_passes[0].because_of"));
    EXPECT_EQ(answer("/placements/1/heap", null), outside("placements[1].heap"));
    EXPECT_EQ(answer("/placements/1/size_bytes", null),
              needs("a whole number up to 2251799813685248", "placements[1].size_bytes"));
    EXPECT_EQ(answer("/placements/1/offset_bytes", ~std::uint64_t{0}),
              needs("a whole number up to 2251799813685248", "placements[1].offset_bytes"));
    EXPECT_EQ(answer("/decision/serial_ns", std::numeric_limits<std::int64_t>::min()),
              needs("a whole number up to 1152921504606846976", "decision.serial_ns"));
    EXPECT_EQ(answer("/dependencies/0/new_layout", 0x80000000U), needs("a name", "dependencies[0].new_layout"));
    EXPECT_EQ(answer("/placements/1/buffer_usage", {std::uint64_t{1} << 40U}),
              needs("names", "placements[1].buffer_usage"));
    EXPECT_EQ(answer("/batches/0/signals", 1), needs("true or false", "batches[0].signals"));
    const std::string forms = "file: The plan needs a form of 'way' and a prediction for each in 'variants[0]'\n";
    EXPECT_EQ(answer("/variants/0/form", 77), forms);
    EXPECT_EQ(answer("/variants/0/predicted_ns", {1, 2, 3}), forms);
    const std::string batches =
        "file: The plan needs passes of its queue, behind those of the batch before, in 'batches[0]'\n";
    EXPECT_EQ(answer("/batches/0/pass_count", 0), batches);
    EXPECT_EQ(answer("/batches/0/queue", 1), batches);
    EXPECT_EQ(answer("/batches", nlohmann::json::array()), outside("passes[0].batch") + outside("passes[1].batch"));
}

/// All values that hold no others.
std::vector<nlohmann::json*> leaves(nlohmann::json& document) {
    std::vector<nlohmann::json*> out = {&document};
    for (std::size_t i = 0; i < out.size();) {
        if (nlohmann::json& at = *out[i]; at.is_structured() && !at.empty()) {
            out.erase(out.begin() + static_cast<std::ptrdiff_t>(i));
            for (nlohmann::json& inner : at) {
                out.push_back(&inner);
            }
        } else {
            ++i;
        }
    }
    return out;
}

/// Damage of the text, and of single values, which more often gives a plan that is read.
TEST(PlanJson, NoRandomDamageCrashes) {
    std::mt19937 bits(11);
    std::uint32_t read = 0;
    std::uint32_t refused = 0;
    for (std::uint32_t i = 0; i < 1'500; ++i) {
        const AnyFrame made = any_frame(1 + i % 100);
        std::string text = plan_to_json(made.graph, *plan_of(made));
        if (i % 8 == 0) {
            text[bits() % text.size()] = static_cast<char>("0{}[]\",:x9"[bits() % 10]);
        } else {
            nlohmann::json document = nlohmann::json::parse(text);
            const std::vector<nlohmann::json*> all = leaves(document);
            for (std::uint32_t k = 0; k < 1 + i % 2; ++k) {
                const nlohmann::json values[] = {nullptr,
                                                 0,
                                                 1,
                                                 bits() % 8,
                                                 0xffffffffU,
                                                 std::numeric_limits<std::int64_t>::min(),
                                                 std::numeric_limits<std::uint64_t>::max(),
                                                 std::uint64_t{1} << (bits() % 64),
                                                 "history",
                                                 true};
                *all[bits() % all.size()] = values[bits() % std::size(values)];
            }
            text = document.dump();
        }
        const auto plan = plan_from_json(text, made.graph);
        if (!plan) {
            EXPECT_FALSE(plan.error().empty());
            ++refused;
            continue;
        }
        ++read;
        const Timeline timeline = simulate(made.graph, *plan, made.costs);
        EXPECT_FALSE(explain_table(made.graph, *plan).empty());
        EXPECT_FALSE(to_text(optimality(made.graph, *plan, timeline)).empty());
        EXPECT_FALSE(to_dot(made.graph, *plan).empty());
        EXPECT_FALSE(to_html("", "", made.graph, *plan, made.costs).empty());
        EXPECT_FALSE(to_trace(made.graph, *plan, timeline).empty());
        (void)verify(made.graph, *plan);
    }
    EXPECT_GT(read, 200U);
    EXPECT_GT(refused, 500U);
}

// ---- mistakes ----------------------------------------------------------------------------------------------------

std::string mistakes_of(std::string_view text) {
    const auto frame = frame_from_json(text);
    return frame ? "" : all_of(frame.error());
}

TEST(FrameJsonMistakes, BrokenSyntaxSaysWhere) {
    EXPECT_EQ(mistakes_of(R"({"passes": [}])"), "file: The file is not valid JSON at byte 13, near '\"passes\": [}'\n");
    EXPECT_EQ(mistakes_of(R"({"passes": [], "passes": []})"),
              "file: The file gives the key 'passes' twice in one object\n");
    EXPECT_EQ(mistakes_of("7"), "file: The frame must be an object\n");
}

TEST(FrameJsonMistakes, AllAtOnceEachWithPassResourceAndKey) {
    const std::string text = R"({
      "queues": ["graphics", "compte"],
      "points": ["post"],
      "resources": [
        {"name": "depth", "format": "D32_SFLAOT", "size": [64, 64]},
        {"name": "color", "format": "R8G8B8A8_UNORM", "size": [64, 64, 1, 1]},
        {"name": "lights", "bytes": -4},
        {"name": "nothing"},
        {"name": "old", "history_of": "colour"},
        {"name": "unread", "format": "R8_UNORM", "size": [0, 64]}
      ],
      "passes": [
        {"name": "pre-pass", "kind": "graphcs", "accesses": [{"writes": "depht", "as": "depth_attachment"}]},
        {"name": "opaque", "kind": "graphics", "colour": 1, "point": "pst",
         "accesses": [{"writes": "color", "as": "color_atachment"}, {"raeds": "depth", "as": "sampled_fragment"}]},
        {"name": "late", "kind": "compute", "duration_ns": 1.5, "accesses": [{"reads": "color@3", "as": "sampled_compute"}]},
        {"name": "idle", "kind": "compute", "accesses": []}
      ]})";
    EXPECT_EQ(mistakes_of(text),
              R"(file: Queue 1 has the unknown kind "compte"; did you mean 'compute'?
file: Resource 'depth' has the unknown format 'D32_SFLAOT'; did you mean 'D32_SFLOAT'?
file: Resource 'color' needs 1 to 3 whole numbers as 'size'
file: Resource 'lights' needs a whole number from 0 to 18446744073709551615 as 'bytes'
file: Resource 'nothing' needs 'format' and 'size' (an image), 'bytes' (a buffer) or 'history_of'
file: Resource 'old' is the history of the unknown resource 'colour'; did you mean 'color'?
file: Pass 'pre-pass' has the unknown kind 'graphcs'; did you mean 'graphics'?
file: Pass 'pre-pass', access 0, names the unknown resource 'depht'; did you mean 'depth'?
file: Pass 'opaque' has the unknown point 'pst'; did you mean 'post'?
file: Pass 'opaque', access 0, has the unknown as 'color_atachment'; did you mean 'color_attachment'?
file: Pass 'opaque', access 1, needs one of 'reads', 'writes' and 'modifies'
file: Pass 'opaque', access 1, has the unknown key 'raeds'; did you mean 'reads'?
file: Pass 'opaque' has the unknown key 'colour'
file: Pass 'late' needs a whole number from 0 to 10000000000 as 'duration_ns'
file: Pass 'late' names version 3 of 'color', but the frame makes 0
bad description: Resource 'unread' has an extent, mip count or layer count of 0; give it at least 1
empty pass: Pass 'idle' accesses nothing and has no side effect; declare what it does, or remove it
)");
}

TEST(FrameJsonMistakes, OfAnAccess) {
    const auto answer = [](const std::string& access, const std::string& format = "D32_SFLOAT") {
        return mistakes_of(R"({"resources": [{"name": "image", "format": ")" + format + R"(", "size": [8, 8]}],
            "passes": [{"name": "draw", "kind": "graphics", "side_effect": "test", "accesses": [)" +
                           access + "]}]}");
    };
    const auto cleared = [&](const std::string& value) {
        return answer(R"({"writes": "image", "as": "depth_attachment", "clear": )" + value + "}");
    };
    const auto colored = [&](const std::string& value, const std::string& format) {
        return answer(R"({"writes": "image", "as": "color_attachment", "clear": )" + value + "}", format);
    };
    EXPECT_EQ(cleared(R"({"depth": 0.5, "stencil": 7})"), "");
    EXPECT_EQ(cleared(R"({"dpeth": 1})"),
              "file: Pass 'draw', access 0, clear, has the unknown key 'dpeth'; did you mean 'depth'?\n");
    EXPECT_EQ(cleared(R"({"depth": 1e300})"),
              "file: Pass 'draw', access 0, clear, needs a number from 0.0 to 1.0 as 'depth'\n");
    EXPECT_EQ(cleared(R"({"stencil": -1})"),
              "file: Pass 'draw', access 0, clear, needs a whole number from 0 to 4294967295 as 'stencil'\n");
    EXPECT_EQ(colored("[0, -1.5, 3e9, 1]", "R8G8B8A8_UNORM"), "");
    EXPECT_EQ(
        colored("[0, 0, 0, 1e300]", "R8G8B8A8_UNORM"),
        "file: Pass 'draw', access 0, clears a colour image: 'clear' must be four numbers that fit into 32 bits\n");
    EXPECT_EQ(colored("[0, 0, 0, 4294967295]", "R32_UINT"), "");
    EXPECT_EQ(colored("[0, 0, 0, -1]", "R32_UINT"),
              "file: Pass 'draw', access 0, clears a colour image: 'clear' must be "
              "four whole numbers from 0 that fit into 32 bits\n");
    EXPECT_EQ(colored("[0, 0, 0, -1]", "R32_SINT"), "");
    EXPECT_EQ(colored("[0, 0, 0, 0.5]", "R32_SINT"), "file: Pass 'draw', access 0, clears a colour image: 'clear' must "
                                                     "be four whole numbers that fit into 32 bits\n");
    EXPECT_EQ(answer(R"({"reads": "image@4294967295", "as": "sampled_fragment"})"),
              "file: Pass 'draw' names version 4294967294 of 'image', but the frame makes 0\n");
    EXPECT_EQ(answer(R"({"reads": "image@99999999999999999999", "as": "sampled_fragment"})"),
              "file: Pass 'draw' names version 4294967294 of 'image', but the frame makes 0\n");
    EXPECT_EQ(answer(R"({"writes": "image@0", "as": "depth_attachment"})"),
              "file: Pass 'draw' makes version 0 of 'image', which is what was there before the frame; the first is "
              "version 1\n");
}

TEST(FrameJsonMistakes, OfTexts) {
    EXPECT_EQ(mistakes_of(R"({"resources": [{"name": "a\u0000b", "bytes": 4}]})"),
              "file: Resource 0 needs a text as 'name'\nbad description: Resource 0 has an empty name; give it one\n");
    EXPECT_EQ(mistakes_of(R"({"variants": [{"name": "v", "forms": [7]}]})"),
              "file: Variant 0 needs names in 'forms'\nfile: Variant 0 needs at least one name in 'forms'\n"
              "bad description: Variant 'v' has no form; give it at least one\n");
    const std::string answer = mistakes_of("{\"about\": \"" + std::string(100'000, 'x'));
    EXPECT_LT(answer.size(), 300U);
    EXPECT_NE(answer.find("xxx...'"), std::string::npos) << answer;
}

TEST(FrameJsonMistakes, NoRandomDamageCrashes) {
    std::mt19937 bits(7);
    const DeclaredGraph fog = fog_frame();
    const std::string whole = frame_to_json({"", fog.desc, two_queues(), {}});
    std::uint32_t refused = 0;
    for (std::uint32_t i = 0; i < 2'000; ++i) {
        std::string text = whole;
        for (std::uint32_t k = 0; k < 1 + i % 3; ++k) {
            text[bits() % text.size()] = static_cast<char>("0{}[]\",:x9"[bits() % 10]);
        }
        if (const auto frame = frame_from_json(text)) {
            const auto plan = compile(frame->graph, frame->topology, estimate_memory(frame->graph), {}, frame->costs);
            if (plan) {
                EXPECT_TRUE(verify(frame->graph, *plan).empty()) << text;
            }
        } else {
            EXPECT_FALSE(frame.error().empty());
            ++refused;
        }
    }
    EXPECT_GT(refused, 1'000U);
}

/// The example of docs/frame.md compiles, and says what the page says.
TEST(FrameJson, TheExampleInTheDocumentation) {
    std::ifstream file(TYNDALL_FRAME_PAGE);
    std::stringstream page;
    page << file.rdbuf();
    const std::string text = page.str();
    const std::size_t begin = text.find("```json\n");
    ASSERT_NE(begin, std::string::npos);
    const std::size_t first = begin + 8;
    const auto frame = frame_from_json(std::string_view(text).substr(first, text.find("```", first) - first));
    ASSERT_TRUE(frame) << all_of(frame.error());
    const auto plan = compile(frame->graph, frame->topology, estimate_memory(frame->graph), {}, frame->costs);
    ASSERT_TRUE(plan) << all_of(plan.error());
    EXPECT_TRUE(verify(frame->graph, *plan).empty());
}

} // namespace
} // namespace tyndall::rg::test
