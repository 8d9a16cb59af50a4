// The executor on several queue families and when calls fail, seen by a device that remembers every call.
#include <algorithm>
#include <array>
#include <bit>
#include <set>

#include "tests/rendergraph/frames.hpp"
#include "tests/rendergraph/random_graph.hpp"
#include "tests/rendergraph/recording_device.hpp"

namespace tyndall::rg::test {
namespace {

constexpr VkPipelineStageFlags2 everything = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;

class Queues : public testing::Test {
protected:
    Executor make(std::vector<QueueKind> kinds) {
        tl::expected<Executor, ExecuteError> made = Executor::create(device_.info(std::move(kinds)));
        EXPECT_TRUE(made.has_value());
        return std::move(*made);
    }
    void submit(Executor& executor, const DeclaredGraph& graph, const Plan& plan) {
        const auto frame = executor.submit(graph.desc, plan, graph.callbacks, made_up_bindings(graph.desc));
        ASSERT_TRUE(frame.has_value()) << frame.error().message;
    }
    [[nodiscard]] std::vector<const RecordedSubmit*> submits_of(std::uint32_t queue) const {
        std::vector<const RecordedSubmit*> out;
        for (const RecordedSubmit& submit : device_.submits) {
            if (submit.queue == RecordingDevice::queue(queue)) {
                out.push_back(&submit);
            }
        }
        return out;
    }

