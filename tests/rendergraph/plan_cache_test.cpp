// An unchanged frame costs a look-up: the same plan, no heap allocation; any change that decides a plan is noticed.
#include <functional>
#include <set>
#include <utility>

#include "rendergraph/json.hpp"
#include "rendergraph/plan_cache.hpp"
#include "tests/rendergraph/any_frame.hpp"
#include "tests/rendergraph/counted_allocations.hpp"
#include "tests/rendergraph/frames.hpp"

namespace tyndall::rg::test {
namespace {

struct Inputs {
    GraphDesc graph;
    QueueTopology topology;
    MemoryRequirements memory;
    CompileOptions options;
    Costs costs;
    [[nodiscard]] PlanHash hash() const { return hash_of_inputs(graph, topology, memory, options, costs); }
};

/// A buffer and an image with a clear, a variant, a side effect, an import and an injection point.
Inputs inputs() {
    GraphBuilder builder;
    builder.set_injection_points({"post"});
    Image color = builder.import_image("a name of more than sixteen characters", color_image(), left_for_host());
    Buffer list = builder.create_buffer("list", {.size_bytes = 1024});
    const std::uint32_t variant = builder.add_variant("culling");
    builder.begin_form(variant, "by depth");
    builder.add_pass("fill", PassKind::compute).writes(list, Access::storage_compute).has_side_effect("prints");
    builder.end_form();
    builder.add_pass("draw", PassKind::graphics)
        .reads(list, Access::indirect_argument)
        .writes(color, Access::color_attachment, {.clear = clear_color(0.0F, 0.0F, 0.0F, 1.0F)});
    Inputs in{builder.finish().desc, two_queues(), {}, {}, {}};
    in.memory = estimate_memory(in.graph);
    in.costs.of_pass = {{1000, 10}, {2000, 20}};
    return in;
}

TEST(PlanCache, UnchangedFrameIsReturnedWithoutHeapAllocation) {
    for (std::uint32_t seed = 0; seed < 50; ++seed) {
        const AnyFrame frame = any_frame(seed);
        const MemoryRequirements memory = estimate_memory(frame.graph);
        PlanCache cache;
        const auto first = cache.compile(frame.graph, frame.topology, memory, {}, frame.costs);
        ASSERT_TRUE(first.has_value()) << "seed " << seed;
        const AnyFrame again = any_frame(seed); // other strings, other addresses, the same content
        const std::size_t before = allocation_count();
        const auto second = cache.compile(again.graph, again.topology, memory, {}, again.costs);
        const std::size_t after = allocation_count();
        EXPECT_EQ(after - before, 0U) << "seed " << seed;
        ASSERT_TRUE(second.has_value());
        EXPECT_EQ(*first, *second);
        EXPECT_EQ(cache.compiled(), 1U);
    }
}

TEST(PlanCache, AllocationsAreCounted) {
    const Inputs in = inputs();
    PlanCache cache;
    const std::size_t before = allocation_count();
    ASSERT_TRUE(cache.compile(in.graph, in.topology, in.memory).has_value());
    EXPECT_GT(allocation_count() - before, 0U);
}

TEST(PlanCache, GivesThePlanThatCompileGives) {
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
        const AnyFrame frame = any_frame(seed);
        PlanCache cache(true);
        const MemoryRequirements memory = estimate_memory(frame.graph);
        const auto direct = compile(frame.graph, frame.topology, memory, {}, frame.costs);
        const auto cached = cache.compile(frame.graph, frame.topology, memory, {}, frame.costs);
        ASSERT_TRUE(direct.has_value() && cached.has_value()) << "seed " << seed;
        EXPECT_EQ(first_difference(frame.graph, *direct, **cached), "") << "seed " << seed;
        ASSERT_TRUE(cache.compile(frame.graph, frame.topology, memory, {}, frame.costs).has_value());
    }
}

TEST(PlanCache, ShadowCompileStartsFromThePlanThatTheFirstOneStartedFrom) {
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
        const AnyFrame frame = any_frame(seed);
        const MemoryRequirements memory = estimate_memory(frame.graph);
        Costs nearly = frame.costs;
        for (PassCost& cost : nearly.of_pass) {
            cost.mean_ns += cost.mean_ns / 10;
        }
        PlanCache cache(true);
        ASSERT_TRUE(cache.compile(frame.graph, frame.topology, memory, {}, nearly).has_value());
        ASSERT_TRUE(cache.compile(frame.graph, frame.topology, memory, {}, frame.costs).has_value());
        ASSERT_TRUE(cache.compile(frame.graph, frame.topology, memory, {}, frame.costs).has_value());
    }
}

