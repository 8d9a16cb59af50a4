// Cost of declaring and compiling the generic frame. One thread, two queues, all stages on. Time a pass is `per_pass`;
// the fitted growth of the whole is printed as BigO.
#include <random>
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
    state.SetComplexityN(state.range(0));
}

void declare_and_compile(benchmark::State& state) {
    compile_with(state, {});
}
BENCHMARK(declare_and_compile)
    ->RangeMultiplier(4)
    ->Range(16, 16384)
    ->Unit(benchmark::kMicrosecond)
    ->Complexity(benchmark::oAuto);

/// Between 20 and 220 us a pass, as a device would measure them, so that the list schedule is made and overlaps.
void declare_and_compile_measured(benchmark::State& state) {
    std::minstd_rand random(1);
    Costs costs;
    for (std::int64_t i = 0; i <= state.range(0); ++i) {
        costs.of_pass.push_back(
            {.mean_ns = 20'000 + static_cast<std::int64_t>(random() % 200'000), .deviation_ns = 1'000});
    }
    compile_with(state, costs);
}
BENCHMARK(declare_and_compile_measured)
    ->RangeMultiplier(4)
    ->Range(16, 16384)
    ->Unit(benchmark::kMicrosecond)
    ->Complexity(benchmark::oAuto);

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
