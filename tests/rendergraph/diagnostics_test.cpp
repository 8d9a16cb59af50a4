// What a user is told: the text of each kind of mistake, and where both sides of it were declared.
#include <array>
#include <fstream>
#include <sstream>

#include "rendergraph/injection.hpp"
#include "rendergraph/json.hpp"
#include "rendergraph/plan_cache.hpp"
#include "tests/rendergraph/expect_mistakes.hpp"

namespace tyndall::rg::test {
namespace {

TEST(Diagnostics, ReadOfUnwritten) {
    GraphBuilder graph;
    const unsigned made = __LINE__ + 1;
    const Image image = graph.create_image("image", color_image());
    const unsigned read = __LINE__ + 1;
    graph.add_pass("use", PassKind::compute).reads(image, Access::sampled_compute).has_side_effect("test");
    expect_one(mistakes(graph), DiagnosticCode::read_of_unwritten,
               "Pass 'use' reads 'image', which no pass wrote before; let a pass write it, or import it", read, made);
}

TEST(Diagnostics, ReadOfPartsUnwritten) {
    GraphBuilder graph;
    const unsigned made = __LINE__ + 1;
    Image image = graph.create_image("image", {.format = VK_FORMAT_R32_SFLOAT, .extent = {8, 8, 1}, .layers = 2});
    graph.add_pass("half", PassKind::compute).writes(image, Access::storage_compute, {.range = {.layer_count = 1}});
    const unsigned read = __LINE__ + 1;
    graph.add_pass("use", PassKind::compute).reads(image, Access::sampled_compute).has_side_effect("test");
    expect_one(mistakes(graph), DiagnosticCode::read_of_unwritten,
               "Pass 'use' reads 'image', parts of which no pass wrote before; let a pass write it, or import it", read,
               made);
}

TEST(Diagnostics, ReadOfAnImportWithoutContent) {
    for (const bool modifies : {false, true}) {
        GraphBuilder graph;
        const unsigned made = __LINE__ + 1;
        Image image = graph.import_image("image", color_image(), left_for_host());
        PassBuilder pass = graph.add_pass("use", PassKind::compute);
        pass.has_side_effect("test");
        const unsigned used = __LINE__ + 1;
        modifies ? pass.modifies(image, Access::storage_compute) : pass.reads(image, Access::storage_compute);
        expect_one(mistakes(graph), DiagnosticCode::read_of_unwritten,
                   std::string("Pass 'use' ") + (modifies ? "modifies" : "reads") +
                       " 'image', which no pass wrote before; let a pass write it, or import it with the layout it "
                       "comes in",
                   used, made);
    }
}

TEST(Diagnostics, TwoWriters) {
    GraphBuilder graph;
    Buffer buffer = graph.import_buffer("buffer", {.size_bytes = 16}, {.has_final = true});
    Buffer stale = buffer;
    const unsigned first = __LINE__ + 1;
    graph.add_pass("one", PassKind::compute).writes(buffer, Access::storage_compute);
    const unsigned second = __LINE__ + 1;
    graph.add_pass("two", PassKind::compute).writes(stale, Access::storage_compute);
    expect_one(
        mistakes(graph), DiagnosticCode::two_writers,
        "Passes 'one' and 'two' both write version 1 of 'buffer'; pass on the handle that the first write returned",
        second, first);
}

TEST(Diagnostics, HostTooEarly) {
    GraphBuilder graph;
    Buffer sums = graph.create_buffer("sums", {.size_bytes = 16});
    const unsigned written = __LINE__ + 1;
    graph.add_pass("add up", PassKind::compute).writes(sums, Access::storage_compute);
    const unsigned read = __LINE__ + 1;
    graph.add_pass("look", PassKind::host).reads(sums, Access::host).has_side_effect("prints them");
    expect_one(mistakes(graph), DiagnosticCode::host_too_early,
               "Pass 'look' runs on the host while the frame is recorded, but 'add up' must have written 'sums' before "
               "it; let the frame leave it to the host and use it when the frame is done",
               read, written);
}

TEST(Diagnostics, Cycle) {
    GraphBuilder graph;
    Buffer x = graph.create_buffer("x", {.size_bytes = 16});
    Buffer y = graph.create_buffer("y", {.size_bytes = 16});
    const unsigned a_line = __LINE__ + 1;
    PassBuilder a = graph.add_pass("a", PassKind::compute);
    const unsigned b_line = __LINE__ + 1;
    PassBuilder b = graph.add_pass("b", PassKind::compute);
    a.writes(x, Access::storage_compute);
    b.reads(x, Access::storage_compute).writes(y, Access::storage_compute);
    a.reads(y, Access::storage_compute);
    expect_one(
        mistakes(graph), DiagnosticCode::cycle,
        "The data flow runs in a circle: 'a' -> 'b' -> 'a'; let one of them read an earlier version or a history",
        a_line, b_line);
}

TEST(Diagnostics, AccessNotPossible) {
    GraphBuilder graph;
    const unsigned made = __LINE__ + 1;
    Image image = graph.create_image("image", color_image());
    const unsigned used = __LINE__ + 1;
    graph.add_pass("draw", PassKind::graphics).writes(image, Access::depth_attachment).has_side_effect("test");
    expect_one(mistakes(graph), DiagnosticCode::access_not_possible,
               "Pass 'draw' writes 'image' as depth_attachment, which a colour image cannot be; choose another access",
               used, made);
}

TEST(Diagnostics, WriteOfAReadOnlyAccess) {
    GraphBuilder graph;
    const unsigned made = __LINE__ + 1;
    Image image = graph.create_image("image", color_image());
    const unsigned used = __LINE__ + 1;
    graph.add_pass("fill", PassKind::compute).writes(image, Access::sampled_compute).has_side_effect("test");
    expect_one(
        mistakes(graph), DiagnosticCode::access_not_possible,
        "Pass 'fill' writes 'image' as sampled_compute, which can only be read; use a storage, attachment or transfer "
        "access",
        used, made);
}

TEST(Diagnostics, PassKindCannot) {
    GraphBuilder graph;
    const unsigned made = __LINE__ + 1;
    Image image = graph.create_image("image", color_image());
    const unsigned used = __LINE__ + 1;
    graph.add_pass("fill", PassKind::compute).writes(image, Access::color_attachment).has_side_effect("test");
    expect_one(mistakes(graph), DiagnosticCode::queue_cannot,
               "Pass 'fill' writes 'image' as color_attachment, which a compute pass cannot do", used, made);
}

TEST(Diagnostics, GraphicsPassOnComputeQueue) {
    GraphBuilder graph;
    const unsigned made = __LINE__ + 1;
    graph.add_pass("draw", PassKind::graphics).has_side_effect("test").on_queue(QueueWish::async_compute);
    expect_one(mistakes(graph), DiagnosticCode::queue_cannot,
               "Pass 'draw' is a graphics pass but asks for another queue; let it be automatic", made, made);
}

TEST(Diagnostics, AttachmentsDiffer) {
    GraphBuilder graph;
    Image a = graph.import_image("a", color_image(64, 64), left_for_host());
    Image b = graph.import_image("b", color_image(32, 64), left_for_host());
    PassBuilder pass = graph.add_pass("draw", PassKind::graphics);
    const unsigned first = __LINE__ + 1;
    pass.writes(a, Access::color_attachment);
    const unsigned second = __LINE__ + 1;
    pass.writes(b, Access::color_attachment);
    expect_one(
        mistakes(graph), DiagnosticCode::attachment_mismatch,
        "Pass 'draw' renders to 'a' (64x64, 1 layers, 1 samples) and 'b' (32x64, 1 layers, 1 samples); make them equal",
        second, first);
}

TEST(Diagnostics, LayerOutside) {
    GraphBuilder graph;
    const unsigned made = __LINE__ + 1;
    Image image = graph.create_image("image", {.format = VK_FORMAT_R32_SFLOAT, .extent = {8, 8, 1}, .layers = 4});
    PassBuilder pass = graph.add_pass("fill", PassKind::compute);
    const unsigned used = __LINE__ + 1;
    pass.writes(image, Access::storage_compute, {.range = {.base_layer = 3, .layer_count = 2}}).has_side_effect("test");
    expect_one(mistakes(graph), DiagnosticCode::range_outside,
               "Pass 'fill' writes 'image' as storage_compute at layers that it does not have; it has 4", used, made);
}

TEST(Diagnostics, BytesOutsideEvenWhenTheSumOverflows) {
    GraphBuilder graph;
    const unsigned made = __LINE__ + 1;
    Buffer buffer = graph.create_buffer("buffer", {.size_bytes = 64});
    PassBuilder pass = graph.add_pass("fill", PassKind::compute);
    const unsigned used = __LINE__ + 1;
    pass.writes(buffer, Access::storage_compute, {32, whole_buffer - 1}).has_side_effect("test");
    expect_one(mistakes(graph), DiagnosticCode::range_outside,
               "Pass 'fill' writes 'buffer' as storage_compute at bytes that its 64 bytes do not have", used, made);
}

TEST(Diagnostics, ImportWithoutFinalAccess) {
    GraphBuilder graph;
    const unsigned made = __LINE__ + 1;
    Buffer buffer = graph.import_buffer("buffer", {.size_bytes = 64}, {});
    graph.add_pass("fill", PassKind::compute).writes(buffer, Access::storage_compute).has_side_effect("test");
    expect_one(
        mistakes(graph), DiagnosticCode::import_incomplete,
        "Resource 'buffer' is imported and written, but its import does not say how the host uses it afterwards; give "
        "it a final use",
        made, made);
}

TEST(Diagnostics, DuplicateNames) {
    GraphBuilder graph;
    const unsigned first = __LINE__ + 1;
    Buffer a = graph.import_buffer("same", {.size_bytes = 64}, {.has_final = true});
    const unsigned second = __LINE__ + 1;
    Buffer b = graph.import_buffer("same", {.size_bytes = 64}, {.has_final = true});
    graph.add_pass("fill", PassKind::compute).writes(a, Access::storage_compute).writes(b, Access::storage_compute);
    expect_one(mistakes(graph), DiagnosticCode::duplicate_name, "Two resources are called 'same'; rename one", second,
               first);
}

TEST(Diagnostics, EmptyPass) {
    GraphBuilder graph;
    const unsigned made = __LINE__ + 1;
    graph.add_pass("idle", PassKind::compute);
    expect_one(mistakes(graph), DiagnosticCode::empty_pass,
               "Pass 'idle' accesses nothing and has no side effect; declare what it does, or remove it", made, made);
}

TEST(Diagnostics, ConflictingAccess) {
    GraphBuilder graph;
    Image image = graph.create_image("image", color_image());
    graph.add_pass("make", PassKind::compute).writes(image, Access::storage_compute);
    PassBuilder pass = graph.add_pass("blur", PassKind::compute);
    pass.has_side_effect("test");
    const unsigned first = __LINE__ + 1;
    pass.reads(image, Access::sampled_compute);
    const unsigned second = __LINE__ + 1;
    pass.writes(image, Access::storage_compute);
    expect_one(
        mistakes(graph), DiagnosticCode::conflicting_access,
        "Pass 'blur' writes 'image' as storage_compute and also reads it as sampled_compute; no image layout allows "
        "both, so split the pass or the ranges",
        second, first);
}

TEST(Diagnostics, ForeignHandle) {
    GraphBuilder other;
    const Buffer foreign = other.create_buffer("foreign", {.size_bytes = 16});
    GraphBuilder graph;
    const unsigned line = __LINE__ + 1;
    graph.add_pass("use", PassKind::compute).reads(foreign, Access::storage_compute).has_side_effect("test");
    expect_one(mistakes(graph), DiagnosticCode::foreign_handle,
               "Pass 'use' uses a handle that comes from another graph or an earlier frame; declare it here", line,
               line);
}

TEST(Diagnostics, HandleOfAnEarlierFrame) {
    GraphBuilder graph;
    const Buffer old = graph.create_buffer("old", {.size_bytes = 16});
    (void)graph.finish();
    (void)graph.create_buffer("new", {.size_bytes = 16});
    graph.add_pass("use", PassKind::compute).reads(old, Access::storage_compute).has_side_effect("test");
    const Diagnostics found = mistakes(graph);
    ASSERT_EQ(found.size(), 1U) << to_text(found);
    EXPECT_EQ(found[0].code, DiagnosticCode::foreign_handle);
}

TEST(Diagnostics, HandleOfABuilderThatStoodAtTheSameAddress) {
    std::optional<GraphBuilder> graph(std::in_place);
    const Buffer old = graph->create_buffer("old", {.size_bytes = 16});
    graph.emplace();
    (void)graph->create_buffer("new", {.size_bytes = 16});
    EXPECT_FALSE(graph->describe(old));
    graph->add_pass("use", PassKind::compute).reads(old, Access::storage_compute).has_side_effect("test");
    const Diagnostics found = mistakes(*graph);
    ASSERT_EQ(found.size(), 1U) << to_text(found);
    EXPECT_EQ(found[0].code, DiagnosticCode::foreign_handle);
}

TEST(Diagnostics, HandleNeverInitialised) {
    GraphBuilder graph;
    const unsigned line = __LINE__ + 1;
    graph.add_pass("use", PassKind::compute).reads(Image{}, Access::sampled_compute).has_side_effect("test");
    expect_one(mistakes(graph), DiagnosticCode::foreign_handle,
               "Pass 'use' uses a handle that was never initialised; create or import the resource first", line, line);
}

TEST(Diagnostics, HistoryIsReadOnlyAndNeedsAWriter) {
    GraphBuilder graph;
    const unsigned made = __LINE__ + 1;
    Buffer current = graph.create_buffer("current", {.size_bytes = 16});
    const Buffer previous = graph.history_of(current);
    graph.add_pass("use", PassKind::compute).reads(previous, Access::storage_compute).has_side_effect("test");
    expect_one(mistakes(graph), DiagnosticCode::history_misuse,
               "Resource 'current' has a history, but no pass writes it", made, made);
}

TEST(Diagnostics, TooManyMips) {
    GraphBuilder graph;
    const unsigned made = __LINE__ + 1;
    Image image = graph.create_image("image", {.format = VK_FORMAT_R8_UNORM, .extent = {16, 16, 1}, .mips = 6});
    graph.add_pass("fill", PassKind::compute).writes(image, Access::storage_compute).has_side_effect("test");
    expect_one(mistakes(graph), DiagnosticCode::bad_description, "Resource 'image' has 6 mips, but its extent allows 5",
               made, made);
}

TEST(Diagnostics, NoGraphicsQueue) {
    GraphBuilder graph;
    const DeclaredGraph declared = graph.finish();
    const auto plan = compile(declared.desc, {{{QueueKind::compute, 1, can_compute}}}, {});
    ASSERT_FALSE(plan.has_value());
    ASSERT_EQ(plan.error().size(), 1U) << to_text(plan.error());
    EXPECT_EQ(plan.error()[0].code, DiagnosticCode::no_queue);
    EXPECT_EQ(plan.error()[0].message, "The queue topology must begin with a graphics queue");
}

TEST(Diagnostics, UnknownInjectionPoint) {
    InjectionPoints points({"after_opaque", "post"});
    const unsigned added = __LINE__ + 1;
    const std::optional<Diagnostic> refused = points.add("after_opaqe", 0, [](GraphBuilder&, Blackboard&) {});
    ASSERT_TRUE(refused.has_value());
    expect_one({*refused}, DiagnosticCode::unknown_injection_point,
               "The host has no injection point 'after_opaqe'; it offers after_opaque, post", added, added);
    GraphBuilder graph;
    Blackboard blackboard;
    points.begin_frame(graph);
    const unsigned visited = __LINE__ + 1;
    points.visit("pre", graph, blackboard);
    expect_one(mistakes(graph), DiagnosticCode::unknown_injection_point, "The host visits 'pre', which it did not list",
               visited, visited);
}

TEST(Diagnostics, PlanNotRepeated) {
    GraphBuilder graph;
    Buffer out = graph.import_buffer("out", {.size_bytes = 16}, {.has_final = true});
    graph.add_pass("fill", PassKind::compute).writes(out, Access::storage_compute);
    const DeclaredGraph declared = graph.finish();
    const MemoryRequirements memory = estimate_memory(declared.desc);
    PlanCache cache(true);
    const auto plan = cache.compile(declared.desc, {}, memory);
    ASSERT_TRUE(plan.has_value());
    const_cast<Plan*>(*plan)->passes.front().keep_reason = KeepReason::side_effect; // as no one should
    const auto again = cache.compile(declared.desc, {}, memory);
    ASSERT_FALSE(again.has_value());
    ASSERT_EQ(again.error().size(), 1U);
    EXPECT_EQ(again.error()[0].code, DiagnosticCode::plan_not_repeated);
    const std::string& message = again.error()[0].message;
    EXPECT_TRUE(message.starts_with("The frame is unchanged, but compiling it gives another plan than the one that was "
                                    "kept: they differ at character "))
        << message;
    EXPECT_NE(message.find("side_effect"), std::string::npos) << message;
    EXPECT_NE(message.find("writes_import"), std::string::npos) << message;
    EXPECT_TRUE(message.ends_with("; change no plan that the cache returned")) << message;
}

TEST(Diagnostics, BadFile) {
    const auto frame = frame_from_json(R"({"passes": [{"name": "blur", "kind": "compute", "accesses":
                                           [{"reads": "image", "as": "sampled"}]}]})");
    ASSERT_FALSE(frame.has_value());
    ASSERT_EQ(frame.error().size(), 2U) << to_text(frame.error());
    for (const Diagnostic& mistake : frame.error()) {
        EXPECT_EQ(mistake.code, DiagnosticCode::bad_file);
        EXPECT_EQ(mistake.pass, "blur");
    }
    EXPECT_EQ(frame.error()[0].message, "Pass 'blur', access 0, names the unknown resource 'image'");
    EXPECT_EQ(frame.error()[1].message, "Pass 'blur', access 0, has the unknown as 'sampled'");
}

