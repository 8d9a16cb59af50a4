#include "engine/gltf.hpp"

#include <exception>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/bounds.hpp"
#include "engine/gltf_document.hpp"
#include "engine/gltf_geometry.hpp"
#include "engine/gltf_materials.hpp"
#include "engine/gltf_nodes.hpp"
#include "engine/gltf_punctual.hpp"
#include "engine/scene_defaults.hpp"

namespace tyndall::engine {
namespace {

/// Where in the whole load each stage begins; images take most of the time of most files.
constexpr double materials_start = 0.2;
constexpr double nodes_start = 0.8;

/// A primitive of the scene with its bounds in object space.
struct LoadedPrimitive {
    std::uint32_t index;
    Bounds bounds;
};

/// Primitives of the meshes read so far: a mesh that many nodes show is read once.
using LoadedMeshes = std::vector<std::optional<std::vector<LoadedPrimitive>>>;

tl::expected<void, Error> load_mesh(const GltfDocument& document, std::size_t mesh, LoadedMeshes& meshes,
                                    Scene& scene) {
    meshes[mesh].emplace();
    for (std::size_t i = 0; i < document.model.meshes[mesh].primitives.size(); ++i) {
        auto primitive = read_gltf_primitive(document, mesh, i, scene.materials, scene.notes);
        if (!primitive) {
            return tl::unexpected(std::move(primitive.error()));
        }
        if (*primitive) {
            const auto index = static_cast<std::uint32_t>(scene.primitives.size());
            meshes[mesh]->push_back({index, bounds_of(**primitive)});
            scene.primitives.push_back(std::move(**primitive));
        }
    }
    return {};
}

tl::expected<void, Error> add_instances(const GltfDocument& document, const PlacedNode& placed, int mesh,
                                        LoadedMeshes& meshes, Scene& scene) {
    if (!gltf_index_ok(mesh, meshes.size())) {
        return tl::unexpected(Error{"there is no mesh " + std::to_string(mesh)});
    }
    const auto index = static_cast<std::size_t>(mesh);
    if (!meshes[index]) {
        if (auto loaded = load_mesh(document, index, meshes, scene); !loaded) {
            return loaded;
        }
    }
    for (const LoadedPrimitive& primitive : *meshes[index]) {
        Instance instance;
        instance.primitive = primitive.index;
        instance.world_from_object = placed.world_from_node;
        instance.mirrored = glm::determinant(glm::dmat3(placed.world_from_node)) < 0.0;
        instance.box = transformed(primitive.bounds.box, placed.world_from_node);
        instance.sphere = transformed(primitive.bounds.sphere, placed.world_from_node);
        scene.bounds.grow(instance.box);
        scene.instances.push_back(instance);
    }
    return {};
}

tl::expected<void, Error> add_node(const GltfDocument& document, const PlacedNode& placed, LoadedMeshes& meshes,
                                   Scene& scene) {
    const tinygltf::Node& node = document.model.nodes[placed.node];
    if (node.camera >= 0) {
        auto camera = read_gltf_camera(document, node.camera, placed.world_from_node);
        if (!camera) {
            return tl::unexpected(std::move(camera.error()));
        }
        if (camera->name.empty()) {
            camera->name = node.name;
        }
        scene.cameras.push_back(std::move(*camera));
    }
    auto light = read_gltf_light(document, placed.node, placed.world_from_node, scene.notes);
    if (!light) {
        return tl::unexpected(std::move(light.error()));
    }
    if (*light) {
        if ((*light)->name.empty()) {
            (*light)->name = node.name;
        }
        scene.lights.push_back(std::move(**light));
    }
    if (node.mesh < 0) {
        return {};
    }
    if (node.skin >= 0) {
        add_note(scene.notes, "Skins are left out: skinned meshes stand in their bind pose as their nodes say.");
    }
    return add_instances(document, placed, node.mesh, meshes, scene);
}

tl::expected<Scene, Error> load(const std::filesystem::path& path, const LoadProgress& progress) {
    const auto report = [&progress](std::string_view stage, double fraction) {
        if (progress) {
            progress(stage, fraction);
        }
    };
    Scene scene;

    report("reading the file", 0.0);
    const auto document = read_gltf_document(path, scene.notes);
    if (!document) {
        return tl::unexpected(document.error());
    }

    report("decoding images", materials_start);
    auto materials = read_gltf_materials(*document, scene.notes, [&](std::size_t done, std::size_t count) {
        const double part = static_cast<double>(done) / static_cast<double>(count);
        report("decoding images", materials_start + part * (nodes_start - materials_start));
    });
    if (!materials) {
        return tl::unexpected(std::move(materials.error()));
    }
    scene.materials = std::move(materials->materials);
    scene.textures = std::move(materials->textures);
    scene.images = std::move(materials->images);

    report("placing meshes", nodes_start);
    const auto nodes = place_gltf_nodes(*document);
    if (!nodes) {
        return tl::unexpected(nodes.error());
    }
    LoadedMeshes meshes(document->model.meshes.size());
    for (std::size_t i = 0; i < nodes->size(); ++i) {
        if (auto added = add_node(*document, (*nodes)[i], meshes, scene); !added) {
            return tl::unexpected(std::move(added.error()));
        }
        report("placing meshes",
               nodes_start + (1.0 - nodes_start) * static_cast<double>(i + 1) / static_cast<double>(nodes->size()));
    }
    if (scene.instances.empty()) {
        add_note(scene.notes, "The scene shows no triangle.");
    }
    complete_scene(scene);
    report("loaded", 1.0);
    return scene;
}

} // namespace

tl::expected<Scene, Error> load_gltf(const std::filesystem::path& path, const LoadProgress& progress) {
    const auto named = [&path](const std::string& what) { return Error{path.string() + ": " + what + "."}; };
    // The libraries below us throw on what a hostile file makes them allocate; here it becomes an error like any other.
    try {
        return load(path, progress).map_error([&](const Error& error) { return named(error.message); });
    } catch (const std::bad_alloc&) {
        return tl::unexpected(named("it needs more memory than there is"));
    } catch (const std::exception& exception) {
        return tl::unexpected(named(std::string("it cannot be loaded: ") + exception.what()));
    }
}

} // namespace tyndall::engine
