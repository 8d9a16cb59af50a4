// Cost of declaring and compiling the generic frame. One thread, two queues, all stages on. Time a pass is `per_pass`.
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "benchmarks/rendergraph/generic_frame.hpp"
#include "rendergraph/compile.hpp"
#include "rendergraph/graph.hpp"
#include "rendergraph/plan_cache.hpp"

namespace {

using namespace tyndall::rg;
using namespace tyndall::rg::bench;

void compile_with(benchmark::State& state, const Costs& costs) {
    const auto count = static_cast<std::size_t>(state.range(0));
    const std::vector<std::string> passes = names("pass ", count);
    const std::vector<std::string> images = names("image ", count);
    for (auto _ : state) {
        const DeclaredGraph declared = generic_frame(passes, images);
        const auto plan = compile(declared.desc, two_queues, estimate_memory(declared.desc), {}, costs);
        if (!plan) {
            state.SkipWithError("the frame does not compile");
            return;
        }
        benchmark::DoNotOptimize(plan->passes.data());
    }
    report_per_pass(state);
}

void declare_and_compile(benchmark::State& state) {
    compile_with(state, measured_costs(static_cast<std::size_t>(state.range(0))));
}
BENCHMARK(declare_and_compile)->RangeMultiplier(4)->Range(16, 16384)->Unit(benchmark::kMicrosecond);

/// A first frame: nothing is decided by durations.
void declare_and_compile_unmeasured(benchmark::State& state) {
    compile_with(state, {});
}
BENCHMARK(declare_and_compile_unmeasured)->RangeMultiplier(4)->Range(16, 16384)->Unit(benchmark::kMicrosecond);

void declare(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(state.range(0));
    const std::vector<std::string> passes = names("pass ", count);
    const std::vector<std::string> images = names("image ", count);
    for (auto _ : state) {
        const DeclaredGraph declared = generic_frame(passes, images);
        benchmark::DoNotOptimize(declared.desc.passes.data());
    }
    report_per_pass(state);
}
BENCHMARK(declare)->RangeMultiplier(4)->Range(16, 16384)->Unit(benchmark::kMicrosecond);

void compile_unchanged(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(state.range(0));
    const DeclaredGraph declared = generic_frame(names("pass ", count), names("image ", count));
    const MemoryRequirements memory = estimate_memory(declared.desc);
    PlanCache cache;
    if (!cache.compile(declared.desc, two_queues, memory)) {
        state.SkipWithError("the frame does not compile");
        return;
    }
    for (auto _ : state) {
        const auto plan = cache.compile(declared.desc, two_queues, memory);
        benchmark::DoNotOptimize(*plan);
    }
    report_per_pass(state);
}
BENCHMARK(compile_unchanged)->RangeMultiplier(4)->Range(16, 16384)->Unit(benchmark::kMicrosecond);

} // namespace
