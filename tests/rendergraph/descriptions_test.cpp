// What a user is told of names, sizes and queues: the text, and where it was declared.
#include "tests/rendergraph/expect_mistakes.hpp"

namespace tyndall::rg::test {
namespace {

TEST(Diagnostics, APassIsLeftNoQueue) {
    const auto answer = [](const std::vector<QueueKind>& forbidden, QueueWish wish, const QueueTopology& topology,
                           const std::string& message, const ImportDesc& import = {.has_final = true}) {
        GraphBuilder graph;
        Buffer buffer = graph.import_buffer("buffer", {.size_bytes = 64}, import);
        const unsigned made = __LINE__ + 1;
        PassBuilder pass = graph.add_pass("fill", PassKind::compute);
        pass.writes(buffer, Access::storage_compute).on_queue(wish);
        for (const QueueKind kind : forbidden) {
            pass.never_on(kind);
        }
        expect_one(mistakes(graph, topology), DiagnosticCode::queue_cannot, message, made, made);
    };
    const std::string none_left =
        "Pass 'fill' is left no queue but one of the kind that it forbids, graphics; allow it, "
        "or plan for a queue that can run the pass";
    const std::vector<QueueKind> graphics = {QueueKind::graphics};
    answer(graphics, QueueWish::automatic, one_queue(), none_left);
    answer(graphics, QueueWish::async_compute, one_queue(), none_left);
    answer({QueueKind::graphics, QueueKind::compute}, QueueWish::automatic, two_queues(),
           none_left + ", since an import that it touches is not shared between families");
    answer(graphics, QueueWish::automatic, two_queues(),
           none_left + ", since only the first queue is ordered with the host's use of an import that it touches",
           {.initial_stages = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, .has_final = true});
    answer(graphics, QueueWish::graphics, two_queues(),
           "Pass 'fill' asks for a queue of the kind that it forbids, graphics; choose one");
    answer({QueueKind::compute}, QueueWish::async_compute, two_queues(),
           "Pass 'fill' asks for a queue of the kind that it forbids, compute; choose one");
}

TEST(Diagnostics, NamesOfVariantsAndForms) {
    GraphDesc graph;
    graph.variants = {{"fog", {"a", "b", "a"}}, {"fog", {"a"}}, {"", {"a"}}};
    const auto plan = compile(graph, one_queue(), {});
    ASSERT_FALSE(plan.has_value());
    EXPECT_EQ(to_text(plan.error()), "bad description: Variant 2 has an empty name; give it one\n"
                                     "duplicate name: Two variants are called 'fog'; rename one\n"
                                     "duplicate name: Two forms of variant 'fog' are called 'a'; rename one\n");
}

TEST(Diagnostics, EmptyNames) {
    GraphBuilder graph;
    const unsigned made = __LINE__ + 1;
    (void)graph.create_buffer("", {.size_bytes = 64});
    expect_one(mistakes(graph), DiagnosticCode::bad_description, "Resource 0 has an empty name; give it one", made,
               made);
}

TEST(Diagnostics, MoreBytesThanAnyDeviceHas) {
    GraphBuilder graph;
    Buffer small = graph.create_buffer("small", {.size_bytes = 64});
    const unsigned made = __LINE__ + 1;
    Buffer large = graph.create_buffer("large", {.size_bytes = VkDeviceSize{1} << 63U});
    (void)graph.create_buffer("larger", {.size_bytes = ~VkDeviceSize{0}}); // said once
    graph.add_pass("fill", PassKind::compute)
        .writes(small, Access::storage_compute)
        .writes(large, Access::storage_compute)
        .has_side_effect("test");
    expect_one(mistakes(graph), DiagnosticCode::bad_description,
               "Resource 'large' is more than the frame can have with what is declared before it, 1125899906842624 "
               "bytes; make it smaller",
               made, made);
}

TEST(Diagnostics, FormatWithoutSize) {
    GraphBuilder graph;
    const unsigned made = __LINE__ + 1;
    Image image = graph.create_image("image", {.format = VK_FORMAT_G8_B8R8_2PLANE_420_UNORM, .extent = {8, 8, 1}});
    graph.add_pass("fill", PassKind::compute).writes(image, Access::storage_compute).has_side_effect("test");
    expect_one(
        mistakes(graph), DiagnosticCode::bad_description,
        "Resource 'image' has a format of which no size is known; ask the driver what memory it needs, or choose "
        "another format",
        made, made);
}

TEST(Diagnostics, QueuesThatCannotDoWhatTheirKindPromises) {
    const QueueTopology topology = {{{QueueKind::graphics, 0, can_compute}, {QueueKind::compute, 1, can_transfer}}};
    const auto plan = compile({}, topology, {});
    ASSERT_FALSE(plan.has_value());
    EXPECT_EQ(to_text(plan.error()),
              "no queue: Queue 0 is a graphics queue that cannot do both graphics and compute; let it, or plan without "
              "it\nno queue: Queue 1 is a compute queue that cannot do compute; let it, or plan without it\n");
}

} // namespace
} // namespace tyndall::rg::test
