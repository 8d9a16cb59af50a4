// Every kind of fault at every place of many plans: seen by the checker, or shown to be harmless by other means.
#include <array>

#include <gtest/gtest.h>

#include "rendergraph/plan_text.hpp"
#include "rendergraph/verify.hpp"
#include "tests/rendergraph/any_frame.hpp"
#include "tests/rendergraph/folded.hpp"
#include "tests/rendergraph/frames.hpp"
#include "tests/rendergraph/mutations.hpp"
#include "tests/rendergraph/reach_oracle.hpp"

namespace tyndall::rg::test {
namespace {

struct Tally {
    std::uint32_t places = 0;
    std::uint32_t caught = 0;        ///< in the plan as it is
    std::uint32_t caught_folded = 0; ///< only where one queue does the work of several, without their semaphores
    std::array<std::uint32_t, harmless_count> harmless = {};
};
using Tallies = std::array<Tally, fault_count>;

/// Other faults than those of dependencies have nothing to do with how queues fold.
bool is_seen_folded(const GraphDesc& graph, const Mutant& mutant) {
    if (mutant.dependency == none) {
        return false;
    }
    const FoldedFrame one = folded(graph, mutant.plan);
    return !verify(one.graph, one.plan).empty();
}

void mutate(const GraphDesc& graph, const Plan& plan, const std::string& name, Tallies& tallies) {
    for (std::size_t f = 0; f < fault_count; ++f) {
        Tally& tally = tallies[f];
        for (const Mutant& mutant : mutants(plan, static_cast<Fault>(f))) {
            ++tally.places;
            if (!verify(graph, mutant.plan).empty()) {
                ++tally.caught;
                continue;
            }
            if (is_seen_folded(graph, mutant)) {
                ++tally.caught_folded;
                continue;
            }
            const std::optional<Harmless> reason = why_harmless(graph, plan, mutant);
            ASSERT_TRUE(reason.has_value())
                << name << ": '" << name_of(mutant.fault) << "' at place " << mutant.place
                << " is neither seen nor known to be harmless\n"
                << (mutant.dependency != none ? describe(graph, plan.dependencies[mutant.dependency]) : "") << "\n"
                << to_text(graph, plan);
            ++tally.harmless[static_cast<std::size_t>(*reason)];
        }
    }
}

void print(const Tallies& tallies) {
    for (std::size_t f = 0; f < fault_count; ++f) {
        const Tally& tally = tallies[f];
        std::printf("%-27s places %7u  caught %7u  folded %6u", std::string(name_of(static_cast<Fault>(f))).c_str(),
                    tally.places, tally.caught, tally.caught_folded);
        for (std::size_t h = 0; h < harmless_count; ++h) {
            if (tally.harmless[h] != 0) {
                std::printf("; %s %u", std::string(name_of(static_cast<Harmless>(h))).c_str(), tally.harmless[h]);
            }
        }
        std::printf("\n");
    }
}

TEST(Mutations, AreSeenOrHarmlessForAReason) {
    Tallies tallies;
    for (const QueueTopology& topology : {one_queue(), two_queues(), two_queues_one_family()}) {
        const DeclaredGraph declared = fog_frame();
        mutate(declared.desc, compiled(declared.desc, topology), "fog frame", tallies);
    }
    const std::uint32_t count = random_graph_count(150);
    for (std::uint32_t seed = 1; seed <= count && !HasFatalFailure(); ++seed) {
        const AnyFrame frame = any_frame(seed);
        const auto plan = plan_of(frame);
        ASSERT_TRUE(plan.has_value());
        mutate(frame.graph, *plan, "seed " + std::to_string(seed), tallies);
    }
    std::printf("seeds 1 to %u\n", count);
    print(tallies);
    for (std::size_t f = 0; f < fault_count; ++f) {
        EXPECT_GT(tallies[f].places, 20U) << name_of(static_cast<Fault>(f));
        EXPECT_GT(tallies[f].caught * 4, tallies[f].places) << name_of(static_cast<Fault>(f));
    }
    // Plans have next to no barrier that nothing needs: all that is left are of imports.
    const Tally& dropped = tallies[static_cast<std::size_t>(Fault::drop_barrier)];
    std::uint32_t superfluous = 0;
    for (std::size_t h = 0; h < harmless_count; ++h) {
        superfluous += h == static_cast<std::size_t>(Harmless::never_recorded) ? 0 : dropped.harmless[h];
    }
    EXPECT_LE(superfluous * 200, dropped.places);
}

/// One queue does the work of several: the whole masks that semaphores make superfluous are needed then.
TEST(Mutations, PlansFoldedOntoOneQueueAreProved) {
    const std::uint32_t count = random_graph_count(500);
    std::uint32_t of_several = 0;
    for (std::uint32_t seed = 1; seed <= count; ++seed) {
        const AnyFrame frame = any_frame(seed);
        const auto plan = plan_of(frame);
        ASSERT_TRUE(plan.has_value());
        const FoldedFrame one = folded(frame.graph, *plan);
        const std::vector<Violation> found = verify(one.graph, one.plan);
        ASSERT_TRUE(found.empty()) << "seed " << seed << ": " << found.front().message << "\n"
                                   << to_text(frame.graph, *plan) << to_text(one.graph, one.plan);
        of_several += frame.topology.queues.size() > 1 ? 1 : 0;
    }
    EXPECT_GT(of_several, count / 4);
}

TEST(Mutations, TheOtherOracleAgreesOnTruePlans) {
    const std::uint32_t count = random_graph_count(500);
    for (std::uint32_t seed = 1; seed <= count; ++seed) {
        const AnyFrame frame = any_frame(seed);
        const auto plan = plan_of(frame);
        ASSERT_TRUE(plan.has_value());
        for (const Reliance& r : reliances(frame.graph, *plan)) {
            ASSERT_NE(r.means, Means::nothing) << "seed " << seed << ", " << frame.graph.resources[r.resource].name;
        }
    }
}

} // namespace
} // namespace tyndall::rg::test
