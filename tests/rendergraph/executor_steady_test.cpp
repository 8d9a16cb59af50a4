// Frames that repeat: nothing is created, and time is measured.
#include <string_view>

#include "tests/rendergraph/executor_fixture.hpp"

namespace tyndall::test {
namespace {

using namespace rg;

// Objects made by the executor under test. Global because a proc-address hook takes no user data.
int created_objects = 0;

template <int id, typename... Arguments>
struct Counted {
    static inline VkResult (*real)(Arguments...) = nullptr;
    static VkResult call(Arguments... arguments) {
        ++created_objects;
        return real(arguments...);
    }
};
template <int id, typename... Arguments>
PFN_vkVoidFunction counted(PFN_vkVoidFunction found, VkResult (*)(Arguments...)) {
    using Hook = Counted<id, Arguments...>;
    Hook::real = reinterpret_cast<VkResult (*)(Arguments...)>(found);
    return reinterpret_cast<PFN_vkVoidFunction>(&Hook::call);
}
PFN_vkVoidFunction counting_proc_addr(VkDevice device, const char* name) {
    const PFN_vkVoidFunction found = vkGetDeviceProcAddr(device, name);
    const std::string_view wanted = name;
    return wanted == "vkCreateImage"              ? counted<0>(found, &vkCreateImage)
           : wanted == "vkCreateBuffer"           ? counted<1>(found, &vkCreateBuffer)
           : wanted == "vkCreateImageView"        ? counted<2>(found, &vkCreateImageView)
           : wanted == "vkAllocateMemory"         ? counted<3>(found, &vkAllocateMemory)
           : wanted == "vkCreateSemaphore"        ? counted<4>(found, &vkCreateSemaphore)
           : wanted == "vkCreateCommandPool"      ? counted<5>(found, &vkCreateCommandPool)
           : wanted == "vkAllocateCommandBuffers" ? counted<6>(found, &vkAllocateCommandBuffers)
           : wanted == "vkCreateQueryPool"        ? counted<7>(found, &vkCreateQueryPool)
                                                  : found;
}

TEST_F(ExecutorTest, SteadyFramesCreateNothing) {
    ExecutorInfo info = executor_info();
    info.get_device_proc_addr = counting_proc_addr;
    info.profile = true;
    created_objects = 0;
    make_executor(std::move(info));
    EXPECT_GT(created_objects, 0);
    constexpr VkExtent2D extent = {16, 16};
    const HostBuffer result = read_back_buffer(extent.width * extent.height * sizeof(Texel));
    const auto frame = [&] {
        GraphBuilder graph;
        Image pattern = graph.create_image("pattern", image_of(extent.width, extent.height));
        Image sum = graph.create_image("sum", image_of(extent.width, extent.height));
        const Image before = graph.history_of(sum);
        Image target = graph.create_image("target", image_of(extent.width, extent.height));
        Buffer out = import_read_back(graph, "out", result);
        add_pattern(graph, "pattern", pattern, extent, {});
        add_accumulate(graph, "sum", before, sum, extent, 1.0F, true).reads(pattern, Access::sampled_compute);
        add_double(graph, "double", sum, target);
        add_copy(graph, "copy", target, out, extent);
        run_bound(graph.finish());
    };
    for (int i = 0; i < 4; ++i) {
        frame(); // both copies of the history and both frame slots have been used
    }
    const int before = created_objects;
    for (int i = 0; i < 10; ++i) {
        frame();
    }
    EXPECT_EQ(created_objects, before);
    EXPECT_EQ(result.as<Texel>()[0][0], 28.0F);
}

TEST_F(ExecutorTest, TimestampsCoverEveryPassInOrder) {
    ExecutorInfo info = executor_info();
    info.profile = true;
    info.timestamps_need_full_barrier = true;
    make_executor(std::move(info));
    constexpr std::uint32_t count = 1 << 16;
    const HostBuffer result = read_back_buffer(count * 4);
    GraphBuilder graph;
    Buffer a = graph.create_buffer("a", {.size_bytes = count * 4});
    Buffer out = import_read_back(graph, "out", result);
    add_fill(graph, "fill", a, 5);
    add_affine(graph, "copy", a, out, 1, 0, count);
    const DeclaredGraph declared = graph.finish();
    const Plan plan = compile(declared.desc);
    EXPECT_TRUE(executor().timings().empty());
    for (int frame = 0; frame < 4; ++frame) {
        const auto error = execute(declared, plan, bindings_);
        ASSERT_FALSE(error.has_value()) << error->message;
    }
    const std::vector<PassTiming> timings = executor().timings();
    ASSERT_EQ(timings.size(), 2U);
    EXPECT_EQ(timings[0].pass, 0U);
    EXPECT_EQ(timings[1].pass, 1U);
    EXPECT_EQ(timings[0].start_ms, 0.0);
    EXPECT_GT(timings[0].duration_ms, 0.0);
    EXPECT_GT(timings[1].duration_ms, 0.0);
    EXPECT_GE(timings[1].start_ms, timings[0].duration_ms);
    EXPECT_LT(timings[1].start_ms + timings[1].duration_ms, 1000.0);
}

} // namespace
} // namespace tyndall::test
