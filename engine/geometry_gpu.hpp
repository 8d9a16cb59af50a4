// A scene's triangles in device memory: all primitives in three buffers.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tl/expected.hpp>

#include "engine/memory.hpp"
#include "engine/scene.hpp"
#include "engine/upload.hpp"

namespace tyndall::engine {

/// What shading reads of a vertex beside its position.
struct VertexAttributes {
    std::array<std::int16_t, 4> normal;  ///< snorm; w unused
    std::array<std::int16_t, 4> tangent; ///< snorm; w: sign of the bitangent
    std::array<float, 4> uv;             ///< both sets
    std::array<std::uint16_t, 4> color;  ///< unorm, linear
};
static_assert(sizeof(VertexAttributes) == 40);

/// Where a primitive lies in the buffers.
struct PrimitiveRange {
    std::uint32_t first_index = 0;
    std::uint32_t index_count = 0;
    std::int32_t first_vertex = 0;
    bool has_colors = false; ///< some vertex colour is not white
};

/// Bytes of the three buffers, and where each primitive lies in them.
struct PackedGeometry {
    std::vector<glm::vec3> positions;
    std::vector<VertexAttributes> attributes;
    std::vector<std::uint32_t> indices; ///< count from the primitive's first vertex
    std::vector<PrimitiveRange> ranges;
};
[[nodiscard]] PackedGeometry pack_geometry(std::span<const Primitive> primitives);

struct GeometryGpu {
    Buffer positions;  ///< vec3
    Buffer attributes; ///< VertexAttributes
    Buffer indices;    ///< uint32
    std::vector<PrimitiveRange> ranges;
};
/// Content after uploader.finish().
[[nodiscard]] tl::expected<GeometryGpu, Error> upload_geometry(Uploader& uploader,
                                                               std::span<const Primitive> primitives);

/// Positions alone, and with all attributes: locations as in shaders/engine/forward.vert.
[[nodiscard]] std::span<const VkVertexInputBindingDescription> vertex_bindings(bool attributes);
[[nodiscard]] std::span<const VkVertexInputAttributeDescription> vertex_attributes(bool attributes);

} // namespace tyndall::engine
