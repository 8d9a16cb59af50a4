// The render graph in a host of its own: declare a frame, compile it for two queues, read the plan. Everything up to
// here is plain data, so it runs without a Vulkan device; rg::Executor (rendergraph/executor.hpp) runs the same plan.
#include <cstdio>
#include <string>

#include <rendergraph/compile.hpp>
#include <rendergraph/graph.hpp>
#include <rendergraph/plan_text.hpp>

namespace {

namespace rg = tyndall::rg;

rg::DeclaredGraph declare_frame() {
    rg::GraphBuilder graph;

    // The host owns the output. It says what state the image arrives in and in which state it wants it back.
    rg::Image output = graph.import_image("output", {.format = VK_FORMAT_R8G8B8A8_UNORM, .extent = {1920, 1080, 1}},
                                          {.has_final = true,
                                           .final_layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                           .final_stages = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                           .final_access = VK_ACCESS_2_TRANSFER_READ_BIT});
    // The graph owns the rest, places it in memory, and lets images share bytes when their lives cannot overlap.
    rg::Image depth = graph.create_image("depth", {.format = VK_FORMAT_D32_SFLOAT, .extent = {1920, 1080, 1}});
    rg::Image shadow = graph.create_image("shadow map", {.format = VK_FORMAT_D32_SFLOAT, .extent = {2048, 2048, 1}});
    rg::Image occlusion = graph.create_image("occlusion", {.format = VK_FORMAT_R8_UNORM, .extent = {1920, 1080, 1}});
    rg::Image color = graph.create_image("color", {.format = VK_FORMAT_R16G16B16A16_SFLOAT, .extent = {1920, 1080, 1}});
    rg::Image overdraw = graph.create_image("overdraw", {.format = VK_FORMAT_R16_UINT, .extent = {1920, 1080, 1}});

    // A pass lists what it touches. A write makes a new version of the handle; a later pass that names the handle reads
    // that version. No barrier is written by hand.
    graph.add_pass("depth pre-pass", rg::PassKind::graphics)
        .writes(depth, rg::Access::depth_attachment, {.clear = rg::clear_depth(0.0F)});
    // Asked for on async compute, where it can run beside the shadow map.
    graph.add_pass("ambient occlusion", rg::PassKind::compute)
        .reads(depth, rg::Access::sampled_compute)
        .writes(occlusion, rg::Access::storage_compute)
        .on_queue(rg::QueueWish::async_compute);
    graph.add_pass("shadow map", rg::PassKind::graphics)
        .writes(shadow, rg::Access::depth_attachment, {.clear = rg::clear_depth(1.0F)});
    graph.add_pass("opaque", rg::PassKind::graphics)
        .reads(shadow, rg::Access::sampled_fragment)
        .reads(occlusion, rg::Access::sampled_fragment)
        .reads(depth, rg::Access::depth_attachment)
        .writes(color, rg::Access::color_attachment, {.clear = rg::clear_color(0.0F, 0.0F, 0.0F, 1.0F)});
    // Nobody reads this one, so the plan leaves it out and says so.
    graph.add_pass("count overdraw", rg::PassKind::compute)
        .reads(depth, rg::Access::sampled_compute)
        .writes(overdraw, rg::Access::storage_compute);
    graph.add_pass("tone mapping", rg::PassKind::compute)
        .reads(color, rg::Access::sampled_compute)
        .writes(output, rg::Access::storage_compute);
    // A host that runs the plan gives each pass its commands: .executes([=](rg::PassContext& ctx) { ... }).
    return graph.finish();
}

} // namespace

int main() {
    const rg::DeclaredGraph frame = declare_frame();

    // Graphics in family 0, async compute in family 1. On a device with one queue, leave the second one away.
    const rg::QueueTopology queues = {
        {{.kind = rg::QueueKind::graphics, .family = 0},
         {.kind = rg::QueueKind::compute, .family = 1, .capabilities = rg::can_compute | rg::can_transfer}}};
    // With a device: what vkGetImageMemoryRequirements says. Without one: estimated from formats and sizes.
    const rg::MemoryRequirements memory = rg::estimate_memory(frame.desc);

    // Mistakes are values: all of them together, each with the place of its declaration and what to change.
    const tl::expected<rg::Plan, rg::Diagnostics> plan = rg::compile(frame.desc, queues, memory);
    if (!plan) {
        std::fputs(rg::to_text(plan.error()).c_str(), stderr);
        return 1;
    }
    std::fputs(rg::to_text(frame.desc, *plan).c_str(), stdout);
    return 0;
}
