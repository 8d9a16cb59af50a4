#include "engine/gltf_value.hpp"

namespace tyndall::engine {
namespace {

template <typename Vector>
Vector vector_or(const tinygltf::Value* value, const Vector& fallback) {
    constexpr int length = Vector::length();
    if (value == nullptr || value->ArrayLen() != static_cast<std::size_t>(length)) {
        return fallback;
    }
    Vector result;
    for (int i = 0; i < length; ++i) {
        const tinygltf::Value& item = value->Get(i);
        if (!item.IsNumber()) {
            return fallback;
        }
        result[i] = item.GetNumberAsDouble();
    }
    return result;
}

} // namespace

const tinygltf::Value* find_extension(const tinygltf::ExtensionMap& extensions, const char* name) {
    const auto found = extensions.find(name);
    return found == extensions.end() ? nullptr : &found->second;
}

const tinygltf::Value* find_member(const tinygltf::Value* object, const char* name) {
    return object != nullptr && object->Has(name) ? &object->Get(name) : nullptr;
}

double number_or(const tinygltf::Value* value, double fallback) {
    return value != nullptr && value->IsNumber() ? value->GetNumberAsDouble() : fallback;
}

int integer_or(const tinygltf::Value* value, int fallback) {
    return value != nullptr && value->IsInt() ? value->GetNumberAsInt() : fallback;
}

glm::dvec2 vec2_or(const tinygltf::Value* value, const glm::dvec2& fallback) {
    return vector_or(value, fallback);
}
glm::dvec3 vec3_or(const tinygltf::Value* value, const glm::dvec3& fallback) {
    return vector_or(value, fallback);
}
glm::dvec4 vec4_or(const tinygltf::Value* value, const glm::dvec4& fallback) {
    return vector_or(value, fallback);
}

} // namespace tyndall::engine
