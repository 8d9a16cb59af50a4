// Frames that several tests compile.
#pragma once

#include <gtest/gtest.h>

#include "rendergraph/compile.hpp"
#include "rendergraph/graph.hpp"
#include "rendergraph/plan_text.hpp"

namespace tyndall::rg::test {

inline QueueTopology one_queue() {
    return {};
}

/// Graphics and async compute, in different families.
inline QueueTopology two_queues() {
    return {{{QueueKind::graphics, 0, can_graphics | can_compute | can_transfer},
             {QueueKind::compute, 1, can_compute | can_transfer}}};
}
/// Graphics and async compute, in one family.
inline QueueTopology two_queues_one_family() {
    return {{{QueueKind::graphics, 0, can_graphics | can_compute | can_transfer},
             {QueueKind::compute, 0, can_graphics | can_compute | can_transfer}}};
}

inline ImageDesc color_image(std::uint32_t width = 64, std::uint32_t height = 64) {
    return {.format = VK_FORMAT_R16G16B16A16_SFLOAT, .extent = {width, height, 1}};
}

inline ImportDesc left_for_host() {
    return {.has_final = true,
            .final_layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
            .final_stages = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
            .final_access = VK_ACCESS_2_TRANSFER_READ_BIT};
}

inline Plan compiled(const GraphDesc& graph, const QueueTopology& topology, const CompileOptions& options = {}) {
    tl::expected<Plan, Diagnostics> plan = compile(graph, topology, estimate_memory(graph), options);
    EXPECT_TRUE(plan.has_value()) << (plan.has_value() ? "" : to_text(plan.error()));
    return plan.value_or(Plan{});
}

/// Place of a pass in the submission order, `none` if it is left out.
inline std::uint32_t place_of(const GraphDesc& graph, const Plan& plan, std::string_view name) {
    for (std::uint32_t i = 0; i < plan.passes.size(); ++i) {
        if (graph.passes[plan.passes[i].pass].name == name) {
            return i;
        }
    }
    return none;
}

/// A small volumetric frame: shadow maps, exponential shadow map, fog and opaque work, on async compute where asked
/// for.
inline DeclaredGraph fog_frame() {
    GraphBuilder graph;
    graph.set_injection_points({"frame_begin", "after_shadow_maps", "after_opaque", "post"});
    Image output = graph.import_image("output", color_image(), left_for_host());
    Image cascades =
        graph.create_image("cascades", {.format = VK_FORMAT_D32_SFLOAT, .extent = {256, 256, 1}, .layers = 2});
    Image esm = graph.create_image("esm", {.format = VK_FORMAT_R32_SFLOAT, .extent = {64, 64, 1}, .layers = 2});
    Image depth = graph.create_image("depth", {.format = VK_FORMAT_D32_SFLOAT, .extent = {64, 64, 1}});
    Image color = graph.create_image("color", color_image());
    const ImageDesc volume = {.format = VK_FORMAT_R16G16B16A16_SFLOAT, .extent = {16, 9, 8}, .type = VK_IMAGE_TYPE_3D};
    Image density = graph.create_image("density", volume);
    Image lighting = graph.create_image("lighting", volume);
    Image previous = graph.history_of(lighting);
    Image accumulated = graph.create_image("accumulated", volume);
    Image unused = graph.create_image("debug view", color_image());

    graph.begin_injection_point(0);
    graph.add_pass("density", PassKind::compute)
        .writes(density, Access::storage_compute)
        .on_queue(QueueWish::async_compute);
    graph.end_injection_point();
    for (std::uint32_t layer = 0; layer < 2; ++layer) {
        graph.add_pass("shadow map " + std::to_string(layer), PassKind::graphics)
            .writes(cascades, Access::depth_attachment,
                    {.range = {.base_layer = layer, .layer_count = 1}, .clear = clear_depth(1.0F)});
    }
    graph.begin_injection_point(1);
    graph.add_pass("esm downsample", PassKind::compute)
        .reads(cascades, Access::sampled_compute)
        .writes(esm, Access::storage_compute)
        .on_queue(QueueWish::async_compute);
    graph.add_pass("froxel lighting", PassKind::compute)
        .reads(density, Access::sampled_compute)
        .reads(esm, Access::sampled_compute)
        .reads(previous, Access::sampled_compute)
        .writes(lighting, Access::storage_compute)
        .on_queue(QueueWish::async_compute);
    graph.add_pass("accumulation", PassKind::compute)
        .reads(density, Access::sampled_compute)
        .reads(lighting, Access::sampled_compute)
        .writes(accumulated, Access::storage_compute)
        .on_queue(QueueWish::async_compute);
    graph.end_injection_point();
    graph.add_pass("depth pre-pass", PassKind::graphics)
        .writes(depth, Access::depth_attachment, {.clear = clear_depth(0.0F)});
    graph.add_pass("opaque", PassKind::graphics)
        .reads(cascades, Access::sampled_fragment)
        .reads(depth, Access::depth_attachment)
        .writes(color, Access::color_attachment, {.clear = clear_color(0, 0, 0, 1)});
    graph.add_pass("debug", PassKind::graphics)
        .reads(depth, Access::sampled_fragment)
        .writes(unused, Access::color_attachment);
    graph.begin_injection_point(2);
    graph.add_pass("fog on opaque", PassKind::graphics)
        .reads(depth, Access::sampled_fragment)
        .reads(accumulated, Access::sampled_fragment)
        .modifies(color, Access::color_attachment);
    graph.end_injection_point();
    graph.begin_injection_point(3);
    graph.add_pass("tone mapping", PassKind::compute)
        .reads(color, Access::sampled_compute)
        .writes(output, Access::storage_compute);
    graph.end_injection_point();
    return graph.finish();
}

} // namespace tyndall::rg::test
