#include "engine/gltf_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>

namespace tyndall::engine {
namespace {

/// Times the largest position that is read, it still is a finite number of 32 bits, and so is its square in 64.
constexpr double transform_limit = 1e18;

std::string node_label(const tinygltf::Model& model, std::size_t index) {
    return gltf_label("node", index, model.nodes[index].name);
}

/// Translation * rotation * scale, or the matrix (column-major); nothing for lists of a wrong length.
std::optional<glm::dmat4> local_transform(const tinygltf::Node& node) {
    if (!node.matrix.empty()) {
        return node.matrix.size() == 16 ? std::optional(glm::make_mat4(node.matrix.data())) : std::nullopt;
    }
    const auto fits = [](const std::vector<double>& values, std::size_t size) {
        return values.empty() || values.size() == size;
    };
    if (!fits(node.translation, 3) || !fits(node.rotation, 4) || !fits(node.scale, 3)) {
        return std::nullopt;
    }
    glm::dmat4 transform(1.0);
    if (!node.rotation.empty()) {
        const auto& xyzw = node.rotation;
        const glm::dquat rotation(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
        if (glm::length(rotation) > 0.0) {
            transform = glm::mat4_cast(glm::normalize(rotation));
        }
    }
    for (int i = 0; i < 3 && !node.scale.empty(); ++i) {
        transform[i] *= node.scale[static_cast<std::size_t>(i)];
    }
    if (!node.translation.empty()) {
        transform[3] = glm::dvec4(glm::make_vec3(node.translation.data()), 1.0);
    }
    return transform;
}

bool in_range(const glm::dmat4& matrix) {
    const double* values = glm::value_ptr(matrix);
    return std::all_of(values, values + 16, [](double value) { return std::abs(value) <= transform_limit; });
}

std::vector<int> nodes_without_parent(const tinygltf::Model& model) {
    std::vector<bool> has_parent(model.nodes.size(), false);
    for (const tinygltf::Node& node : model.nodes) {
        for (const int child : node.children) {
            if (gltf_index_ok(child, model.nodes.size())) {
                has_parent[static_cast<std::size_t>(child)] = true;
            }
        }
    }
    std::vector<int> roots;
    for (std::size_t i = 0; i < model.nodes.size(); ++i) {
        if (!has_parent[i]) {
            roots.push_back(static_cast<int>(i));
        }
    }
    return roots;
}

tl::expected<std::vector<int>, Error> root_nodes(const tinygltf::Model& model) {
    if (model.scenes.empty()) {
        return nodes_without_parent(model);
    }
    const int scene = model.defaultScene < 0 ? 0 : model.defaultScene;
    if (!gltf_index_ok(scene, model.scenes.size())) {
        return tl::unexpected(Error{"it shows scene " + std::to_string(scene) + ", which is not there"});
    }
    return model.scenes[static_cast<std::size_t>(scene)].nodes;
}

} // namespace

tl::expected<std::vector<PlacedNode>, Error> place_gltf_nodes(const GltfDocument& document) {
    const tinygltf::Model& model = document.model;
    auto roots = root_nodes(model);
    if (!roots) {
        return tl::unexpected(roots.error());
    }

    // Depth first with a stack of our own, because a file may chain nodes deeper than the program's stack.
    struct Pending {
        int node;
        glm::dmat4 world_from_parent;
    };
    std::vector<Pending> stack;
    const auto push = [&stack](const std::vector<int>& nodes, const glm::dmat4& world_from_parent) {
        for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) {
            stack.push_back({*node, world_from_parent});
        }
    };
    std::vector<bool> reached(model.nodes.size(), false);
    std::vector<PlacedNode> placed;
    push(*roots, glm::dmat4(1.0));
    while (!stack.empty()) {
        const Pending next = stack.back();
        stack.pop_back();
        if (!gltf_index_ok(next.node, model.nodes.size())) {
            return tl::unexpected(Error{"there is no node " + std::to_string(next.node)});
        }
        const auto index = static_cast<std::size_t>(next.node);
        if (reached[index]) {
            return tl::unexpected(Error{node_label(model, index) + " is below itself or has two parents"});
        }
        reached[index] = true;
        const auto local = local_transform(model.nodes[index]);
        if (!local) {
            return tl::unexpected(
                Error{node_label(model, index) + " has a matrix, translation, rotation or scale of a wrong length"});
        }
        const glm::dmat4 world_from_node = next.world_from_parent * *local;
        if (!in_range(world_from_node)) {
            return tl::unexpected(
                Error{node_label(model, index) + " has a transform that leaves the range of numbers"});
        }
        placed.push_back({index, world_from_node});
        push(model.nodes[index].children, world_from_node);
    }
    return placed;
}

} // namespace tyndall::engine