/// Whoever adds a kind of mistake adds a test of its text to this file.
TEST(Diagnostics, EachKindHasATestHere) {
    constexpr std::array names = {"foreign_handle",
                                  "read_of_unwritten",
                                  "two_writers",
                                  "host_too_early",
                                  "cycle",
                                  "access_not_possible",
                                  "queue_cannot",
                                  "attachment_mismatch",
                                  "range_outside",
                                  "import_incomplete",
                                  "duplicate_name",
                                  "empty_pass",
                                  "conflicting_access",
                                  "history_misuse",
                                  "bad_description",
                                  "no_queue",
                                  "unknown_injection_point",
                                  "plan_not_repeated",
                                  "bad_file"};
    static_assert(names.size() == static_cast<std::size_t>(DiagnosticCode::bad_file) + 1);
    std::stringstream text;
    text << std::ifstream(__FILE__).rdbuf();
    for (const char* name : names) {
        const std::string expected = std::string("DiagnosticCode::") + name + ",";
        const std::string compared = std::string("DiagnosticCode::") + name + ");";
        EXPECT_TRUE(text.str().find(expected) != std::string::npos || text.str().find(compared) != std::string::npos)
            << name;
    }
}

TEST(Diagnostics, AllMistakesAreReportedTogether) {
    GraphBuilder graph;
    graph.add_pass("idle", PassKind::compute);
    Buffer empty = graph.create_buffer("empty", {.size_bytes = 0});
    graph.add_pass("idle", PassKind::compute).writes(empty, Access::vertex_buffer);
    const Diagnostics found = mistakes(graph);
    EXPECT_GE(found.size(), 4U) << to_text(found);
}

