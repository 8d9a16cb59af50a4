// A glTF file with its fog as a scene of the precision study.
#pragma once

#include <filesystem>
#include <string>

#include <tl/expected.hpp>

#include "samples/precision/scene.hpp"

namespace tyndall::samples {

/// The file's first camera, lights and opaque surfaces, made Lambertian (no metal, no specular reflection, no baked
/// occlusion), in the fog of `<scene>.fog.json` beside it. What is blended or cut out by alpha is left out, of the
/// picture as of the truth. Point lights cast no shadows, for they stand within the flames that they light; spots do.
/// The error is one sentence.
[[nodiscard]] tl::expected<PrecisionScene, std::string> load_precision_scene(const std::filesystem::path& path);

} // namespace tyndall::samples
