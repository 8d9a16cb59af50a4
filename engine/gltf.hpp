// Reads a glTF 2.0 file (.gltf or .glb) into a Scene.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

#include <tl/expected.hpp>

#include "engine/error.hpp"
#include "engine/scene.hpp"

namespace tyndall::engine {

/// Told what is being done and how much of the whole load is over, in [0, 1], never falling.
using LoadProgress = std::function<void(std::string_view stage, double fraction)>;

/// Loads the file's default scene (else its first one, else every root node).
///
/// Supported beyond glTF 2.0 core: KHR_lights_punctual, KHR_materials_unlit, KHR_materials_specular,
/// KHR_materials_emissive_strength, KHR_texture_transform, KHR_mesh_quantization, and
/// KHR_materials_pbrSpecularGlossiness by conversion. What the file asks for and this reader leaves out (optional
/// extensions, animation, skinning, morph targets, points and lines) is told in Scene::notes, and so are a camera and a
/// sun made for a file that has none.
///
/// Errors, each one sentence that starts with `path`: a file that is missing or broken anywhere that the scene uses, a
/// required extension that is not known, a version other than 2. Never throws.
[[nodiscard]] tl::expected<Scene, Error> load_gltf(const std::filesystem::path& path,
                                                   const LoadProgress& progress = {});

} // namespace tyndall::engine
