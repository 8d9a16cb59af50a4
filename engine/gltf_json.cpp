#include "engine/gltf_json.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include <nlohmann/json.hpp>

namespace tyndall::engine {
namespace {

using nlohmann::json;

/// Deeper than any glTF property; what lies deeper would only exhaust the stack of whoever walks it.
constexpr int depth_limit = 48;

constexpr std::array<std::string_view, 7> known_extensions{
    "KHR_lights_punctual",
    "KHR_materials_unlit",
    "KHR_materials_specular",
    "KHR_materials_emissive_strength",
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    "KHR_materials_pbrSpecularGlossiness",
};

bool is_known(std::string_view extension) {
    return std::find(known_extensions.begin(), known_extensions.end(), extension) != known_extensions.end();
}

enum class Kind : std::uint8_t {
    integer,
    size,
    number,
    boolean,
    text,
    object,
    objects,
    integers,
    numbers,
    attributes,
    integer_or_object
};

struct KeyKind {
    std::string_view key;
    Kind kind;
};

/// Keys whose type is the same wherever glTF 2.0 has them (sections 5.1 to 5.29), outside of extensions.
constexpr std::array<KeyKind, 51> key_kinds{{
    {"accessors", Kind::objects},
    {"alphaCutoff", Kind::number},
    {"alphaMode", Kind::text},
    {"attributes", Kind::attributes},
    {"baseColorFactor", Kind::numbers},
    {"baseColorTexture", Kind::object},
    {"buffer", Kind::integer},
    {"bufferView", Kind::integer},
    {"bufferViews", Kind::objects},
    {"buffers", Kind::objects},
    {"byteLength", Kind::size},
    {"byteOffset", Kind::size},
    {"byteStride", Kind::size},
    {"camera", Kind::integer},
    {"cameras", Kind::objects},
    {"children", Kind::integers},
    {"componentType", Kind::integer},
    {"count", Kind::size},
    {"doubleSided", Kind::boolean},
    {"emissiveFactor", Kind::numbers},
    {"emissiveTexture", Kind::object},
    {"extensions", Kind::object},
    {"images", Kind::objects},
    {"index", Kind::integer},
    {"indices", Kind::integer_or_object},
    {"magFilter", Kind::integer},
    {"material", Kind::integer},
    {"materials", Kind::objects},
    {"matrix", Kind::numbers},
    {"mesh", Kind::integer},
    {"meshes", Kind::objects},
    {"metallicFactor", Kind::number},
    {"metallicRoughnessTexture", Kind::object},
    {"minFilter", Kind::integer},
    {"mode", Kind::integer},
    {"name", Kind::text},
    {"normalTexture", Kind::object},
    {"normalized", Kind::boolean},
    {"occlusionTexture", Kind::object},
    {"pbrMetallicRoughness", Kind::object},
    {"primitives", Kind::objects},
    {"roughnessFactor", Kind::number},
    {"sampler", Kind::integer},
    {"scene", Kind::integer},
    {"scenes", Kind::objects},
    {"skin", Kind::integer},
    {"source", Kind::integer},
    {"sparse", Kind::object},
    {"texCoord", Kind::integer},
    {"translation", Kind::numbers},
    {"uri", Kind::text},
}};

std::string_view in_words(Kind kind) {
    switch (kind) {
    case Kind::integer: return "a non-negative integer of 32 bits";
    case Kind::size: return "a non-negative integer";
    case Kind::number: return "a number";
    case Kind::boolean: return "true or false";
    case Kind::text: return "a string";
    case Kind::object: return "an object";
    case Kind::objects: return "a list of objects";
    case Kind::integers: return "a list of non-negative integers";
    case Kind::numbers: return "a list of numbers";
    case Kind::attributes: return "an object of non-negative integers";
    case Kind::integer_or_object: return "a non-negative integer or an object";
    }
    return "";
}

bool is_index(const json& value) {
    return value.is_number_unsigned() && value <= std::numeric_limits<std::int32_t>::max();
}

bool has_kind(const json& value, Kind kind) {
    const auto all = [&](auto predicate) {
        return value.is_array() && std::all_of(value.begin(), value.end(), predicate);
    };
    switch (kind) {
    case Kind::integer: return is_index(value);
    case Kind::size: return value.is_number_unsigned();
    case Kind::number: return value.is_number();
    case Kind::boolean: return value.is_boolean();
    case Kind::text: return value.is_string();
    case Kind::object: return value.is_object();
    case Kind::objects: return all([](const json& item) { return item.is_object(); });
    case Kind::integers: return all(is_index);
    case Kind::numbers: return all([](const json& item) { return item.is_number(); });
    case Kind::attributes: return value.is_object() && std::all_of(value.begin(), value.end(), is_index);
    case Kind::integer_or_object: return is_index(value) || value.is_object();
    }
    return false;
}

/// What is read of the "extras" of the object at `path`: by gltf_punctual.cpp of a light, by gltf_materials.cpp of a
/// material.
std::vector<std::string_view> read_extras(std::string_view path) {
    constexpr std::string_view lights = "/extensions/KHR_lights_punctual/lights/";
    constexpr std::string_view materials = "/materials/";
    if (path.starts_with(lights)) {
        return {"shadow", "shadow_near_m"};
    }
    if (path.starts_with(materials) && path.find('/', materials.size()) == std::string_view::npos) {
        return {"blend"};
    }
    return {};
}

/// "extras" belong to whoever wrote the file: only what is read of them is kept, and that unless it is a list or an
/// object.
void reduce_extras(json& value, const std::string& path) {
    const auto extras = value.find("extras");
    if (extras == value.end()) {
        return;
    }
    json kept = json::object();
    if (extras->is_object()) {
        for (const std::string_view key : read_extras(path)) {
            const auto found = extras->find(key);
            if (found != extras->end() && found->is_primitive()) {
                kept[key] = *found;
            }
        }
    }
    if (kept.empty()) {
        value.erase(extras);
    } else {
        *extras = std::move(kept);
    }
}

/// Checks one object or array and all below it, and removes "extras" on the way but for what is read of them. `path`
/// names it as a JSON pointer does.
std::optional<Error> check(json& value, const std::string& path, int depth, bool in_extension) {
    if (depth > depth_limit) {
        return Error{"its JSON is nested more than " + std::to_string(depth_limit) + " deep"};
    }
    if (value.is_array()) {
        for (std::size_t i = 0; i < value.size(); ++i) {
            if (auto error = check(value[i], path + "/" + std::to_string(i), depth + 1, in_extension)) {
                return error;
            }
        }
        return std::nullopt;
    }
    if (!value.is_object()) {
        return std::nullopt;
    }
    reduce_extras(value, path);
    for (auto& [key, child] : value.items()) {
        std::string child_path = path;
        child_path.append("/").append(key);
        const auto* known = std::find_if(key_kinds.begin(), key_kinds.end(),
                                         [&key = key](const KeyKind& entry) { return entry.key == key; });
        if (!in_extension && known != key_kinds.end() && !has_kind(child, known->kind)) {
            return Error{"'" + child_path + "' should be " + std::string(in_words(known->kind))};
        }
        if (auto error = check(child, child_path, depth + 1, in_extension || key == "extensions")) {
            return error;
        }
    }
    return std::nullopt;
}

std::optional<Error> check_version(const json& root) {
    const auto asset = root.find("asset");
    const bool found = asset != root.end() && asset->is_object() && asset->contains("version");
    if (!found || !(*asset)["version"].is_string()) {
        return Error{"it has no asset.version, so it is not glTF 2"};
    }
    const auto version = (*asset)["version"].get<std::string>();
    if (!version.starts_with("2.")) {
        return Error{"it is glTF " + version + ", only glTF 2 is read"};
    }
    return std::nullopt;
}

/// Which of `list` are not known, in the file's order. Anything but a list of strings is an error.
tl::expected<std::vector<std::string>, Error> unknown_extensions(const json& root, const char* list) {
    std::vector<std::string> unknown;
    const auto found = root.find(list);
    if (found == root.end()) {
        return unknown;
    }
    const bool strings = found->is_array() &&
                         std::all_of(found->begin(), found->end(), [](const json& item) { return item.is_string(); });
    if (!strings) {
        return tl::unexpected(Error{"'/" + std::string(list) + "' should be a list of strings"});
    }
    for (const json& item : *found) {
        const auto& name = item.get_ref<const std::string&>();
        if (!is_known(name)) {
            unknown.push_back(name);
        }
    }
    return unknown;
}

} // namespace

tl::expected<json, Error> parse_gltf_json(const std::string& text, std::vector<std::string>& notes) {
    json root;
    try {
        root = json::parse(text);
    } catch (const json::parse_error& error) {
        return tl::unexpected(Error{"its JSON is broken at byte " + std::to_string(error.byte)});
    } catch (const json::exception&) {
        return tl::unexpected(Error{"its JSON holds a number too large to represent"});
    }
    if (!root.is_object()) {
        return tl::unexpected(Error{"its JSON is not an object"});
    }
    if (auto error = check_version(root)) {
        return tl::unexpected(std::move(*error));
    }

    const auto required = unknown_extensions(root, "extensionsRequired");
    const auto used = unknown_extensions(root, "extensionsUsed");
    if (!required || !used) {
        return tl::unexpected(required ? used.error() : required.error());
    }
    if (!required->empty()) {
        return tl::unexpected(Error{"it requires the extension " + required->front() + ", which is not supported"});
    }
    for (const std::string& name : *used) {
        notes.push_back("The optional extension " + name + " is not supported and left out.");
    }

    if (const auto animations = root.find("animations"); animations != root.end()) {
        if (!animations->empty()) {
            notes.push_back("Animations are left out: everything stands as its nodes say.");
        }
        root.erase(animations);
    }
    if (auto error = check(root, "", 0, false)) {
        return tl::unexpected(std::move(*error));
    }
    return root;
}

} // namespace tyndall::engine
