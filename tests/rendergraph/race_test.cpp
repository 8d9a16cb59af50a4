// Plans on the CPU under the thread sanitiser, with which this program is always built: silent over true plans on three
// queues, and not over broken ones.
//
//   tyndall_rendergraph_races [PLANS] [MUTANTS]
//
// runs so many plans, and so many mutants of each kind that can race. Exit status 0: as it must be.
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>

#include <sys/personality.h>
#include <unistd.h>

#include "rendergraph/verify.hpp"
#include "tests/rendergraph/any_frame.hpp"
#include "tests/rendergraph/cpu_executor.hpp"
#include "tests/rendergraph/mutations.hpp"

namespace {

std::atomic<std::uint32_t> reports = 0;

} // namespace

// The sanitiser calls these, by these names; the reports are counted here and not printed.
// NOLINTBEGIN(bugprone-reserved-identifier, readability-identifier-naming)
extern "C" {
void __tsan_on_report(void* /*report*/);
void __tsan_on_report(void* /*report*/) {
    reports.fetch_add(1, std::memory_order_relaxed);
}
const char* __tsan_default_options();
const char* __tsan_default_options() {
    return "exitcode=0:halt_on_error=0:suppress_equal_stacks=0:suppress_equal_addresses=0:log_path=/dev/null:"
           "symbolize=0:report_signal_unsafe=0:report_thread_leaks=0";
}
}
// NOLINTEND(bugprone-reserved-identifier, readability-identifier-naming)

namespace tyndall::rg::test {
namespace {

/// Passes of the plan run on all of three queues.
bool uses_three_queues(const Plan& plan) {
    std::array<bool, 3> used = {};
    for (const PlannedPass& pass : plan.passes) {
        used[std::min(pass.queue, 2U)] = true;
    }
    return plan.topology.queues.size() == 3 && used[0] && used[1] && used[2];
}

bool silent_over_true_plans(std::uint32_t plans) {
    std::uint32_t seed = 0;
    std::uint64_t passes = 0;
    for (std::uint32_t done = 0; done < plans;) {
        const AnyFrame frame = any_frame(++seed);
        const auto plan = plan_of(frame);
        if (!plan.has_value() || !uses_three_queues(*plan)) {
            continue;
        }
        const CpuRun run = run_on_cpu(frame.graph, *plan, done % 2 == 0 ? Values::own : Values::from_reads);
        if (!run.started || run.mismatches != 0 || reports != 0) {
            std::printf("seed %u: %u races, %u mismatches %s\n", seed, reports.load(), run.mismatches,
                        run.first_mismatch.c_str());
            return false;
        }
        ++done;
        passes += plan->passes.size();
    }
    std::printf("%u plans on three queues (seeds 1 to %u), %llu passes: silent\n", plans, seed,
                static_cast<unsigned long long>(passes));
    return true;
}

/// Runs mutants that the checker says are races; some of them at least must be reported here too.
bool speaks_for(Fault fault, std::uint32_t wanted) {
    std::uint32_t tried = 0;
    std::uint32_t reported = 0;
    for (std::uint32_t seed = 1; tried < wanted && seed < 20'000; ++seed) {
        const AnyFrame frame = any_frame(seed);
        const auto plan = plan_of(frame);
        std::uint32_t of_this_plan = 0;
        for (const Mutant& mutant : plan.has_value() ? mutants(*plan, fault) : std::vector<Mutant>{}) {
            const std::vector<Violation> found = verify(frame.graph, mutant.plan);
            const bool races = std::any_of(found.begin(), found.end(), [](const Violation& v) {
                return (v.code == ViolationCode::race || v.code == ViolationCode::not_visible) &&
                       v.other_pass != none && v.pass != none && v.other_pass != v.pass;
            });
            const bool runs = std::none_of(found.begin(), found.end(), [](const Violation& v) {
                return v.code == ViolationCode::never_signalled || v.code == ViolationCode::malformed;
            });
            if (!races || !runs || of_this_plan == 3 || tried == wanted) {
                continue;
            }
            ++of_this_plan;
            ++tried;
            const std::uint32_t before = reports;
            if (run_on_cpu(frame.graph, mutant.plan, Values::own).started) {
                reported += reports != before ? 1 : 0;
            }
        }
    }
    std::printf("%-27s reported %u of %u that the checker calls races\n", std::string(name_of(fault)).c_str(), reported,
                tried);
    return tried > 0 && reported * 2 > tried;
}

} // namespace
} // namespace tyndall::rg::test

int main(int argc, char** argv) {
    using namespace tyndall::rg::test;
    // The sanitiser's shadow memory needs a plain address space; where the system refuses, it says so itself.
    const int persona = personality(0xffffffff);
    if (persona >= 0 && (persona & ADDR_NO_RANDOMIZE) == 0 &&
        personality(static_cast<unsigned long>(persona) | ADDR_NO_RANDOMIZE) >= 0) {
        execv("/proc/self/exe", argv);
    }
    const auto number = [&](int index, std::uint32_t otherwise) {
        return argc > index ? static_cast<std::uint32_t>(std::strtoul(argv[index], nullptr, 10)) : otherwise;
    };
    bool good = silent_over_true_plans(number(1, 20));
    for (const Fault fault :
         {Fault::drop_barrier, Fault::narrow_source_stages, Fault::narrow_destination_stages,
          Fault::narrow_source_access, Fault::narrow_destination_access, Fault::drop_wait, Fault::renumber_wait,
          Fault::drop_release, Fault::overlap_bytes, Fault::swap_passes, Fault::retarget_queue}) {
        good = speaks_for(fault, number(2, 8)) && good;
    }
    return good ? 0 : 1;
}
