#include "tests/volumetrics/transfer_passes.hpp"

#include "rendergraph/executor.hpp"

namespace tyndall::volumetrics::test {
namespace {

using rg::Access;
using rg::PassContext;
using rg::PassKind;

VkImageSubresourceLayers subresource(VkImageAspectFlags aspect, std::uint32_t layers) {
    return {aspect, 0, 0, layers};
}

} // namespace

void upload(rg::GraphBuilder& graph, const std::string& pass_name, rg::Buffer source, rg::Image& image) {
    const rg::ImageDesc desc = *graph.describe(image);
    auto pass = graph.add_pass(pass_name, PassKind::transfer);
    pass.reads(source, Access::transfer_source).writes(image, Access::transfer_destination);
    pass.executes([=, target = image](PassContext& ctx) {
        const VkBufferImageCopy2 region{.sType = VK_STRUCTURE_TYPE_BUFFER_IMAGE_COPY_2,
                                        .imageSubresource = subresource(rg::format_aspects(desc.format), desc.layers),
                                        .imageExtent = desc.extent};
        const VkCopyBufferToImageInfo2 info{.sType = VK_STRUCTURE_TYPE_COPY_BUFFER_TO_IMAGE_INFO_2,
                                            .srcBuffer = ctx.buffer(source),
                                            .dstImage = ctx.image(target),
                                            .dstImageLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                            .regionCount = 1,
                                            .pRegions = &region};
        ctx.vk().CmdCopyBufferToImage2(ctx.cmd(), &info);
    });
}

void download(rg::GraphBuilder& graph, const std::string& pass_name, rg::Image image, rg::Buffer& target) {
    const rg::ImageDesc desc = *graph.describe(image);
    auto pass = graph.add_pass(pass_name, PassKind::transfer);
    pass.reads(image, Access::transfer_source).writes(target, Access::transfer_destination);
    pass.executes([=, buffer = target](PassContext& ctx) {
        const VkBufferImageCopy2 region{.sType = VK_STRUCTURE_TYPE_BUFFER_IMAGE_COPY_2,
                                        .imageSubresource = subresource(rg::format_aspects(desc.format), desc.layers),
                                        .imageExtent = desc.extent};
        const VkCopyImageToBufferInfo2 info{.sType = VK_STRUCTURE_TYPE_COPY_IMAGE_TO_BUFFER_INFO_2,
                                            .srcImage = ctx.image(image),
                                            .srcImageLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                            .dstBuffer = ctx.buffer(buffer),
                                            .regionCount = 1,
                                            .pRegions = &region};
        ctx.vk().CmdCopyImageToBuffer2(ctx.cmd(), &info);
    });
}

void download(rg::GraphBuilder& graph, const std::string& pass_name, rg::Buffer source, rg::Buffer& target) {
    const VkDeviceSize size_bytes = graph.describe(source)->size_bytes;
    auto pass = graph.add_pass(pass_name, PassKind::transfer);
    pass.reads(source, Access::transfer_source).writes(target, Access::transfer_destination);
    pass.executes([=, buffer = target](PassContext& ctx) {
        const VkBufferCopy region{0, 0, size_bytes};
        ctx.vk().CmdCopyBuffer(ctx.cmd(), ctx.buffer(source), ctx.buffer(buffer), 1, &region);
    });
}

} // namespace tyndall::volumetrics::test
