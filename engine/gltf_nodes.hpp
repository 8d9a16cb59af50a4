// The node hierarchy of a glTF file: where its meshes, cameras and lights stand.
#pragma once

#include <vector>

#include <glm/mat4x4.hpp>
#include <tl/expected.hpp>

#include "engine/gltf_document.hpp"

namespace tyndall::engine {

/// A node that the scene reaches.
struct PlacedNode {
    std::size_t node = 0;
    glm::dmat4 world_from_node{1.0};
};

/// All nodes of the scene to show, parents before children, in the file's order. Errors: an index that is not there, a
/// node with two parents or below itself, a transform of the wrong length or one that leaves the range of numbers.
[[nodiscard]] tl::expected<std::vector<PlacedNode>, Error> place_gltf_nodes(const GltfDocument& document);

} // namespace tyndall::engine
