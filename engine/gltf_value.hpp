// Reading the JSON values of glTF extensions, which tinygltf hands over as they stand.
#pragma once

#include <string>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <tiny_gltf.h>

namespace tyndall::engine {

/// The named extension, or null.
[[nodiscard]] const tinygltf::Value* find_extension(const tinygltf::ExtensionMap& extensions, const char* name);

/// The member, or null. `object` may be null or anything but an object: then null.
[[nodiscard]] const tinygltf::Value* find_member(const tinygltf::Value* object, const char* name);

/// The value as it stands in the file if it is there and has the right type and length, else `fallback`.
[[nodiscard]] double number_or(const tinygltf::Value* value, double fallback);
[[nodiscard]] int integer_or(const tinygltf::Value* value, int fallback);
[[nodiscard]] glm::dvec2 vec2_or(const tinygltf::Value* value, const glm::dvec2& fallback);
[[nodiscard]] glm::dvec3 vec3_or(const tinygltf::Value* value, const glm::dvec3& fallback);
[[nodiscard]] glm::dvec4 vec4_or(const tinygltf::Value* value, const glm::dvec4& fallback);

} // namespace tyndall::engine
