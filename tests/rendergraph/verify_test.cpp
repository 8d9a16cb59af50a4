// The checker: silent on what compile makes, and not silent on what is broken on purpose.
#include "rendergraph/verify.hpp"

#include <map>

#include "tests/rendergraph/any_frame.hpp"
#include "tests/rendergraph/random_graph.hpp"

namespace tyndall::rg::test {
namespace {

std::string text(const std::vector<Violation>& violations) {
    std::string out;
    for (const Violation& v : violations) {
        out += std::string(name_of(v.code)) + ": " + v.message + "\n";
    }
    return out;
}

TEST(Verify, TheFogFrameIsProved) {
    const DeclaredGraph declared = fog_frame();
    for (const QueueTopology& topology : {one_queue(), two_queues(), two_queues_one_family()}) {
        const Plan plan = compiled(declared.desc, topology);
        EXPECT_EQ(text(verify(declared.desc, plan)), "");
    }
}

TEST(Verify, RandomFramesAreProved) {
    const std::uint32_t count = random_graph_count(2000);
    std::uint32_t planned = 0;
    for (std::uint32_t seed = 1; seed <= count; ++seed) {
        const AnyFrame frame = any_frame(seed);
        const auto plan = compile(frame.graph, frame.topology, estimate_memory(frame.graph));
        ASSERT_TRUE(plan.has_value()) << "seed " << seed << "\n" << to_text(plan.error());
        ASSERT_EQ(text(verify(frame.graph, *plan)), "") << "seed " << seed << "\n" << to_text(frame.graph, *plan);
        planned += static_cast<std::uint32_t>(plan->passes.size());
    }
    std::printf("seeds 1 to %u: %u passes planned, no violation\n", count, planned);
}

TEST(Verify, EveryDependencyOfTheFogFrameMatters) {
    const DeclaredGraph declared = fog_frame();
    for (const QueueTopology& topology : {one_queue(), two_queues(), two_queues_one_family()}) {
        const Plan plan = compiled(declared.desc, topology);
        for (std::uint32_t i = 0; i < plan.dependencies.size(); ++i) {
            Plan broken = plan;
            Dependency& d = broken.dependencies[i];
            d.src_stages = d.dst_stages = d.local_stages = 0;
            d.src_access = d.dst_access = d.local_access = 0;
            d.new_layout = d.old_layout;
            d.transfers_ownership = false;
            EXPECT_FALSE(verify(declared.desc, broken).empty()) << describe(declared.desc, plan.dependencies[i]);
        }
    }
}

/// Breaks the plan in one way; false where there is nothing to break at `place`.
using Mutation = bool (*)(Plan&, std::uint32_t place);

bool narrow_source(Plan& plan, std::uint32_t place) {
    if (place >= plan.dependencies.size() || plan.dependencies[place].src_access == 0) {
        return false;
    }
    plan.dependencies[place].src_access = plan.dependencies[place].local_access = 0;
    return true;
}
bool narrow_destination(Plan& plan, std::uint32_t place) {
    if (place >= plan.dependencies.size() || plan.dependencies[place].dst_access == 0) {
        return false;
    }
    plan.dependencies[place].dst_access = 0;
    return true;
}
bool wrong_old_layout(Plan& plan, std::uint32_t place) {
    if (place >= plan.dependencies.size() || plan.dependencies[place].old_layout == VK_IMAGE_LAYOUT_UNDEFINED ||
        plan.dependencies[place].old_layout == plan.dependencies[place].new_layout) {
        return false;
    }
    plan.dependencies[place].old_layout = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR;
    return true;
}
bool drop_wait(Plan& plan, std::uint32_t place) {
    for (Batch& batch : plan.batches) {
        if (place < batch.waits.size()) {
            batch.waits.erase(batch.waits.begin() + place);
            return true;
        }
        place -= static_cast<std::uint32_t>(batch.waits.size());
    }
    return false;
}
bool wait_for_the_future(Plan& plan, std::uint32_t place) {
    for (std::uint32_t b = 0; b < plan.batches.size(); ++b) {
        if (place < plan.batches[b].waits.size()) {
            plan.batches[b].waits[place].batch = b;
            return true;
        }
        place -= static_cast<std::uint32_t>(plan.batches[b].waits.size());
    }
    return false;
}
bool drop_release(Plan& plan, std::uint32_t place) {
    for (Batch& batch : plan.batches) {
        if (place < batch.releases.size()) {
            batch.releases.erase(batch.releases.begin() + place);
            return true;
        }
        place -= static_cast<std::uint32_t>(batch.releases.size());
    }
    return false;
}
bool overlap_bytes(Plan& plan, std::uint32_t place) {
    // Lays a resource over another of its heap that it did not share bytes with.
    for (std::uint32_t a = 0; a < plan.placements.size(); ++a) {
        for (std::uint32_t b = a + 1; b < plan.placements.size(); ++b) {
            Placement& pa = plan.placements[a];
            Placement& pb = plan.placements[b];
            const bool both = pa.kind == PlacementKind::heap && pb.kind == PlacementKind::heap && pa.heap == pb.heap;
            const bool apart = both && (pa.offset_bytes + pa.size_bytes <= pb.offset_bytes ||
                                        pb.offset_bytes + pb.size_bytes <= pa.offset_bytes);
            if (apart && pb.size_bytes <= pa.size_bytes && place-- == 0) {
                pb.offset_bytes = pa.offset_bytes;
                return true;
            }
        }
    }
    return false;
}

TEST(Verify, MutationsOfRandomPlansAreCaught) {
    const std::map<std::string, Mutation> mutations = {
        {"narrow the source access", narrow_source},  {"narrow the destination access", narrow_destination},
        {"wrong old layout", wrong_old_layout},       {"drop a wait", drop_wait},
        {"wait for the future", wait_for_the_future}, {"drop a release", drop_release},
        {"overlap aliased bytes", overlap_bytes}};
    for (const auto& [name, mutate] : mutations) {
        std::uint32_t made = 0;
        std::uint32_t caught = 0;
        std::string survivor;
        for (std::uint32_t seed = 1; seed <= 300; ++seed) {
            const DeclaredGraph declared = random_frame(seed);
            const Plan plan = compiled(declared.desc, random_topology(seed));
            for (std::uint32_t place = 0; place < 64; ++place) {
                Plan broken = plan;
                if (!mutate(broken, place)) {
                    break;
                }
                ++made;
                const bool found = !verify(declared.desc, broken).empty();
                caught += found ? 1 : 0;
                if (!found && survivor.empty()) {
                    survivor = "seed " + std::to_string(seed) + " place " + std::to_string(place);
                }
            }
        }
        std::printf("%-30s caught %u of %u, first survivor: %s\n", name.c_str(), caught, made, survivor.c_str());
        EXPECT_GT(made, 10U) << name;
        EXPECT_GT(caught, 0U) << name;
        RecordProperty(name, std::to_string(caught) + " of " + std::to_string(made));
    }
}

} // namespace
} // namespace tyndall::rg::test
