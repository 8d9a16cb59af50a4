// Cameras and punctual lights of a glTF file, placed in the world.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <tl/expected.hpp>

#include "engine/gltf_document.hpp"
#include "engine/scene.hpp"

namespace tyndall::engine {

/// Rotation and translation of `transform`: scale, shear and mirroring are taken out, -Z and the side of +Y are kept.
[[nodiscard]] glm::dmat4 rigid(const glm::dmat4& transform);

/// Camera `index` of the file. Errors: no such camera, an impossible projection.
[[nodiscard]] tl::expected<Camera, Error> read_gltf_camera(const GltfDocument& document, int index,
                                                           const glm::dmat4& world_from_node);

/// The light that KHR_lights_punctual puts on node `index`, if any. Intensity, cone and range outside of their domains
/// are brought back into them with a note. Of the light's "extras" are read: "shadow", whether it casts one, and
/// "shadow_near_m", within which nothing does. Errors: no such light, an unknown type.
[[nodiscard]] tl::expected<std::optional<Light>, Error> read_gltf_light(const GltfDocument& document, std::size_t node,
                                                                        const glm::dmat4& world_from_node,
                                                                        std::vector<std::string>& notes);

} // namespace tyndall::engine
