// What the executor must refuse, and how it says so; and the negative control of synchronisation validation.
#include <cstring>

#include "tests/rendergraph/executor_fixture.hpp"

namespace tyndall::test {
namespace {

using namespace rg;

TEST_F(ExecutorTest, OneMissingBarrierIsSeenBySynchronisationValidation) {
    constexpr std::uint32_t count = 64;
    const HostBuffer result = read_back_buffer(count * 4);
    GraphBuilder graph;
    Buffer a = graph.create_buffer("a", {.size_bytes = count * 4});
    Buffer out = import_read_back(graph, "out", result);
    add_fill(graph, "fill", a, 5);
    add_affine(graph, "consumer", a, out, 1, 0, count);
    const DeclaredGraph declared = graph.finish();
    Plan plan = compile(declared.desc);
    ASSERT_EQ(plan.passes.size(), 2U);
    ASSERT_GE(plan.passes[1].barrier_count, 1U);
    plan.passes[1].barrier_count = 0;
    EXPECT_FALSE(execute(declared, plan, bindings_).has_value());
    const std::vector<std::string> errors = take_errors();
    ASSERT_FALSE(errors.empty());
    EXPECT_NE(errors.front().find("SYNC-HAZARD-READ-AFTER-WRITE"), std::string::npos) << errors.front();
}

TEST_F(ExecutorTest, AMissingBindingNamesTheResource) {
    GraphBuilder graph;
    Buffer out = graph.import_buffer("the result", {.size_bytes = 64}, read_by_host());
    add_fill(graph, "fill", out, 1);
    const DeclaredGraph declared = graph.finish();
    const auto error = execute(declared, compile(declared.desc), {});
    ASSERT_TRUE(error.has_value());
    EXPECT_EQ(error->kind, ExecuteError::Kind::missing_binding);
    EXPECT_EQ(error->message,
              "Imported resource 'the result' has no buffer bound in this frame; add it to the import bindings");
}

TEST_F(ExecutorTest, UndeclaredUseFailsTheFrameAndNamesPassAndResource) {
    const HostBuffer result = read_back_buffer(256);
    GraphBuilder graph;
    Buffer out = import_read_back(graph, "out", result);
    const Image secret = graph.create_image("secret", image_of(8, 8));
    graph.add_pass("curious", PassKind::transfer)
        .writes(out, Access::transfer_destination)
        .executes([=](PassContext& ctx) {
            EXPECT_EQ(ctx.view(secret), VK_NULL_HANDLE);
            EXPECT_EQ(ctx.storage(0, out).buffer.buffer, VK_NULL_HANDLE);
        });
    const DeclaredGraph declared = graph.finish();
    const auto error = execute(declared, compile(declared.desc), bindings_);
    ASSERT_TRUE(error.has_value());
    EXPECT_EQ(error->kind, ExecuteError::Kind::undeclared_access);
    EXPECT_EQ(error->message, "Pass 'curious' uses 'secret', which it did not declare; "
                              "Pass 'curious' uses 'out' in a way that it did not declare");

    // The next frame is not harmed.
    GraphBuilder next;
    bindings_.clear();
    Buffer again = import_read_back(next, "out", result);
    add_fill(next, "fill", again, 6);
    run_bound(next.finish());
    EXPECT_EQ(result.as<std::uint32_t>()[0], 6U);
}

TEST_F(ExecutorTest, RefusedMemoryIsAReturnValueAndLeavesNothingBehind) {
    ExecutorInfo info = executor_info();
    bool refuse = true;
    int allocated = 0;
    info.memory.allocate = [&](const VkMemoryAllocateInfo& request, VkDeviceMemory& memory) {
        if (refuse) {
            return VK_ERROR_OUT_OF_DEVICE_MEMORY;
        }
        ++allocated;
        return vk().AllocateMemory(gpu().device, &request, nullptr, &memory);
    };
    info.memory.free = [&](VkDeviceMemory memory) {
        allocated -= memory != VK_NULL_HANDLE ? 1 : 0;
        vk().FreeMemory(gpu().device, memory, nullptr);
    };
    make_executor(std::move(info));
    const HostBuffer result = read_back_buffer(256);
    GraphBuilder graph;
    Buffer a = graph.create_buffer("a", {.size_bytes = 256});
    Buffer out = import_read_back(graph, "out", result);
    add_fill(graph, "fill", a, 5);
    add_affine(graph, "copy", a, out, 1, 1, 64);
    const DeclaredGraph declared = graph.finish();
    const Plan plan = compile(declared.desc);
    const auto error = execute(declared, plan, bindings_);
    ASSERT_TRUE(error.has_value());
    EXPECT_EQ(error->kind, ExecuteError::Kind::out_of_memory);
    refuse = false;
    EXPECT_FALSE(execute(declared, plan, bindings_).has_value());
    EXPECT_EQ(result.as<std::uint32_t>()[63], 6U);
    EXPECT_EQ(allocated, 1);
    make_executor(executor_info());
    EXPECT_EQ(allocated, 0);
}

TEST_F(ExecutorTest, AMissingFunctionOrQueueIsNamed) {
    ExecutorInfo info = executor_info();
    info.get_device_proc_addr = [](VkDevice device, const char* name) -> PFN_vkVoidFunction {
        return std::strcmp(name, "vkCmdDispatch") == 0 ? nullptr : vkGetDeviceProcAddr(device, name);
    };
    const auto without_dispatch = Executor::create(info);
    ASSERT_FALSE(without_dispatch.has_value());
    EXPECT_EQ(without_dispatch.error().kind, ExecuteError::Kind::missing_function);
    EXPECT_NE(without_dispatch.error().message.find("vkCmdDispatch"), std::string::npos);
    info = executor_info();
    info.queues.front().kind = QueueKind::compute;
    const auto without_graphics = Executor::create(info);
    ASSERT_FALSE(without_graphics.has_value());
    EXPECT_EQ(without_graphics.error().kind, ExecuteError::Kind::unsuitable_queue);
}

} // namespace
} // namespace tyndall::test
