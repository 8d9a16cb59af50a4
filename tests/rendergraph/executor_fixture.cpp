#include "tests/rendergraph/executor_fixture.hpp"

#include <cstdint>

#include "spirv/test_accumulate.h"
#include "spirv/test_affine.h"
#include "spirv/test_cover.h"
#include "spirv/test_double.h"
#include "spirv/test_pattern.h"

namespace tyndall::test {

using namespace rg;

namespace {

constexpr VkDescriptorType storage_buffer = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
constexpr VkDescriptorType storage_image = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
constexpr VkDescriptorType sampled_image = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;

} // namespace

ImageDesc image_of(std::uint32_t width, std::uint32_t height) {
    return {.format = rgba32f, .extent = {width, height, 1}};
}

void ExecutorTest::SetUp() {
    GpuTest::SetUp();
    affine_ = compute_pipeline(test_affine, std::array{storage_buffer, storage_buffer}, 12);
    pattern_ = compute_pipeline(test_pattern, std::array{storage_image}, 16);
    accumulate_ = compute_pipeline(test_accumulate, std::array{sampled_image, storage_image}, 20);
    double_ = graphics_pipeline(test_cover, test_double, std::array{sampled_image}, rgba32f);
    sampler_ = nearest_sampler();
}

PassBuilder ExecutorTest::add_affine(GraphBuilder& graph, std::string_view name, Buffer source, Buffer& destination,
                                     std::uint32_t scale, std::uint32_t offset, std::uint32_t count) {
    PassBuilder pass = graph.add_pass(name, PassKind::compute);
    pass.reads(source, Access::storage_compute).writes(destination, Access::storage_compute);
    pass.executes([=, pipeline = affine_, out = destination](PassContext& ctx) {
        const std::array<std::uint32_t, 3> constants = {scale, offset, count};
        ctx.vk().CmdBindPipeline(ctx.cmd(), VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.pipeline);
        ctx.push(VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.layout, 0,
                 std::array{ctx.storage(0, source), ctx.storage(1, out)}, pipeline.bindings);
        ctx.vk().CmdPushConstants(ctx.cmd(), pipeline.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, 12, constants.data());
        ctx.vk().CmdDispatch(ctx.cmd(), (count + 63) / 64, 1, 1);
    });
    return pass;
}

void ExecutorTest::add_fill(GraphBuilder& graph, std::string_view name, Buffer& buffer, std::uint32_t value) {
    graph.add_pass(name, PassKind::transfer)
        .writes(buffer, Access::transfer_destination)
        .executes(
            [=](PassContext& ctx) { ctx.vk().CmdFillBuffer(ctx.cmd(), ctx.buffer(buffer), 0, VK_WHOLE_SIZE, value); });
}

void ExecutorTest::add_pattern(GraphBuilder& graph, std::string_view name, Image& image, VkExtent2D extent,
                               Texel base) {
    graph.add_pass(name, PassKind::compute)
        .writes(image, Access::storage_compute)
        .executes([=, pipeline = pattern_](PassContext& ctx) {
            ctx.vk().CmdBindPipeline(ctx.cmd(), VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.pipeline);
            ctx.push(VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.layout, 0, std::array{ctx.storage(0, image)},
                     pipeline.bindings);
            ctx.vk().CmdPushConstants(ctx.cmd(), pipeline.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, 16, base.data());
            ctx.vk().CmdDispatch(ctx.cmd(), (extent.width + 7) / 8, (extent.height + 7) / 8, 1);
        });
}

PassBuilder ExecutorTest::add_accumulate(GraphBuilder& graph, std::string_view name, Image source, Image& destination,
                                         VkExtent2D extent, float increment, bool is_history,
                                         const ImageRange& source_range, const ImageUse& destination_use) {
    PassBuilder pass = graph.add_pass(name, PassKind::compute);
    pass.reads(source, Access::sampled_compute, source_range);
    pass.writes(destination, Access::storage_compute, destination_use);
    pass.executes([=, this, pipeline = accumulate_, out = destination](PassContext& ctx) {
        struct {
            Texel increment;
            std::uint32_t valid;
        } constants{{increment, increment, increment, increment}, !is_history || ctx.history_valid(source)};
        ctx.vk().CmdBindPipeline(ctx.cmd(), VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.pipeline);
        ctx.push(VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.layout, 0,
                 std::array{ctx.sampled(0, source, sampler_), ctx.storage(1, out)}, pipeline.bindings);
        ctx.vk().CmdPushConstants(ctx.cmd(), pipeline.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, 20, &constants);
        ctx.vk().CmdDispatch(ctx.cmd(), (extent.width + 7) / 8, (extent.height + 7) / 8, 1);
    });
    return pass;
}

void ExecutorTest::add_double(GraphBuilder& graph, std::string_view name, Image source, Image& target) {
    graph.add_pass(name, PassKind::graphics)
        .reads(source, Access::sampled_fragment)
        .writes(target, Access::color_attachment)
        .executes([=, this, pipeline = double_](PassContext& ctx) {
            ctx.vk().CmdBindPipeline(ctx.cmd(), VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.pipeline);
            ctx.push(VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.layout, 0, std::array{ctx.sampled(0, source, sampler_)},
                     pipeline.bindings);
            ctx.vk().CmdDraw(ctx.cmd(), 3, 1, 0, 0);
        });
}

void ExecutorTest::add_copy(GraphBuilder& graph, std::string_view name, Image image, Buffer& buffer, VkExtent2D extent,
                            std::uint32_t mip, std::uint32_t layer, VkImageAspectFlags aspects) {
    graph.add_pass(name, PassKind::transfer)
        .reads(image, Access::transfer_source, {mip, 1, layer, 1})
        .writes(buffer, Access::transfer_destination)
        .executes([=](PassContext& ctx) {
            const VkBufferImageCopy2 region{.sType = VK_STRUCTURE_TYPE_BUFFER_IMAGE_COPY_2,
                                            .imageSubresource = {aspects, mip, layer, 1},
                                            .imageExtent = {extent.width, extent.height, 1}};
            const VkCopyImageToBufferInfo2 copy{.sType = VK_STRUCTURE_TYPE_COPY_IMAGE_TO_BUFFER_INFO_2,
                                                .srcImage = ctx.image(image),
                                                .srcImageLayout = ctx.layout(image),
                                                .dstBuffer = ctx.buffer(buffer),
                                                .regionCount = 1,
                                                .pRegions = &region};
            ctx.vk().CmdCopyImageToBuffer2(ctx.cmd(), &copy);
        });
}

Buffer ExecutorTest::import_read_back(GraphBuilder& graph, std::string_view name, const HostBuffer& buffer) {
    const Buffer imported = graph.import_buffer(name, {.size_bytes = buffer.size_bytes}, read_by_host());
    bindings_.push_back({.resource = imported.resource, .buffer = buffer.buffer});
    return imported;
}

HostBuffer ExecutorTest::read_back_buffer(VkDeviceSize bytes) {
    return host_buffer(bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
}

void ExecutorTest::run_bound(const DeclaredGraph& graph) {
    run(graph, bindings_);
    bindings_.clear();
}

} // namespace tyndall::test
