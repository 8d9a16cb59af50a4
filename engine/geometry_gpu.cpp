#include "engine/geometry_gpu.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tyndall::engine {
namespace {

std::int16_t snorm(float value) {
    return static_cast<std::int16_t>(std::lround(std::clamp(value, -1.0F, 1.0F) * 32767.0F));
}

std::uint16_t unorm(float value) {
    return static_cast<std::uint16_t>(std::lround(std::clamp(value, 0.0F, 1.0F) * 65535.0F));
}

VertexAttributes pack(const Primitive& primitive, std::size_t vertex) {
    const glm::vec3& n = primitive.normals[vertex];
    const glm::vec4& t = primitive.tangents[vertex];
    const glm::vec4& c = primitive.colors[vertex];
    return {.normal = {snorm(n.x), snorm(n.y), snorm(n.z), 0},
            .tangent = {snorm(t.x), snorm(t.y), snorm(t.z), snorm(t.w)},
            .uv = {primitive.uv0[vertex].x, primitive.uv0[vertex].y, primitive.uv1[vertex].x, primitive.uv1[vertex].y},
            .color = {unorm(c.r), unorm(c.g), unorm(c.b), unorm(c.a)}};
}

constexpr std::array<VkVertexInputBindingDescription, 2> bindings = {
    {{0, sizeof(glm::vec3), VK_VERTEX_INPUT_RATE_VERTEX}, {1, sizeof(VertexAttributes), VK_VERTEX_INPUT_RATE_VERTEX}}};
constexpr std::array<VkVertexInputAttributeDescription, 5> attributes_of = {
    {{0, 0, VK_FORMAT_R32G32B32_SFLOAT, 0},
     {1, 1, VK_FORMAT_R16G16B16A16_SNORM, offsetof(VertexAttributes, normal)},
     {2, 1, VK_FORMAT_R16G16B16A16_SNORM, offsetof(VertexAttributes, tangent)},
     {3, 1, VK_FORMAT_R32G32B32A32_SFLOAT, offsetof(VertexAttributes, uv)},
     {4, 1, VK_FORMAT_R16G16B16A16_UNORM, offsetof(VertexAttributes, color)}}};

/// A scene without triangles still has buffers to bind.
template <typename T>
tl::expected<Buffer, Error> upload(Uploader& uploader, const std::vector<T>& values, VkBufferUsageFlags usage) {
    const T nothing{};
    const std::span<const T> content = values.empty() ? std::span<const T>(&nothing, 1) : std::span<const T>(values);
    return uploader.buffer(std::as_bytes(content), usage);
}

} // namespace

PackedGeometry pack_geometry(std::span<const Primitive> primitives) {
    PackedGeometry packed;
    for (const Primitive& primitive : primitives) {
        packed.ranges.push_back({.first_index = static_cast<std::uint32_t>(packed.indices.size()),
                                 .index_count = static_cast<std::uint32_t>(primitive.indices.size()),
                                 .first_vertex = static_cast<std::int32_t>(packed.positions.size()),
                                 .has_colors = std::any_of(primitive.colors.begin(), primitive.colors.end(),
                                                           [](const glm::vec4& c) { return c != glm::vec4(1.0F); })});
        packed.positions.insert(packed.positions.end(), primitive.positions.begin(), primitive.positions.end());
        packed.indices.insert(packed.indices.end(), primitive.indices.begin(), primitive.indices.end());
        for (std::size_t vertex = 0; vertex < primitive.positions.size(); ++vertex) {
            packed.attributes.push_back(pack(primitive, vertex));
        }
    }
    return packed;
}

tl::expected<GeometryGpu, Error> upload_geometry(Uploader& uploader, std::span<const Primitive> primitives) {
    PackedGeometry packed = pack_geometry(primitives);
    GeometryGpu out;
    out.ranges = std::move(packed.ranges);
    auto positions = upload(uploader, packed.positions, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
    auto attributes = upload(uploader, packed.attributes, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
    auto indices = upload(uploader, packed.indices, VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
    for (const auto* made : {&positions, &attributes, &indices}) {
        if (!*made) {
            return tl::unexpected(made->error());
        }
    }
    out.positions = std::move(*positions);
    out.attributes = std::move(*attributes);
    out.indices = std::move(*indices);
    return out;
}

std::span<const VkVertexInputBindingDescription> vertex_bindings(bool attributes) {
    return std::span(bindings).first(attributes ? 2 : 1);
}

std::span<const VkVertexInputAttributeDescription> vertex_attributes(bool attributes) {
    return std::span(attributes_of).first(attributes ? 5 : 1);
}

} // namespace tyndall::engine
