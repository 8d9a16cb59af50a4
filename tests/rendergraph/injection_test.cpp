#include "rendergraph/injection.hpp"

#include "tests/rendergraph/frames.hpp"

namespace tyndall::rg::test {
namespace {

struct SceneColor {
    Image image;
};

TEST(Injection, FeaturesRunInOrderOfPointThenPriorityThenRegistration) {
    InjectionPoints points({"first", "second"});
    std::string trace;
    const auto note = [&trace](const char* text) {
        return [&trace, text](GraphBuilder&, Blackboard&) { trace += text; };
    };
    EXPECT_FALSE(points.add("second", 0, note("e")));
    EXPECT_FALSE(points.add("first", 5, note("c")));
    EXPECT_FALSE(points.add("first", -1, note("a")));
    EXPECT_FALSE(points.add("first", 5, note("d")));
    EXPECT_FALSE(points.add("first", 0, note("b")));
    GraphBuilder graph;
    Blackboard blackboard;
    points.begin_frame(graph);
    points.visit("first", graph, blackboard);
    points.visit("second", graph, blackboard);
    EXPECT_EQ(trace, "abcde");
}

TEST(Injection, UnknownPointsAreRefusedByName) {
    InjectionPoints points({"first", "second"});
    const std::optional<Diagnostic> error = points.add("third", 0, [](GraphBuilder&, Blackboard&) {});
    ASSERT_TRUE(error.has_value());
    EXPECT_EQ(error->message, "The host has no injection point 'third'; it offers first, second");
}

TEST(Injection, PassesRememberTheirPointAndSeeItsVersion) {
    InjectionPoints points({"after_opaque"});
    EXPECT_FALSE(points.add("after_opaque", 0, [](GraphBuilder& graph, Blackboard& blackboard) {
        graph.add_pass("fog", PassKind::graphics)
            .modifies(blackboard.find<SceneColor>()->image, Access::color_attachment);
    }));
    GraphBuilder graph;
    Blackboard blackboard;
    points.begin_frame(graph);
    Image color = graph.import_image("color", color_image(), left_for_host());
    graph.add_pass("opaque", PassKind::graphics).writes(color, Access::color_attachment);
    blackboard.put(SceneColor{color});
    points.visit("after_opaque", graph, blackboard);
    EXPECT_EQ(blackboard.find<SceneColor>()->image.version, 2U);
    const DeclaredGraph declared = graph.finish();
    EXPECT_EQ(declared.desc.passes[0].point, none);
    ASSERT_EQ(declared.desc.passes[1].point, 0U);
    EXPECT_EQ(declared.desc.points[0], "after_opaque");
    const Plan plan = compiled(declared.desc, one_queue());
    EXPECT_EQ(place_of(declared.desc, plan, "fog"), 1U);
}

TEST(Blackboard, HoldsOneValueOfEachType) {
    Blackboard blackboard;
    EXPECT_EQ(blackboard.find<int>(), nullptr);
    blackboard.put(3);
    blackboard.put(4.5F);
    blackboard.put(7);
    EXPECT_EQ(*blackboard.find<int>(), 7);
    EXPECT_EQ(*blackboard.find<float>(), 4.5F);
}

TEST(Declare, CallbacksOwnTheirCapturesAndOutliveTheBuilder) {
    auto value = std::make_shared<int>(0);
    PassCallbacks callbacks;
    {
        GraphBuilder graph;
        graph.add_pass("touch", PassKind::compute).has_side_effect("counts").executes([value](PassContext&) {
            ++*value;
        });
        callbacks = graph.finish().callbacks;
    }
    EXPECT_TRUE(callbacks.has(0));
    EXPECT_EQ(value.use_count(), 2);
}

} // namespace
} // namespace tyndall::rg::test
