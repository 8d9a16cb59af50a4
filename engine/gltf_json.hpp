// The JSON of a glTF file, checked for what tinygltf would misread in silence, crash on or cut short.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <tl/expected.hpp>

#include "engine/error.hpp"

namespace tyndall::engine {

/// Parses and checks: the root is an object, the version is 2, every required extension is known, well-known keys have
/// their type, integers fit 32 bits where indices stand, nesting is shallow. Takes out "animations", and "extras" but
/// for what is read of those of lights and materials (gltf_punctual.hpp, gltf_materials.hpp). Appends a note on
/// animations and on each optional extension that is left out. Errors are one sentence without the file's name.
[[nodiscard]] tl::expected<nlohmann::json, Error> parse_gltf_json(const std::string& text,
                                                                  std::vector<std::string>& notes);

} // namespace tyndall::engine
