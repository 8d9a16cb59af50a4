// What a user is told of attachments that cannot be rendered to together.
#include "tests/rendergraph/expect_mistakes.hpp"

namespace tyndall::rg::test {
namespace {

constexpr ImageDesc layered = {.format = VK_FORMAT_R8G8B8A8_UNORM, .extent = {64, 64, 1}, .layers = 4};
constexpr ImageDesc multisampled = {
    .format = VK_FORMAT_R16G16B16A16_SFLOAT, .extent = {64, 64, 1}, .samples = VK_SAMPLE_COUNT_4_BIT};
constexpr ImageDesc depth = {.format = VK_FORMAT_D32_SFLOAT, .extent = {64, 64, 1}};

TEST(AttachmentMistakes, Layers) {
    GraphBuilder graph;
    Image a = graph.create_image("a", layered);
    Image b = graph.create_image("b", layered);
    PassBuilder pass = graph.add_pass("draw", PassKind::graphics);
    pass.has_side_effect("test");
    const unsigned first = __LINE__ + 1;
    pass.writes(a, Access::color_attachment, {.range = {.base_layer = 1, .layer_count = 2}});
    const unsigned second = __LINE__ + 1;
    pass.writes(b, Access::color_attachment, {.range = {.base_layer = 1}});
    expect_one(
        mistakes(graph), DiagnosticCode::attachment_mismatch,
        "Pass 'draw' renders to 'a' (64x64, 2 layers, 1 samples) and 'b' (64x64, 3 layers, 1 samples); make them "
        "equal",
        second, first);
}

TEST(AttachmentMistakes, SeveralMips) {
    GraphBuilder graph;
    const unsigned made = __LINE__ + 1;
    Image a = graph.create_image("a", {.format = VK_FORMAT_R8G8B8A8_UNORM, .extent = {64, 64, 1}, .mips = 3});
    PassBuilder pass = graph.add_pass("draw", PassKind::graphics);
    const unsigned used = __LINE__ + 1;
    pass.writes(a, Access::color_attachment, {.range = {.base_mip = 1}}).has_side_effect("test");
    expect_one(mistakes(graph), DiagnosticCode::attachment_mismatch,
               "Pass 'draw' renders to several mips of 'a' at once; name one of them", used, made);
}

TEST(AttachmentMistakes, TwoDepths) {
    GraphBuilder graph;
    Image a = graph.create_image("a", depth);
    Image b = graph.create_image("b", depth);
    PassBuilder pass = graph.add_pass("draw", PassKind::graphics);
    pass.has_side_effect("test");
    const unsigned first = __LINE__ + 1;
    pass.writes(a, Access::depth_attachment);
    const unsigned second = __LINE__ + 1;
    pass.writes(b, Access::depth_attachment);
    expect_one(mistakes(graph), DiagnosticCode::attachment_mismatch,
               "Pass 'draw' renders to two depth attachments, 'a' and 'b'; split the pass", second, first);
}

TEST(AttachmentMistakes, ResolveTargets) {
    GraphBuilder graph;
    Image color = graph.create_image("color", multisampled);
    Image fits = graph.create_image("fits", color_image(64, 64));
    Image small = graph.create_image("small", color_image(32, 64));
    graph.add_pass("resolve", PassKind::graphics)
        .writes(color, Access::color_attachment)
        .writes(fits, Access::resolve_attachment)
        .has_side_effect("test");
    PassBuilder pass = graph.add_pass("draw", PassKind::graphics);
    pass.has_side_effect("test");
    const unsigned first = __LINE__ + 1;
    pass.writes(color, Access::color_attachment);
    const unsigned second = __LINE__ + 1;
    pass.writes(small, Access::resolve_attachment);
    expect_one(mistakes(graph), DiagnosticCode::attachment_mismatch,
               "Pass 'draw' renders to 'color' (64x64, 1 layers, 4 samples) and 'small' (32x64, 1 layers, 1 samples); "
               "make them equal",
               second, first);
}

TEST(AttachmentMistakes, ResolveIntoSeveralSamples) {
    GraphBuilder graph;
    Image color = graph.create_image("color", multisampled);
    const unsigned made = __LINE__ + 1;
    Image target = graph.create_image("target", multisampled);
    PassBuilder pass = graph.add_pass("draw", PassKind::graphics);
    pass.writes(color, Access::color_attachment).has_side_effect("test");
    const unsigned used = __LINE__ + 1;
    pass.writes(target, Access::resolve_attachment);
    expect_one(
        mistakes(graph), DiagnosticCode::attachment_mismatch,
        "Pass 'draw' renders to 'target' as resolve_attachment, which has several samples itself; resolve into an "
        "image with one",
        used, made);
}

TEST(AttachmentMistakes, ResolveOfNothing) {
    GraphBuilder graph;
    Image color = graph.create_image("color", multisampled);
    Image one = graph.create_image("one", color_image(64, 64));
    const unsigned made = __LINE__ + 1;
    Image two = graph.create_image("two", color_image(64, 64));
    PassBuilder pass = graph.add_pass("draw", PassKind::graphics);
    pass.writes(color, Access::color_attachment).writes(one, Access::resolve_attachment).has_side_effect("test");
    const unsigned used = __LINE__ + 1;
    pass.writes(two, Access::resolve_attachment);
    expect_one(mistakes(graph), DiagnosticCode::attachment_mismatch,
               "Pass 'draw' renders to 'two' as resolve_attachment, for which no color_attachment with several samples "
               "is left; declare what is resolved into it",
               used, made);
    GraphBuilder without;
    Image plain = without.create_image("plain", color_image(64, 64));
    one = without.create_image("one", color_image(64, 64));
    without.add_pass("draw", PassKind::graphics)
        .writes(one, Access::resolve_attachment)
        .writes(plain, Access::color_attachment)
        .has_side_effect("test");
    EXPECT_EQ(mistakes(without).size(), 1U);
}

TEST(AttachmentMistakes, ResolveIntoAnotherFormat) {
    GraphBuilder graph;
    Image color = graph.create_image("color", multisampled);
    ImageDesc other = color_image(64, 64);
    other.format = VK_FORMAT_R8G8B8A8_UNORM;
    Image target = graph.create_image("target", other);
    PassBuilder pass = graph.add_pass("draw", PassKind::graphics);
    pass.has_side_effect("test");
    const unsigned first = __LINE__ + 1;
    pass.writes(color, Access::color_attachment);
    const unsigned second = __LINE__ + 1;
    pass.writes(target, Access::resolve_attachment);
    expect_one(mistakes(graph), DiagnosticCode::attachment_mismatch,
               "Pass 'draw' renders to 'target' as resolve_attachment of 'color', which has another format; make them "
               "equal",
               second, first);
}

TEST(AttachmentMistakes, ResolveBeforeWhatIsDrawn) {
    GraphBuilder graph;
    Image small = graph.create_image("small", color_image(32, 64));
    Image color = graph.create_image("color", multisampled);
    PassBuilder pass = graph.add_pass("draw", PassKind::graphics);
    pass.has_side_effect("test");
    const unsigned first = __LINE__ + 1;
    pass.writes(small, Access::resolve_attachment);
    const unsigned second = __LINE__ + 1;
    pass.writes(color, Access::color_attachment);
    expect_one(mistakes(graph), DiagnosticCode::attachment_mismatch,
               "Pass 'draw' renders to 'small' (32x64, 1 layers, 1 samples) and 'color' (64x64, 1 layers, 4 samples); "
               "make them equal",
               second, first);
}

/// What is resolved into comes first; the two that are drawn to are compared with each other.
TEST(AttachmentMistakes, SamplesBehindAResolve) {
    GraphBuilder graph;
    Image target = graph.create_image("target", color_image(64, 64));
    Image color = graph.create_image("color", multisampled);
    Image plain = graph.create_image("plain", color_image(64, 64));
    PassBuilder pass = graph.add_pass("draw", PassKind::graphics);
    pass.writes(target, Access::resolve_attachment).has_side_effect("test");
    const unsigned first = __LINE__ + 1;
    pass.writes(color, Access::color_attachment);
    const unsigned second = __LINE__ + 1;
    pass.writes(plain, Access::color_attachment);
    expect_one(mistakes(graph), DiagnosticCode::attachment_mismatch,
               "Pass 'draw' renders to 'color' (64x64, 1 layers, 4 samples) and 'plain' (64x64, 1 layers, 1 samples); "
               "make them equal",
               second, first);
}

TEST(AttachmentMistakes, SeveralSamplesWithMips) {
    GraphBuilder graph;
    ImageDesc desc = multisampled;
    desc.mips = 2;
    const unsigned made = __LINE__ + 1;
    (void)graph.create_image("a", desc);
    expect_one(mistakes(graph), DiagnosticCode::bad_description,
               "Resource 'a' has several samples, which only 2D images with one mip can have", made, made);
}

} // namespace
} // namespace tyndall::rg::test
