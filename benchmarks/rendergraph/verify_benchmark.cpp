// Cost of the checker on the generic frame's plan: three frames of it, one after the other. Time a pass is `per_pass`.
#include "benchmarks/rendergraph/generic_frame.hpp"
#include "rendergraph/compile.hpp"
#include "rendergraph/verify.hpp"

namespace {

using namespace tyndall::rg;
using namespace tyndall::rg::bench;

void verify_plan(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(state.range(0));
    const DeclaredGraph declared = generic_frame(names("pass ", count), names("image ", count));
    const auto plan = compile(declared.desc, two_queues, estimate_memory(declared.desc), {}, measured_costs(count));
    if (!plan) {
        state.SkipWithError("the frame does not compile");
        return;
    }
    for (auto _ : state) {
        const std::vector<Violation> violations = verify(declared.desc, *plan);
        if (!violations.empty()) {
            state.SkipWithError("the plan is wrong");
            return;
        }
    }
    report_per_pass(state);
}
BENCHMARK(verify_plan)->RangeMultiplier(4)->Range(16, 16384)->Unit(benchmark::kMicrosecond);

} // namespace
