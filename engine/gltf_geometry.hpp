// One mesh primitive of a glTF file as indexed triangles.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "engine/gltf_document.hpp"
#include "engine/scene.hpp"

namespace tyndall::engine {

/// Converts primitive `primitive` of mesh `mesh`. Strips and fans become lists, normals and tangents that are missing
/// are made. `materials` are those of read_gltf_materials: the last one is the default. Nothing, and a note, for
/// points, lines and primitives without a triangle. Errors name the mesh, the primitive and what is wrong in it.
[[nodiscard]] tl::expected<std::optional<Primitive>, Error> read_gltf_primitive(const GltfDocument& document,
                                                                                std::size_t mesh, std::size_t primitive,
                                                                                const std::vector<Material>& materials,
                                                                                std::vector<std::string>& notes);

} // namespace tyndall::engine
