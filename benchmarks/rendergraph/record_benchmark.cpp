// Cost of recording and submitting the generic frame on one thread, on a device whose functions do nothing: the
// executor's own work. Each pass binds its output. What recording on a second thread could save is at most half of it.
#include <array>
#include <vector>

#include <benchmark/benchmark.h>

#include "benchmarks/rendergraph/generic_frame.hpp"
#include "rendergraph/compile.hpp"
#include "rendergraph/executor.hpp"
#include "tests/rendergraph/recording_device.hpp"

namespace {

using namespace tyndall::rg;
using namespace tyndall::rg::bench;

struct BindsItsOutput {
    void operator()(PassContext& ctx, Image output) const {
        ctx.push(VK_PIPELINE_BIND_POINT_COMPUTE, VK_NULL_HANDLE, 0, std::array{ctx.storage(0, output)});
    }
};

void record_and_submit(benchmark::State& state, const std::vector<QueueKind>& kinds) {
    test::RecordingDevice device;
    device.remembers = false;
    auto executor = Executor::create(device.info(kinds));
    if (!executor) {
        state.SkipWithError("no executor");
        return;
    }
    const auto count = static_cast<std::size_t>(state.range(0));
    const DeclaredGraph frame = generic_frame(names("pass ", count), names("image ", count), BindsItsOutput{});
    const auto plan =
        compile(frame.desc, executor->topology(), executor->memory_requirements(frame.desc), {}, measured_costs(count));
    if (!plan) {
        state.SkipWithError("the frame does not compile");
        return;
    }
    const std::vector<ImportBinding> imports = test::made_up_bindings(frame.desc);
    for (std::uint32_t i = 0; i < frames_to_settle; ++i) {
        static_cast<void>(executor->submit(frame.desc, *plan, frame.callbacks, imports));
    }
    for (auto _ : state) {
        if (!executor->submit(frame.desc, *plan, frame.callbacks, imports)) {
            state.SkipWithError("a frame failed");
            return;
        }
    }
    report_per_pass(state);
    state.counters["recorded"] = static_cast<double>(plan->passes.size());
    state.counters["batches"] = static_cast<double>(plan->batches.size());
}

void record_and_submit_one_queue(benchmark::State& state) {
    record_and_submit(state, {QueueKind::graphics});
}
BENCHMARK(record_and_submit_one_queue)->RangeMultiplier(4)->Range(16, 1024)->Unit(benchmark::kMicrosecond);

void record_and_submit_two_queues(benchmark::State& state) {
    record_and_submit(state, {QueueKind::graphics, QueueKind::compute});
}
BENCHMARK(record_and_submit_two_queues)->RangeMultiplier(4)->Range(16, 1024)->Unit(benchmark::kMicrosecond);

} // namespace
