// Small frames, each of which shows something: a kind of fault that the checker must see in its plan, or (once_wrong_*)
// a fault that the compiler had when the file was shrunk. TYNDALL_UPDATE_CORPUS=1 looks among random frames for the
// former that are not there, or no longer show it, and shrinks them.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>

#include <gtest/gtest.h>

#include "rendergraph/json.hpp"
#include "rendergraph/plan_text.hpp"
#include "rendergraph/verify.hpp"
#include "tests/rendergraph/cpu_executor.hpp"
#include "tests/rendergraph/mutations.hpp"
#include "tests/rendergraph/shrink.hpp"

namespace tyndall::rg::test {
namespace {

const std::filesystem::path corpus = TYNDALL_CORPUS_DIR;

bool proved(const AnyFrame& frame, const Plan& plan) {
    return verify(frame.graph, plan).empty();
}

/// What a plan of the frame must show.
using ShowsInPlan = std::function<bool(const AnyFrame&, const Plan&)>;

/// A mutant of the plan is seen, and as such a violation.
ShowsInPlan has_fault(Fault fault, ViolationCode code) {
    return [=](const AnyFrame& frame, const Plan& plan) {
        const std::vector<Mutant> all = mutants(plan, fault);
        return std::any_of(all.begin(), all.end(), [&](const Mutant& mutant) {
            const std::vector<Violation> found = verify(frame.graph, mutant.plan);
            return !found.empty() && found.front().code == code;
        });
    };
}
ShowsInPlan has_harmless(Fault fault, Harmless reason) {
    return [=](const AnyFrame& frame, const Plan& plan) {
        const std::vector<Mutant> all = mutants(plan, fault);
        return std::any_of(all.begin(), all.end(), [&](const Mutant& mutant) {
            return verify(frame.graph, mutant.plan).empty() && why_harmless(frame.graph, plan, mutant) == reason;
        });
    };
}

template <typename F>
ShowsInPlan some_dependency(F&& fits) {
    return [fits](const AnyFrame& frame, const Plan& plan) {
        return std::any_of(plan.dependencies.begin(), plan.dependencies.end(),
                           [&](const Dependency& d) { return fits(frame, plan, d); });
    };
}

std::map<std::string, ShowsInPlan> subjects() {
    std::map<std::string, ShowsInPlan> out;
    const auto fault = [&](Fault kind, ViolationCode code) {
        out[std::string(name_of(kind)) + ", seen as " + std::string(name_of(code))] = has_fault(kind, code);
    };
    for (const Fault kind :
         {Fault::drop_barrier, Fault::narrow_source_stages, Fault::narrow_destination_stages, Fault::drop_wait,
          Fault::renumber_wait, Fault::drop_release, Fault::overlap_bytes, Fault::swap_passes, Fault::retarget_queue}) {
        fault(kind, ViolationCode::race);
        fault(kind, ViolationCode::not_visible);
    }
    fault(Fault::narrow_source_access, ViolationCode::not_visible);
    fault(Fault::narrow_destination_access, ViolationCode::not_visible);
    for (const Fault layout : {Fault::wrong_old_layout, Fault::wrong_new_layout, Fault::drop_barrier}) {
        fault(layout, ViolationCode::wrong_layout);
    }
    fault(Fault::wrong_new_layout, ViolationCode::exit_state);
    fault(Fault::drop_barrier, ViolationCode::exit_state);
    fault(Fault::narrow_destination_access, ViolationCode::exit_state);
    fault(Fault::drop_release, ViolationCode::ownership);
    fault(Fault::drop_acquire, ViolationCode::ownership);
    fault(Fault::drop_barrier, ViolationCode::ownership);
    fault(Fault::retarget_queue, ViolationCode::queue_cannot);
    fault(Fault::renumber_wait, ViolationCode::never_signalled);
    fault(Fault::overlap_bytes, ViolationCode::undefined_content);
    fault(Fault::swap_passes, ViolationCode::undefined_content);
    fault(Fault::swap_passes, ViolationCode::wrong_version);
    for (const Harmless reason : {Harmless::unordered_passes, Harmless::apart_in_time, Harmless::same_work_elsewhere}) {
        const Fault kind = reason == Harmless::unordered_passes ? Fault::swap_passes
                           : reason == Harmless::apart_in_time  ? Fault::overlap_bytes
                                                                : Fault::retarget_queue;
        out[std::string(name_of(kind)) + ", harmless, " + std::string(name_of(reason))] = has_harmless(kind, reason);
    }
    // What is worth a look at.
    out["memory taken over from another queue"] =
        some_dependency([](const AnyFrame&, const Plan&, const Dependency& d) {
            return d.hazard == Hazard::aliased_memory && d.src_queue != d.dst_queue;
        });
    out["memory taken over by an image with mips"] =
        some_dependency([](const AnyFrame& frame, const Plan&, const Dependency& d) {
            return d.hazard == Hazard::aliased_memory && frame.graph.resources[d.resource].image.mips > 1;
        });
    out["one transition for readers on several queues"] = [](const AnyFrame&, const Plan& plan) {
        return std::any_of(plan.batches.begin(), plan.batches.end(), [&](const Batch& batch) {
            return std::any_of(batch.releases.begin(), batch.releases.end(),
                               [&](std::uint32_t d) { return !plan.dependencies[d].transfers_ownership; });
        });
    };
    out["variant whose second form is kept"] = [](const AnyFrame&, const Plan& plan) {
        return std::any_of(plan.variants.begin(), plan.variants.end(),
                           [](const VariantDecision& v) { return v.form == 1; });
    };
    out["three queues wait for each other"] = [](const AnyFrame&, const Plan& plan) {
        std::vector<bool> waits(plan.topology.queues.size(), false);
        for (const Batch& batch : plan.batches) {
            waits[batch.queue] = waits[batch.queue] || !batch.waits.empty();
        }
        return waits.size() == 3 && std::find(waits.begin(), waits.end(), false) == waits.end();
    };
    // The packer at its worst: of small frames, which refining always mends.
    out["memory an eighth over its bound"] = [](const AnyFrame&, const Plan& plan) {
        return plan.statistics.transient_bytes * 8 > plan.statistics.transient_bound_bytes * 9;
    };
    return out;
}

std::string file_name(std::string subject) {
    for (char& c : subject) {
        c = c == ' ' || c == ',' || c == '\'' ? '_' : c;
    }
    return subject + ".json";
}

/// A frame of a file; empty where there is none.
std::optional<AnyFrame> read_frame(const std::filesystem::path& path) {
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    auto frame = frame_from_json(text.str());
    if (!frame.has_value()) {
        ADD_FAILURE() << path << "\n" << to_text(frame.error());
        return std::nullopt;
    }
    return AnyFrame{frame->graph, frame->topology, frame->costs};
}

TEST(Corpus, HasAFrameForEachSubject) {
    const bool update = std::getenv("TYNDALL_UPDATE_CORPUS") != nullptr;
    std::map<std::string, ShowsInPlan> all = subjects();
    for (const auto& [subject, shows_in_plan] : all) {
        const std::filesystem::path path = corpus / file_name(subject);
        const Shows shows = [&, &in_plan = shows_in_plan](const AnyFrame& frame) {
            const auto plan = plan_of(frame);
            return plan.has_value() && proved(frame, *plan) && in_plan(frame, *plan);
        };
        const auto is_shown = [&] {
            const std::optional<AnyFrame> frame =
                std::filesystem::exists(path) ? read_frame(path) : std::optional<AnyFrame>{};
            return frame.has_value() && shows(*frame);
        };
        for (std::uint32_t seed = 1; update && !is_shown() && seed < 4000; ++seed) {
            if (shows(any_frame(seed))) {
                std::ofstream(path) << as_json(shrunk(any_frame(seed), shows),
                                               subject + " (random frame " + std::to_string(seed) + ", shrunk)");
            }
        }
        EXPECT_TRUE(is_shown()) << subject << ": no frame shows it; TYNDALL_UPDATE_CORPUS=1 looks for one";
    }
}

/// Every frame of the corpus.
std::vector<std::pair<std::string, AnyFrame>> frames() {
    std::vector<std::pair<std::string, AnyFrame>> out;
    for (const auto& entry : std::filesystem::directory_iterator(corpus)) {
        if (std::optional<AnyFrame> frame = read_frame(entry.path())) {
            out.emplace_back(entry.path().filename(), std::move(*frame));
        }
    }
    std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    return out;
}

TEST(Corpus, IsProvedAndRuns) {
    const auto all = frames();
    EXPECT_GE(all.size(), 30U);
    for (const auto& [name, frame] : all) {
        const auto plan = plan_of(frame);
        ASSERT_TRUE(plan.has_value()) << name << "\n" << to_text(plan.error());
        for (const Violation& v : verify(frame.graph, *plan)) {
            ADD_FAILURE() << name << ": " << v.message << "\n" << to_text(frame.graph, *plan);
        }
        const CpuRun run = run_on_cpu(frame.graph, *plan, Values::from_reads);
        EXPECT_EQ(run.mismatches, 0U) << name << ": " << run.first_mismatch;
    }
}

TEST(Corpus, IsProvedWithEachSwitch) {
    auto all = frames();
    for (const auto& entry : std::filesystem::directory_iterator(TYNDALL_SAMPLE_FRAMES)) {
        if (std::optional<AnyFrame> frame = read_frame(entry.path())) {
            all.emplace_back(entry.path().filename(), std::move(*frame));
        }
    }
    for (const auto& [name, frame] : all) {
        for (const auto& [what, options] : each_switch()) {
            const auto plan = plan_of(frame, options);
            ASSERT_TRUE(plan.has_value()) << name << ", " << what << "\n" << to_text(plan.error());
            for (const Violation& v : verify(frame.graph, *plan)) {
                ADD_FAILURE() << name << ", " << what << ": " << v.message;
            }
        }
    }
}

TEST(Corpus, MutantsAreSeenOrHarmlessForAReason) {
    std::uint32_t caught = 0;
    std::uint32_t harmless = 0;
    for (const auto& [name, frame] : frames()) {
        const auto plan = plan_of(frame);
        ASSERT_TRUE(plan.has_value());
        for (std::size_t f = 0; f < fault_count; ++f) {
            for (const Mutant& mutant : mutants(*plan, static_cast<Fault>(f))) {
                const bool seen = !verify(frame.graph, mutant.plan).empty();
                caught += seen ? 1 : 0;
                harmless += seen ? 0 : 1;
                EXPECT_TRUE(seen || why_harmless(frame.graph, *plan, mutant).has_value())
                    << name << ": '" << name_of(mutant.fault) << "' at place " << mutant.place;
            }
        }
    }
    std::printf("%u mutants seen, %u harmless\n", caught, harmless);
}

TEST(Corpus, ShrinkingLeavesNothingThatCanGo) {
    // A frame of which one thing matters: some pass reads a depth image on a compute queue.
    const Shows shows = [](const AnyFrame& frame) {
        return std::any_of(frame.graph.accesses.begin(), frame.graph.accesses.end(), [&](const AccessDesc& a) {
            const ResourceDesc& r = frame.graph.resources[a.resource];
            return a.access == Access::sampled_compute && r.kind == ResourceKind::image &&
                   is_depth_or_stencil(r.image.format);
        });
    };
    std::uint32_t seed = 1;
    while (!shows(any_frame(seed))) {
        ++seed;
    }
    const AnyFrame small = shrunk(any_frame(seed), shows);
    EXPECT_EQ(small.graph.passes.size(), 1U);
    EXPECT_EQ(small.graph.accesses.size(), 1U);
    EXPECT_EQ(small.graph.resources.size(), 1U);
    EXPECT_EQ(small.topology.queues.size(), 1U);
    EXPECT_EQ(small.graph.resources[0].image.mips, 1U);
}

} // namespace
} // namespace tyndall::rg::test
