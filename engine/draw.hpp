// Indexed draws of a scene's instances, and their recording with as few state changes as their order allows.
#pragma once

#include <cstdint>
#include <span>

#include "engine/geometry_gpu.hpp"
#include "engine/renderer_pipelines.hpp"
#include "rendergraph/executor.hpp"

namespace tyndall::engine {

/// A scene's geometry as imports of a frame.
struct GeometryImports {
    rg::Buffer positions;
    rg::Buffer attributes;
    rg::Buffer indices;
};

struct Draw {
    VkPipeline pipeline = VK_NULL_HANDLE;
    VkDescriptorSet material = VK_NULL_HANDLE; ///< set 1; null: the shaders read no material
    std::uint32_t instance = 0;
    PrimitiveRange range;
    VkCullModeFlags cull = VK_CULL_MODE_NONE;
    VkFrontFace front = VK_FRONT_FACE_COUNTER_CLOCKWISE;
};

/// Vertex and index buffers; `attributes`: beside the positions.
void declare_geometry(rg::PassBuilder& pass, const GeometryImports& geometry, bool attributes);

/// Records draws that share a pipeline layout. What else records into the same pass may change everything: `forget`
/// then.
class DrawRecorder {
public:
    DrawRecorder(rg::PassContext& ctx, VkPipelineLayout layout, const GeometryImports& geometry, bool attributes)
        : ctx_(ctx), layout_(layout), geometry_(geometry), attributes_(attributes) {}

    void draw(const Draw& draw);
    void forget() { known_ = false; }

private:
    rg::PassContext& ctx_;
    VkPipelineLayout layout_;
    GeometryImports geometry_;
    bool attributes_;
    bool known_ = false; ///< `last_` is what is bound
    Draw last_;
};

} // namespace tyndall::engine
