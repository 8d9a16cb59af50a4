#pragma once

#include <filesystem>
#include <string>

#include <tl/expected.hpp>

#include "samples/hall/scene.hpp"

namespace tyndall::hall {

/// Writes `<name>.gltf`, `<name>.bin` and the textures beside them (glTF 2.0 with KHR_lights_punctual and
/// KHR_materials_emissive_strength). The folder must exist. Tangents are written where a material has a normal texture,
/// and texture coordinates are divided by the tile size of the material. The error is one sentence that names the file.
[[nodiscard]] tl::expected<void, std::string> write_gltf(const Scene& scene, const std::filesystem::path& folder,
                                                         const std::string& name);

/// Writes text to a file; the error names the path.
[[nodiscard]] tl::expected<void, std::string> write_text(const std::filesystem::path& path, const std::string& text);

} // namespace tyndall::hall
