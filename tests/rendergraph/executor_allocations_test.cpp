// A steady frame of the executor allocates nothing on the heap. The device does nothing, so that no driver's
// allocations are among those that are counted.
#include "tests/rendergraph/counted_allocations.hpp"
#include "tests/rendergraph/frames.hpp"
#include "tests/rendergraph/random_graph.hpp"
#include "tests/rendergraph/recording_device.hpp"

namespace tyndall::rg::test {
namespace {

constexpr std::uint32_t frames_to_settle = 10; ///< slots, both copies of histories, unused objects given back
constexpr std::uint32_t frames_counted = 10;

class Allocations : public testing::Test {
protected:
    Allocations() { device_.remembers = false; }

    /// Of the frames after those in which it settles.
    [[nodiscard]] std::size_t in_steady_frames(ExecutorInfo info, const DeclaredGraph& graph,
                                               const QueueTopology* topology = nullptr) {
        tl::expected<Executor, ExecuteError> executor = Executor::create(std::move(info));
        EXPECT_TRUE(executor.has_value());
        const auto plan = compile(graph.desc, topology != nullptr ? *topology : executor->topology(),
                                  executor->memory_requirements(graph.desc));
        if (!plan) {
            ADD_FAILURE() << to_text(plan.error());
            return 0;
        }
        const std::vector<ImportBinding> imports = made_up_bindings(graph.desc);
        std::size_t before = 0;
        for (std::uint32_t frame = 0; frame < frames_to_settle + frames_counted; ++frame) {
            if (frame == frames_to_settle) {
                before = allocation_count();
            }
            const auto submitted = executor->submit(graph.desc, *plan, graph.callbacks, imports);
            if (!submitted) {
                ADD_FAILURE() << submitted.error().message;
                return 0;
            }
        }
        return allocation_count() - before;
    }
    [[nodiscard]] ExecutorInfo any_queues() const {
        return device_.info({QueueKind::graphics, QueueKind::compute, QueueKind::transfer});
    }

    RecordingDevice device_;
};

TEST_F(Allocations, ASteadyFrameMakesNoneWhateverItDeclares) {
    for (std::uint32_t seed = 0; seed < 100; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const DeclaredGraph graph = random_frame(seed);
        const QueueTopology topology = random_topology(seed);
        ASSERT_EQ(in_steady_frames(any_queues(), graph, &topology), 0U);
        ExecutorInfo poisoned = any_queues();
        poisoned.poison_transients = true;
        ASSERT_EQ(in_steady_frames(std::move(poisoned), graph, &topology), 0U);
    }
}

TEST_F(Allocations, NorDoesWhatPassesAskFor) {
    GraphBuilder graph;
    Image sum = graph.create_image("sum", color_image());
    const Image before = graph.history_of(sum);
    Buffer numbers = graph.create_buffer("numbers", {.size_bytes = 1024});
    Image output = graph.import_image("output", color_image(), left_for_host());
    graph.add_pass("fill", PassKind::transfer)
        .writes(numbers, Access::transfer_destination)
        .executes([=](PassContext& ctx) { static_cast<void>(ctx.buffer(numbers)); });
    static constexpr ReflectedBinding shader[] = {{0, 0, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, true, false},
                                                  {0, 1, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, false, true},
                                                  {0, 2, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, true, false}};
    std::uint32_t called = 0;
    graph.add_pass("accumulate", PassKind::compute)
        .reads(before, Access::sampled_compute)
        .reads(numbers, Access::storage_compute)
        .writes(sum, Access::storage_compute)
        .executes([=, &called](PassContext& ctx) {
            called += ctx.history_valid(before) ? 1 : 0;
            ctx.push(VK_PIPELINE_BIND_POINT_COMPUTE, VK_NULL_HANDLE, 0,
                     std::array{ctx.sampled(0, before, VK_NULL_HANDLE), ctx.storage(1, sum), ctx.storage(2, numbers)},
                     shader);
        });
    graph.add_pass("draw", PassKind::graphics)
        .reads(sum, Access::sampled_fragment)
        .writes(output, Access::color_attachment, {.clear = clear_color(0, 0, 0, 1)})
        .executes([=](PassContext& ctx) {
            static_cast<void>(ctx.view(sum));
            static_cast<void>(ctx.layout(sum));
            static_cast<void>(ctx.pass_name());
        });
    ExecutorInfo checked = any_queues();
    checked.check_bindings = true;
    EXPECT_EQ(in_steady_frames(std::move(checked), graph.finish()), 0U);
    EXPECT_EQ(called, frames_to_settle + frames_counted - 1);
}

} // namespace
} // namespace tyndall::rg::test