TEST(PlanCache, EveryChangeThatDecidesAPlanIsNoticed) {
    using Change = std::function<void(Inputs&)>;
    const std::vector<Change> changes = {
        [](Inputs&) {},
        [](Inputs& in) { in.graph.resources[0].name += "x"; },
        [](Inputs& in) { in.graph.resources[0].name[12] = 'X'; },
        [](Inputs& in) { in.graph.resources[0].name[20] = 'X'; },
        [](Inputs& in) { in.graph.resources[0].concurrent = true; },
        [](Inputs& in) { in.graph.resources[0].has_history = true; },
        [](Inputs& in) { in.graph.resources[0].lifetime = ResourceLifetime::transient; },
        [](Inputs& in) { in.graph.resources[0].import = none; },
        [](Inputs& in) { in.graph.resources[0].history_of = 1; },
        [](Inputs& in) { in.graph.resources[0].image.format = VK_FORMAT_R8_UNORM; },
        [](Inputs& in) { in.graph.resources[0].image.extent.width = 1; },
        [](Inputs& in) { in.graph.resources[0].image.extent.height = 1; },
        [](Inputs& in) { in.graph.resources[0].image.extent.depth = 2; },
        [](Inputs& in) { in.graph.resources[0].image.mips = 2; },
        [](Inputs& in) { in.graph.resources[0].image.layers = 2; },
        [](Inputs& in) { in.graph.resources[0].image.type = VK_IMAGE_TYPE_3D; },
        [](Inputs& in) { in.graph.resources[0].image.samples = VK_SAMPLE_COUNT_2_BIT; },
        [](Inputs& in) { in.graph.resources[0].image.flags = 1; },
        [](Inputs& in) { in.graph.resources[0].image.extra_usage = 1; },
        [](Inputs& in) { in.graph.resources[1].buffer.size_bytes = 2; },
        [](Inputs& in) { in.graph.resources[1].buffer.extra_usage = 1; },
        [](Inputs& in) { in.graph.passes[0].name = "fil"; },
        [](Inputs& in) { in.graph.passes[0].kind = PassKind::graphics; },
        [](Inputs& in) { in.graph.passes[0].wish = QueueWish::async_compute; },
        [](Inputs& in) { in.graph.passes[0].forbidden_queues = 2; },
        [](Inputs& in) { in.graph.passes[0].variant = none; },
        [](Inputs& in) { in.graph.passes[0].form = 1; },
        [](Inputs& in) { in.graph.passes[0].has_side_effect = false; },
        [](Inputs& in) { in.graph.passes[0].side_effect = "draws"; },
        [](Inputs& in) { in.graph.passes[0].point = 0; },
        [](Inputs& in) { in.graph.passes[1].first_access = 0; },
        [](Inputs& in) { in.graph.passes[1].access_count = 1; },
        [](Inputs& in) { in.graph.accesses[0].pass = 1; },
        [](Inputs& in) { in.graph.accesses[0].resource = 0; },
        [](Inputs& in) { in.graph.accesses[0].version = 7; },
        [](Inputs& in) { in.graph.accesses[0].access = Access::uniform_compute; },
        [](Inputs& in) { in.graph.accesses[0].direction = Direction::modify; },
        [](Inputs& in) { in.graph.accesses[0].buffer_range.offset = 4; },
        [](Inputs& in) { in.graph.accesses[0].buffer_range.size = 4; },
        [](Inputs& in) { in.graph.accesses[2].clears = false; },
        [](Inputs& in) { in.graph.accesses[2].clear.color.float32[0] = 1.0F; },
        [](Inputs& in) { in.graph.accesses[2].clear.color.float32[1] = 1.0F; },
        [](Inputs& in) { in.graph.accesses[2].clear.color.float32[2] = 1.0F; },
        [](Inputs& in) { in.graph.accesses[2].clear.color.float32[3] = 0.0F; },
        [](Inputs& in) { in.graph.accesses[2].image_range.base_mip = 1; },
        [](Inputs& in) { in.graph.accesses[2].image_range.mip_count = 1; },
        [](Inputs& in) { in.graph.accesses[2].image_range.base_layer = 1; },
        [](Inputs& in) { in.graph.accesses[2].image_range.layer_count = 1; },
        [](Inputs& in) { in.graph.accesses[2].image_range.aspects = 1; },
        [](Inputs& in) { in.graph.imports[0].initial_layout = VK_IMAGE_LAYOUT_GENERAL; },
        [](Inputs& in) { in.graph.imports[0].initial_stages = 1; },
        [](Inputs& in) { in.graph.imports[0].initial_access = 1; },
        [](Inputs& in) { in.graph.imports[0].initial_family = 0; },
        [](Inputs& in) { in.graph.imports[0].waits_semaphore = true; },
        [](Inputs& in) { in.graph.imports[0].has_final = false; },
        [](Inputs& in) { in.graph.imports[0].final_layout = VK_IMAGE_LAYOUT_GENERAL; },
        [](Inputs& in) { in.graph.imports[0].final_stages = 1; },
        [](Inputs& in) { in.graph.imports[0].final_access = 1; },
        [](Inputs& in) { in.graph.imports[0].final_family = 0; },
        [](Inputs& in) { in.graph.imports[0].signals_semaphore = true; },
        [](Inputs& in) { in.graph.imports[0].read_only = true; },
        [](Inputs& in) { in.graph.points[0] = "pre"; },
        [](Inputs& in) { in.graph.variants[0].name = "fog"; },
        [](Inputs& in) { in.graph.variants[0].forms[0] = "by frustum"; },
        [](Inputs& in) { in.graph.variants[0].forms.emplace_back("none"); },
        [](Inputs& in) { in.topology.queues[1].family = 0; },
        [](Inputs& in) { in.topology.queues[1].kind = QueueKind::transfer; },
        [](Inputs& in) { in.topology.queues[1].capabilities = can_compute; },
        [](Inputs& in) { in.topology.queues.pop_back(); },
        [](Inputs& in) { in.memory.of_resource[1].size_bytes *= 2; },
        [](Inputs& in) { in.memory.of_resource[1].alignment *= 2; },
        [](Inputs& in) { in.memory.of_resource[1].memory_type_bits = 1; },
        [](Inputs& in) { in.memory.buffer_image_granularity = 1024; },
        [](Inputs& in) { in.options.culling = false; },
        [](Inputs& in) { in.options.aliasing = false; },
        [](Inputs& in) { in.options.async = false; },
        [](Inputs& in) { in.options.reordering = false; },
        [](Inputs& in) { in.options.full_barriers = true; },
        [](Inputs& in) { in.options.effort = Effort::thorough; },
        [](Inputs& in) { in.costs.of_pass[1].mean_ns = 1; },
        [](Inputs& in) { in.costs.of_pass[1].deviation_ns = 1; },
        [](Inputs& in) { in.costs.unknown_pass_ns = 1; },
        [](Inputs& in) { in.costs.cross_queue_ns = 1; },
        [](Inputs& in) { in.costs.slowdown_permille = 1001; },
        [](Inputs& in) { in.costs.threshold_ns = 1; },
        [](Inputs& in) { in.costs.threshold_permille = 1; },
    };
    std::set<std::pair<std::uint64_t, std::uint64_t>> hashes;
    for (std::size_t i = 0; i < changes.size(); ++i) {
        Inputs in = inputs();
        changes[i](in);
        const PlanHash hash = in.hash();
        EXPECT_TRUE(hashes.emplace(hash.low, hash.high).second) << "change " << i;
    }
}

