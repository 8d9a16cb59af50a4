#include "engine/draw.hpp"

#include <array>

namespace tyndall::engine {

void declare_geometry(rg::PassBuilder& pass, const GeometryImports& geometry, bool attributes) {
    pass.reads(geometry.positions, rg::Access::vertex_buffer).reads(geometry.indices, rg::Access::index_buffer);
    if (attributes) {
        pass.reads(geometry.attributes, rg::Access::vertex_buffer);
    }
}

void DrawRecorder::draw(const Draw& draw) {
    const rg::DeviceTable& vk = ctx_.vk();
    const VkCommandBuffer cmd = ctx_.cmd();
    if (!known_) {
        const std::array<VkBuffer, 2> buffers = {ctx_.buffer(geometry_.positions),
                                                 attributes_ ? ctx_.buffer(geometry_.attributes) : VK_NULL_HANDLE};
        const std::array<VkDeviceSize, 2> offsets = {0, 0};
        vk.CmdBindVertexBuffers(cmd, 0, attributes_ ? 2 : 1, buffers.data(), offsets.data());
        vk.CmdBindIndexBuffer(cmd, ctx_.buffer(geometry_.indices), 0, VK_INDEX_TYPE_UINT32);
    }
    if (!known_ || last_.pipeline != draw.pipeline) {
        vk.CmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, draw.pipeline);
    }
    // Draws of the same layout read materials either all or, where masks stand among plain depth, from time to time.
    if (draw.material != VK_NULL_HANDLE && (!known_ || last_.material != draw.material)) {
        vk.CmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_, 1, 1, &draw.material, 0, nullptr);
    }
    if (!known_ || last_.cull != draw.cull) {
        vk.CmdSetCullMode(cmd, draw.cull);
    }
    if (!known_ || last_.front != draw.front) {
        vk.CmdSetFrontFace(cmd, draw.front);
    }
    vk.CmdDrawIndexed(cmd, draw.range.index_count, 1, draw.range.first_index, draw.range.first_vertex, draw.instance);
    last_ = draw;
    known_ = true;
}

} // namespace tyndall::engine
