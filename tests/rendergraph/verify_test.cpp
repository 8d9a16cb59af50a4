// The checker: silent on what compile makes, and not silent on what is broken on purpose.
#include "rendergraph/verify.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "tests/rendergraph/any_frame.hpp"
#include "tests/rendergraph/frames.hpp"
#include "tests/rendergraph/shrink.hpp"

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
        const auto plan = plan_of(frame);
        ASSERT_TRUE(plan.has_value()) << "seed " << seed << "\n" << to_text(plan.error()) << small_failure(frame);
        ASSERT_EQ(text(verify(frame.graph, *plan)), "") << "seed " << seed << "\n" << small_failure(frame);
        planned += static_cast<std::uint32_t>(plan->passes.size());
        for (const PlannedPass& pass : plan->passes) {
            const QueueKind kind = frame.topology.queues[pass.queue].kind;
            const PassDesc& desc = frame.graph.passes[pass.pass];
            ASSERT_EQ(desc.forbidden_queues & queue_bit(kind), 0) << "seed " << seed << ": " << desc.name;
        }
        const CompileOptions switches = any_switches(seed);
        const auto switched = plan_of(frame, switches);
        ASSERT_TRUE(switched.has_value()) << "seed " << seed << "\n" << to_text(switched.error());
        ASSERT_EQ(text(verify(frame.graph, *switched)), "") << "seed " << seed << ", with switches\n"
                                                            << small_failure(frame, switches);
    }
    std::printf("seeds 1 to %u: %u passes planned, no violation\n", count, planned);
}

/// What the random frames must not stop to say, by how many plans of 1,000 have it.
TEST(Verify, RandomFramesSayEverything) {
    std::map<std::string, std::uint32_t> seen;
    for (std::uint32_t seed = 1; seed <= 1000; ++seed) {
        const AnyFrame frame = any_frame(seed);
        const auto plan = plan_of(frame);
        ASSERT_TRUE(plan.has_value());
        std::set<std::string> here;
        for (const AccessDesc& a : frame.graph.accesses) {
            here.insert(std::string(access_info(a.access).name));
            here.insert(a.buffer_range.size != whole_buffer ? "byte range" : "whole buffer");
            here.insert(a.direction == Direction::modify ? "modifies" : "reads or replaces");
        }
        for (const ResourceDesc& r : frame.graph.resources) {
            here.insert(r.image.mips > 1 ? "mips" : "one mip");
            here.insert(r.image.layers > 1 ? "layers" : "one layer");
            here.insert(r.image.type == VK_IMAGE_TYPE_3D ? "3D image" : "2D image");
            here.insert(r.concurrent ? "asked to be shared" : "not shared");
            here.insert(r.kind == ResourceKind::image ? "image" : "buffer");
            if (r.has_history) {
                here.insert(r.kind == ResourceKind::image ? "history of an image" : "history of a buffer");
            }
        }
        for (const ImportDesc& import : frame.graph.imports) {
            here.insert(import.waits_semaphore ? "host's semaphore before" : "no semaphore before");
            here.insert(import.signals_semaphore ? "host's semaphore after" : "no semaphore after");
            here.insert(import.initial_family != VK_QUEUE_FAMILY_IGNORED ? "owner before" : "no owner before");
            here.insert(import.final_family != VK_QUEUE_FAMILY_IGNORED ? "owner after" : "no owner after");
            here.insert(import.read_only ? "read-only import" : "import");
        }
        for (const PlannedPass& pass : plan->passes) {
            here.insert(std::string(name_of(frame.graph.passes[pass.pass].kind)) + " pass");
            here.insert("queue " + std::to_string(pass.queue));
            if (pass.queue_reason == QueueReason::forbidden) {
                here.insert(pass.queue == 0 ? "kept on graphics by a ban" : "driven off graphics by a ban");
            }
        }
        for (const Dependency& d : plan->dependencies) {
            here.insert(std::string(name_of(d.hazard)));
            here.insert(d.transfers_ownership ? "ownership transfer" : "no transfer");
        }
        for (const VariantDecision& v : plan->variants) {
            here.insert("form " + std::to_string(v.form));
        }
        here.insert(plan->culled_passes.empty() ? "nothing left out" : "passes left out");
        for (const std::string& what : here) {
            ++seen[what];
        }
    }
    for (std::size_t i = 0; i < access_count; ++i) {
        const Access access = static_cast<Access>(i);
        if (access != Access::present) { // which the exit of an import stands for
            EXPECT_GE(seen[std::string(access_info(access).name)], 10U) << access_info(access).name;
        }
    }
    for (const char* what : {"byte range",
                             "modifies",
                             "mips",
                             "layers",
                             "3D image",
                             "asked to be shared",
                             "history of an image",
                             "history of a buffer",
                             "host's semaphore before",
                             "host's semaphore after",
                             "owner before",
                             "owner after",
                             "read-only import",
                             "graphics pass",
                             "compute pass",
                             "transfer pass",
                             "host pass",
                             "queue 0",
                             "queue 1",
                             "queue 2",
                             "kept on graphics by a ban",
                             "driven off graphics by a ban",
                             "ownership transfer",
                             "form 0",
                             "form 1",
                             "passes left out"}) {
        EXPECT_GE(seen[what], 10U) << what;
    }
    for (std::uint8_t h = 0; h <= static_cast<std::uint8_t>(Hazard::history_rest); ++h) {
        EXPECT_GE(seen[std::string(name_of(static_cast<Hazard>(h)))], 10U) << name_of(static_cast<Hazard>(h));
    }
}

/// An image is overwritten while another has been written in its bytes: the barrier of the first says nothing of what
/// was written through the second, though both were written by copies.
TEST(Verify, ATransitionOfOneResourceDoesNotFlushAnother) {
    GraphBuilder graph;
    const ImageDesc desc{.format = VK_FORMAT_R8G8B8A8_UNORM, .extent = {64, 64, 1}};
    Image gone = graph.create_image("gone", desc);
    Image kept = graph.create_image("kept", desc);
    Image other = graph.create_image("other", desc);
    const auto copy_to = [&](const char* pass, Image& image) {
        graph.add_pass(pass, PassKind::transfer).writes(image, Access::transfer_destination).has_side_effect("shown");
    };
    copy_to("fill kept", kept);
    copy_to("fill gone", gone);
    copy_to("fill other", other);
    graph.add_pass("draw kept", PassKind::graphics).writes(kept, Access::color_attachment).has_side_effect("shown");
    const DeclaredGraph declared = graph.finish();
    Plan plan = compiled(declared.desc, one_queue());
    EXPECT_EQ(text(verify(declared.desc, plan)), "");
    ASSERT_EQ(plan.placements[other.resource].offset_bytes, plan.placements[gone.resource].offset_bytes);
    plan.placements[other.resource].offset_bytes = plan.placements[kept.resource].offset_bytes;
    const std::vector<Violation> found = verify(declared.desc, plan);
    const bool unflushed = std::any_of(found.begin(), found.end(), [&](const Violation& v) {
        return v.code == ViolationCode::not_visible && v.resource == kept.resource;
    });
    EXPECT_TRUE(unflushed) << text(found);
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

} // namespace
} // namespace tyndall::rg::test