TEST(PlanCache, PlacesInSourceCodeDecideNoPlan) {
    Inputs moved = inputs();
    moved.graph.passes[0].where = std::source_location::current();
    moved.graph.accesses[0].where = std::source_location::current();
    EXPECT_EQ(moved.hash(), inputs().hash());
}

TEST(PlanCache, FailureKeepsTheLastPlanAndMistakesAreNeverHidden) {
    Inputs in = inputs();
    PlanCache cache;
    const auto good = cache.compile(in.graph, in.topology, in.memory);
    ASSERT_TRUE(good.has_value());
    GraphDesc faulty = in.graph;
    faulty.declaration_errors.push_back({.code = DiagnosticCode::foreign_handle, .message = "A handle"});
    EXPECT_FALSE(cache.compile(faulty, in.topology, in.memory).has_value());
    const auto again = cache.compile(in.graph, in.topology, in.memory);
    ASSERT_TRUE(again.has_value());
    EXPECT_EQ(*again, *good);
    EXPECT_EQ(cache.compiled(), 1U);
}

TEST(PlanCache, DifferenceNamesWhatDiffers) {
    const Inputs in = inputs();
    const Plan plan = compiled(in.graph, in.topology);
    Plan other = plan;
    other.dependencies.front().dst_stages ^= VK_PIPELINE_STAGE_2_COPY_BIT;
    EXPECT_EQ(first_difference(in.graph, plan, plan), "");
    EXPECT_NE(first_difference(in.graph, plan, other).find("dst_stages"), std::string::npos);
}

} // namespace
} // namespace tyndall::rg::test