    RecordingDevice device_;
};

/// Async compute makes an image that graphics samples.
DeclaredGraph fog_then_draw() {
    GraphBuilder graph;
    Image fog = graph.create_image("fog", color_image());
    Image output = graph.import_image("output", color_image(), left_for_host());
    graph.add_pass("fog", PassKind::compute).writes(fog, Access::storage_compute).on_queue(QueueWish::async_compute);
    graph.add_pass("draw", PassKind::graphics)
        .reads(fog, Access::sampled_fragment)
        .writes(output, Access::color_attachment);
    return graph.finish();
}

TEST_F(Queues, OwnershipIsReleasedThenAcquiredAfterTheSemaphore) {
    Executor executor = make({QueueKind::graphics, QueueKind::compute});
    const DeclaredGraph graph = fog_then_draw();
    submit(executor, graph, compiled(graph.desc, executor.topology()));
    ASSERT_EQ(submits_of(0).size(), 1U);
    ASSERT_EQ(submits_of(1).size(), 1U);
    const RecordedSubmit& draw = *submits_of(0)[0];
    const RecordedSubmit& fog = *submits_of(1)[0];

    std::vector<VkImageMemoryBarrier2> releases = fog.commands.all_image_barriers();
    std::erase_if(releases,
                  [](const VkImageMemoryBarrier2& b) { return b.srcQueueFamilyIndex == b.dstQueueFamilyIndex; });
    std::vector<VkImageMemoryBarrier2> acquires = draw.commands.all_image_barriers();
    std::erase_if(acquires,
                  [](const VkImageMemoryBarrier2& b) { return b.srcQueueFamilyIndex == b.dstQueueFamilyIndex; });
    ASSERT_EQ(releases.size(), 1U);
    ASSERT_EQ(acquires.size(), 1U);
    const VkImageMemoryBarrier2& release = releases[0];
    const VkImageMemoryBarrier2& acquire = acquires[0];
    EXPECT_EQ(release.srcQueueFamilyIndex, 1U);
    EXPECT_EQ(release.dstQueueFamilyIndex, 0U);
    EXPECT_EQ(acquire.srcQueueFamilyIndex, 1U);
    EXPECT_EQ(acquire.dstQueueFamilyIndex, 0U);
    EXPECT_EQ(release.image, acquire.image);
    EXPECT_EQ(release.oldLayout, VK_IMAGE_LAYOUT_GENERAL);
    EXPECT_EQ(acquire.oldLayout, VK_IMAGE_LAYOUT_GENERAL);
    EXPECT_EQ(release.newLayout, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    EXPECT_EQ(acquire.newLayout, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    EXPECT_EQ(release.srcStageMask, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT);
    EXPECT_EQ(release.srcAccessMask, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
    EXPECT_EQ(release.dstStageMask, VK_PIPELINE_STAGE_2_NONE);
    EXPECT_EQ(acquire.srcStageMask & everything, everything) << "chained to the semaphore wait";
    EXPECT_EQ(acquire.srcAccessMask, VK_ACCESS_2_NONE);
    EXPECT_EQ(acquire.dstStageMask, VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT);
    EXPECT_EQ(acquire.dstAccessMask, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT);

    ASSERT_EQ(draw.waits.size(), 1U);
    EXPECT_EQ(draw.waits[0].semaphore, fog.signals[0].semaphore);
    EXPECT_EQ(draw.waits[0].value, fog.signals[0].value);
    ASSERT_EQ(draw.commands.color_attachments.size(), 1U);
    EXPECT_EQ(draw.commands.color_attachments[0][0].storeOp, VK_ATTACHMENT_STORE_OP_STORE);
}

TEST_F(Queues, FoldedOntoOneQueueNothingWaitsAndTheBarrierIsWhole) {
    Executor executor = make({QueueKind::graphics});
    const DeclaredGraph graph = fog_then_draw();
    submit(executor, graph, compiled(graph.desc, two_queues()));
    ASSERT_EQ(device_.submits.size(), 1U);
    EXPECT_TRUE(device_.submits[0].waits.empty());
    std::uint32_t to_sampled = 0;
    for (const VkImageMemoryBarrier2& barrier : device_.submits[0].commands.all_image_barriers()) {
        EXPECT_EQ(barrier.srcQueueFamilyIndex, VK_QUEUE_FAMILY_IGNORED);
        if (barrier.newLayout == VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL) {
            ++to_sampled;
            EXPECT_EQ(barrier.srcStageMask, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT);
            EXPECT_EQ(barrier.srcAccessMask, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
        }
    }
    EXPECT_EQ(to_sampled, 1U);
}

TEST_F(Queues, AFrameBeginsAfterAllOfTheFrameBefore) {
    Executor executor = make({QueueKind::graphics, QueueKind::compute});
    const DeclaredGraph graph = fog_then_draw();
    const Plan plan = compiled(graph.desc, executor.topology());
    submit(executor, graph, plan);
    submit(executor, graph, plan);
    const RecordedSubmit& first_draw = *submits_of(0)[0];
    const RecordedSubmit& second_fog = *submits_of(1)[1];
    ASSERT_EQ(second_fog.waits.size(), 1U) << "the memory of 'fog' is still read by the first frame's draw";
    EXPECT_EQ(second_fog.waits[0].semaphore, first_draw.signals[0].semaphore);
    EXPECT_EQ(second_fog.waits[0].value, first_draw.signals[0].value);
    for (const RecordedSubmit& recorded : device_.submits) {
        ASSERT_FALSE(recorded.commands.memory_barriers.empty());
        ASSERT_EQ(recorded.commands.memory_barriers[0].size(), 1U);
        EXPECT_EQ(recorded.commands.memory_barriers[0][0].srcStageMask, everything);
        EXPECT_EQ(recorded.commands.memory_barriers[0][0].dstStageMask, everything);
    }
}

TEST_F(Queues, MemoryThatChangesHandsIsMadeAvailableByAMemoryBarrier) {
    Executor executor = make({QueueKind::graphics});
    GraphBuilder builder;
    std::array<Buffer, 4> chain;
    for (std::size_t i = 0; i < chain.size(); ++i) {
        chain[i] = builder.create_buffer("link " + std::to_string(i), {.size_bytes = 256});
    }
    Buffer out = builder.import_buffer("out", {.size_bytes = 256},
                                       {.has_final = true, .final_stages = VK_PIPELINE_STAGE_2_HOST_BIT});
    builder.add_pass("fill", PassKind::transfer).writes(chain[0], Access::transfer_destination);
    for (std::size_t i = 1; i < chain.size(); ++i) {
        Buffer unread = builder.create_buffer("unread " + std::to_string(i), {.size_bytes = 256});
        builder.add_pass("step " + std::to_string(i), PassKind::compute)
            .reads(chain[i - 1], Access::storage_compute)
            .writes(unread, Access::storage_compute)
            .writes(chain[i], Access::storage_compute);
    }
    builder.add_pass("copy", PassKind::transfer)
        .reads(chain.back(), Access::transfer_source)
        .writes(out, Access::transfer_destination);
    const DeclaredGraph graph = builder.finish();
    const Plan plan = compiled(graph.desc, one_queue());
    submit(executor, graph, plan);
    std::size_t shared_with_content = 0;
    for (const Dependency& dependency : plan.dependencies) {
        shared_with_content += dependency.hazard == Hazard::aliased_memory && dependency.src_access != 0 ? 1 : 0;
    }
    ASSERT_GT(shared_with_content, 0U);
    std::size_t recorded = 0;
    std::size_t recorded_order = 0;
    for (const auto& barriers : device_.submits.at(0).commands.memory_barriers) {
        for (const VkMemoryBarrier2& barrier : barriers) {
            ++(barrier.srcAccessMask != 0 ? recorded : recorded_order);
        }
    }
    EXPECT_EQ(recorded, shared_with_content + 1) << "one for each, and the one that opens the frame";
    const auto orders_others = std::count_if(plan.dependencies.begin(), plan.dependencies.end(),
                                             [](const Dependency& d) { return d.orders_for != none; });
    EXPECT_EQ(recorded_order, static_cast<std::size_t>(orders_others)) << "what other resources rely on";
}

TEST_F(Queues, HostSemaphoresAreWaitedForAndSignalledWithTheFinalLayoutBefore) {
    Executor executor = make({QueueKind::graphics});
    GraphBuilder builder;
    Image target = builder.import_image("swapchain image", color_image(),
                                        {.waits_semaphore = true,
                                         .has_final = true,
                                         .final_layout = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR,
                                         .signals_semaphore = true});
    builder.add_pass("draw", PassKind::graphics)
        .writes(target, Access::color_attachment, {.clear = clear_color(0, 0, 0, 1)});
    const DeclaredGraph graph = builder.finish();
    submit(executor, graph, compiled(graph.desc, one_queue()));
    ASSERT_EQ(device_.submits.size(), 1U);
    const VkSemaphore host = std::bit_cast<VkSemaphore>(std::uint64_t{0x3000});
    ASSERT_EQ(device_.submits[0].waits.size(), 1U);
    EXPECT_EQ(device_.submits[0].waits[0].semaphore, host);
    EXPECT_TRUE(std::any_of(device_.submits[0].signals.begin(), device_.submits[0].signals.end(),
                            [&](const VkSemaphoreSubmitInfo& info) { return info.semaphore == host; }));
    EXPECT_EQ(device_.submits[0].commands.all_image_barriers().back().newLayout, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR);

    std::vector<ImportBinding> without = made_up_bindings(graph.desc);
    without[0].wait_semaphore = VK_NULL_HANDLE;
    const auto refused = executor.submit(graph.desc, compiled(graph.desc, one_queue()), graph.callbacks, without);
    ASSERT_FALSE(refused.has_value());
    EXPECT_EQ(refused.error().kind, ExecuteError::Kind::missing_binding);
    EXPECT_EQ(refused.error().message, "Imported resource 'swapchain image' has no semaphore to wait for bound in this "
                                       "frame; add it to the import bindings");
}

/// Graphics, compute, transfer: what a barrier there may name, of the stages that the random frames use.
VkPipelineStageFlags2 stages_of(std::uint32_t family) {
    const VkPipelineStageFlags2 transfer = everything | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
    return family == 0   ? ~VkPipelineStageFlags2{0}
           : family == 1 ? transfer | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT
                         : transfer;
}

// One transfer of one range, as both halves name it.
using Transfer = std::tuple<std::uint64_t, std::uint32_t, std::uint32_t, std::uint64_t, std::uint64_t, std::uint32_t,
                            std::uint32_t, std::uint32_t, std::uint32_t>;
std::multiset<Transfer> transfers(const RecordedSubmit& submit, std::uint32_t own_family, bool released) {
    std::multiset<Transfer> out;
    const auto counts = [&](std::uint32_t src, std::uint32_t dst) {
        return src != dst && (released ? src : dst) == own_family;
    };
    for (const VkImageMemoryBarrier2& b : submit.commands.all_image_barriers()) {
        if (counts(b.srcQueueFamilyIndex, b.dstQueueFamilyIndex)) {
            out.emplace(std::bit_cast<std::uint64_t>(b.image), b.srcQueueFamilyIndex, b.dstQueueFamilyIndex,
                        b.oldLayout, b.newLayout, b.subresourceRange.baseMipLevel, b.subresourceRange.levelCount,
                        b.subresourceRange.baseArrayLayer, b.subresourceRange.layerCount);
        }
    }
    for (const VkBufferMemoryBarrier2& b : submit.commands.all_buffer_barriers()) {
        if (counts(b.srcQueueFamilyIndex, b.dstQueueFamilyIndex)) {
            out.emplace(std::bit_cast<std::uint64_t>(b.buffer), b.srcQueueFamilyIndex, b.dstQueueFamilyIndex, b.offset,
                        b.size, 0, 0, 0, 0);
        }
    }
    return out;
}

TEST_F(Queues, RandomFramesPairEveryTransferAndNeverWaitForTheFuture) {
    std::size_t pairs = 0;
    for (std::uint32_t seed = 0; seed < 400; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        device_.submits.clear();
        const DeclaredGraph graph = random_frame(seed);
        const bool third = seed % 3 == 0;
        Executor executor = make(third ? std::vector{QueueKind::graphics, QueueKind::compute, QueueKind::transfer}
                                       : std::vector{QueueKind::graphics, QueueKind::compute});
        const Plan plan = compiled(graph.desc, executor.topology());
        submit(executor, graph, plan);
        submit(executor, graph, plan);
        std::map<VkSemaphore, std::uint64_t> reached;
        std::multiset<Transfer> released;
        for (const RecordedSubmit& recorded : device_.submits) {
            const auto family = static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(recorded.queue) - 0x1000);
            for (const VkSemaphoreSubmitInfo& wait : recorded.waits) {
                ASSERT_LE(wait.value, reached[wait.semaphore]) << "signalled only by a later submission";
            }
            for (const VkImageMemoryBarrier2& barrier : recorded.commands.all_image_barriers()) {
                ASSERT_EQ((barrier.srcStageMask | barrier.dstStageMask) & ~stages_of(family), 0U)
                    << "a stage that family " << family << " does not have";
            }
            for (const VkBufferMemoryBarrier2& barrier : recorded.commands.all_buffer_barriers()) {
                ASSERT_EQ((barrier.srcStageMask | barrier.dstStageMask) & ~stages_of(family), 0U)
                    << "a stage that family " << family << " does not have";
            }
            for (const Transfer& acquired : transfers(recorded, family, false)) {
                ASSERT_EQ(released.count(acquired), 1U) << "acquired, but never released so";
                released.erase(acquired);
                ++pairs;
            }
            released.merge(transfers(recorded, family, true));
            for (const VkSemaphoreSubmitInfo& signal : recorded.signals) {
                ASSERT_GT(signal.value, reached[signal.semaphore]);
                reached[signal.semaphore] = signal.value;
            }
        }
        ASSERT_TRUE(released.empty()) << "released, but never acquired";
    }
    EXPECT_GT(pairs, 100U) << "the frames have transfers to speak of";
}

TEST_F(Queues, EveryFailedCreationIsReportedAndLeavesNothing) {
    GraphBuilder builder;
    Image sum = builder.create_image("sum", color_image());
    const Image before = builder.history_of(sum);
    Image target = builder.create_image("target", color_image());
    Buffer numbers = builder.create_buffer("numbers", {.size_bytes = 256});
    Buffer out = builder.import_buffer("out", {.size_bytes = 256},
                                       {.has_final = true, .final_stages = VK_PIPELINE_STAGE_2_HOST_BIT});
    builder.add_pass("sum", PassKind::compute)
        .reads(before, Access::sampled_compute)
        .writes(sum, Access::storage_compute)
        .writes(numbers, Access::storage_compute);
    builder.add_pass("draw", PassKind::graphics)
        .reads(sum, Access::sampled_fragment)
        .writes(target, Access::color_attachment);
    builder.add_pass("copy", PassKind::transfer)
        .reads(target, Access::transfer_source)
        .reads(numbers, Access::transfer_source)
        .writes(out, Access::transfer_destination);
    const DeclaredGraph graph = builder.finish();
    std::int64_t failures = 0;
    for (bool succeeded = false; !succeeded && failures < 100; ++failures) {
        SCOPED_TRACE("creation " + std::to_string(failures));
        device_.creations = 0;
        device_.fail_at = failures;
        tl::expected<Executor, ExecuteError> executor = Executor::create(device_.info({QueueKind::graphics}));
        ExecuteError error;
        if (!executor) {
            error = executor.error();
        } else {
            const Plan plan = compiled(graph.desc, one_queue());
            const auto frame = executor->submit(graph.desc, plan, graph.callbacks, made_up_bindings(graph.desc));
            succeeded = frame.has_value();
            error = succeeded ? ExecuteError{} : frame.error();
            device_.fail_at = -1;
            submit(*executor, graph, plan); // what failed once works the next time
        }
        EXPECT_TRUE(succeeded || error.kind == ExecuteError::Kind::out_of_memory) << error.message;
        executor = tl::unexpected(ExecuteError{});
        ASSERT_EQ(device_.alive, 0);
    }
    EXPECT_GT(failures, 10);
}

TEST_F(Queues, ALostDeviceIsAReturnValueThatNamesTheLastPass) {
    Executor executor = make({QueueKind::graphics});
    const DeclaredGraph graph = fog_then_draw();
    const Plan plan = compiled(graph.desc, one_queue());
    submit(executor, graph, plan);
    device_.submit_result = VK_ERROR_DEVICE_LOST;
    const auto lost = executor.submit(graph.desc, plan, graph.callbacks, made_up_bindings(graph.desc));
    ASSERT_FALSE(lost.has_value());
    EXPECT_EQ(lost.error().kind, ExecuteError::Kind::device_lost);
    EXPECT_EQ(lost.error().result, VK_ERROR_DEVICE_LOST);
    EXPECT_EQ(lost.error().message,
              "The frame could not be submitted: the device was lost (VkResult -4); which pass ran is not known; the "
              "last one submitted was 'draw'");
}

} // namespace
} // namespace tyndall::rg::test
