// Cost of declaring and compiling the generic frame. One thread, two queues, all stages on. Time a pass is `per_pass`.
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "benchmarks/rendergraph/generic_frame.hpp"
#include "rendergraph/compile.hpp"
#include "rendergraph/graph.hpp"

namespace {

using namespace tyndall::rg;
using namespace tyndall::rg::bench;

void declare_and_compile(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(state.range(0));
    const std::vector<std::string> passes = names("pass ", count);
    const std::vector<std::string> images = names("image ", count);
    for (auto _ : state) {
        const DeclaredGraph declared = generic_frame(passes, images);
        const auto plan = compile(declared.desc, two_queues, estimate_memory(declared.desc));
        if (!plan) {
            state.SkipWithError("the frame does not compile");
            return;
        }
        benchmark::DoNotOptimize(plan->passes.data());
    }
    report_per_pass(state);
}
BENCHMARK(declare_and_compile)->RangeMultiplier(4)->Range(16, 1024)->Unit(benchmark::kMicrosecond);

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
BENCHMARK(declare)->RangeMultiplier(4)->Range(16, 1024)->Unit(benchmark::kMicrosecond);

} // namespace
