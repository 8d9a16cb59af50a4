// Recording the generic frame into a real driver's command buffer, which is never submitted: beside the executor's own
// work the driver's for each pass's barriers and for its pipeline, descriptor and dispatch. Skipped without a driver.
#include <array>
#include <vector>

#include <benchmark/benchmark.h>

#include "benchmarks/rendergraph/generic_frame.hpp"
#include "engine/memory.hpp"
#include "engine/pipelines.hpp"
#include "rendergraph/compile.hpp"
#include "rendergraph/executor.hpp"
#include "spirv/benchmark_fill.h"

namespace {

using namespace tyndall;
using namespace tyndall::rg;
using namespace tyndall::rg::bench;
using CommandPool = engine::Unique<VkCommandPool, &DeviceTable::DestroyCommandPool>;

struct DispatchesOnce {
    VkPipeline pipeline = VK_NULL_HANDLE;
    VkPipelineLayout layout = VK_NULL_HANDLE;

    void operator()(PassContext& ctx, Image output) const {
        ctx.vk().CmdBindPipeline(ctx.cmd(), VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
        ctx.push(VK_PIPELINE_BIND_POINT_COMPUTE, layout, 0, std::array{ctx.storage(0, output)});
        ctx.vk().CmdDispatch(ctx.cmd(), 32, 32, 1);
    }
};

/// What the passes need of the device.
struct DriverObjects {
    engine::DescriptorSetLayout set;
    engine::PipelineLayout layout;
    engine::Pipeline pipeline;
    engine::Buffer result;
    CommandPool pool;
    VkCommandBuffer cmd = VK_NULL_HANDLE;
};

tl::expected<DriverObjects, engine::Error> create_objects(const engine::Device& device) {
    const VkDescriptorSetLayoutBinding binding{.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
                                               .descriptorCount = 1,
                                               .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT};
    DriverObjects out;
    auto set = engine::create_set_layout(device, {&binding, 1}, true);
    if (!set) {
        return tl::unexpected(set.error());
    }
    out.set = std::move(*set);
    auto layout = engine::create_pipeline_layout(device, std::array{out.set.get()});
    if (!layout) {
        return tl::unexpected(layout.error());
    }
    out.layout = std::move(*layout);
    auto pipeline = engine::create_compute_pipeline(device, VK_NULL_HANDLE, out.layout.get(), benchmark_fill);
    if (!pipeline) {
        return tl::unexpected(pipeline.error());
    }
    out.pipeline = std::move(*pipeline);
    auto result = engine::Buffer::create(device, 256, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, engine::MemoryUse::device);
    if (!result) {
        return tl::unexpected(result.error());
    }
    out.result = std::move(*result);
    const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                       .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
                                       .queueFamilyIndex = device.graphics_queue().family};
    VkCommandPool made = VK_NULL_HANDLE;
    if (device.vk().CreateCommandPool(device.handle(), &pool, nullptr, &made) < 0) {
        return tl::unexpected(engine::Error{.message = "no command pool"});
    }
    out.pool = CommandPool(device, made);
    const VkCommandBufferAllocateInfo buffer{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                             .commandPool = made,
                                             .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                             .commandBufferCount = 1};
    if (device.vk().AllocateCommandBuffers(device.handle(), &buffer, &out.cmd) < 0) {
        return tl::unexpected(engine::Error{.message = "no command buffer"});
    }
    return out;
}

void record_with_driver(benchmark::State& state) {
    auto instance = engine::VulkanInstance::create(engine::Validation::off);
    auto device = instance ? engine::Device::create(*instance) : tl::unexpected(instance.error());
    if (!device) {
        state.SkipWithError(device.error().message.c_str());
        return;
    }
    auto objects = create_objects(*device);
    auto executor = Executor::create(device->executor_info(false));
    if (!objects || !executor) {
        state.SkipWithError("the device's objects could not be made");
        return;
    }
    const auto count = static_cast<std::size_t>(state.range(0));
    const DeclaredGraph frame = generic_frame(names("pass ", count), names("image ", count),
                                              DispatchesOnce{objects->pipeline.get(), objects->layout.get()});
    const auto plan = compile(frame.desc, executor->topology(), executor->memory_requirements(frame.desc));
    if (!plan) {
        state.SkipWithError("the frame does not compile");
        return;
    }
    std::vector<ImportBinding> imports;
    for (std::uint32_t resource = 0; resource < frame.desc.resources.size(); ++resource) {
        if (frame.desc.resources[resource].lifetime == ResourceLifetime::imported) {
            imports.push_back({.resource = resource, .buffer = objects->result.handle()});
        }
    }
    const DeviceTable& vk = device->vk();
    const auto record = [&] {
        const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                             .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
        return vk.ResetCommandPool(device->handle(), objects->pool.get(), 0) >= 0 &&
               vk.BeginCommandBuffer(objects->cmd, &begin) >= 0 &&
               executor->record(objects->cmd, frame.desc, *plan, frame.callbacks, imports).has_value() &&
               vk.EndCommandBuffer(objects->cmd) >= 0;
    };
    for (std::uint32_t i = 0; i < frames_to_settle; ++i) {
        static_cast<void>(record());
    }
    for (auto _ : state) {
        if (!record()) {
            state.SkipWithError("a frame failed");
            return;
        }
    }
    report_per_pass(state);
    state.counters["recorded"] = static_cast<double>(plan->passes.size());
    state.SetLabel(device->properties().deviceName);
}
BENCHMARK(record_with_driver)->RangeMultiplier(4)->Range(16, 1024)->Unit(benchmark::kMicrosecond);

} // namespace