TEST(Diagnostics, MistakesOfPassesAndOfTheDataFlowComeTogether) {
    GraphBuilder graph;
    graph.add_pass("idle", PassKind::compute);
    const Buffer unwritten = graph.create_buffer("unwritten", {.size_bytes = 64});
    graph.add_pass("use", PassKind::compute).reads(unwritten, Access::storage_compute).has_side_effect("test");
    const Diagnostics found = mistakes(graph);
    ASSERT_EQ(found.size(), 2U) << to_text(found);
    EXPECT_EQ(found[0].code, DiagnosticCode::empty_pass);
    EXPECT_EQ(found[1].code, DiagnosticCode::read_of_unwritten);
}

TEST(Diagnostics, ConsequencesOfAForeignHandleAreNotMistakes) {
    GraphBuilder other;
    Image foreign = other.create_image("foreign", {.format = VK_FORMAT_R8_UNORM, .extent = {16, 16, 1}});
    GraphBuilder graph;
    Buffer buffer = graph.create_buffer("buffer", {.size_bytes = 64});
    graph.add_pass("write", PassKind::compute).writes(foreign, Access::storage_compute).has_side_effect("test");
    graph.add_pass("read", PassKind::compute).reads(buffer, Access::storage_compute).has_side_effect("test");
    for (const Diagnostic& mistake : mistakes(graph)) {
        EXPECT_NE(mistake.code, DiagnosticCode::read_of_unwritten) << to_text(mistake);
    }
}

TEST(Diagnostics, TextNamesFileAndBothLines) {
    GraphBuilder graph;
    (void)graph.create_buffer("same", {.size_bytes = 16});
    (void)graph.create_buffer("same", {.size_bytes = 16});
    const unsigned line = __LINE__ - 1;
    const std::string text = to_text(mistakes(graph));
    EXPECT_EQ(text, "diagnostics_test.cpp:" + std::to_string(line) +
                        ": duplicate name: Two resources are called 'same'; rename one (see diagnostics_test.cpp:" +
                        std::to_string(line - 1) + ")\n");
}

} // namespace
} // namespace tyndall::rg::test
