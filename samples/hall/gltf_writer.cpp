#include "samples/hall/gltf_writer.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <type_traits>
#include <vector>

#include <nlohmann/json.hpp>

namespace tyndall::hall {
namespace {

// Keeps the order of insertion, and prints a float with as few digits as bring it back.
using Json =
    nlohmann::basic_json<nlohmann::ordered_map, std::vector, std::string, bool, std::int64_t, std::uint64_t, float>;

// Values of the glTF 2.0 specification.
constexpr int component_u16 = 5123;
constexpr int component_u32 = 5125;
constexpr int component_f32 = 5126;
constexpr int target_vertices = 34962;
constexpr int target_indices = 34963;

template <glm::length_t count>
Json to_json(const glm::vec<count, float>& v) {
    Json array = Json::array();
    for (glm::length_t i = 0; i < count; ++i) {
        array.push_back(v[i]);
    }
    return array;
}

/// Collects the binary buffer and the views and accessors into it.
class BufferBuilder {
public:
    template <typename T>
    std::size_t add(const std::vector<T>& values, int component_type, const char* type, int target) {
        static_assert(std::is_trivially_copyable_v<T>);
        const std::size_t offset = bytes_.size();
        const std::size_t length = values.size() * sizeof(T);
        bytes_.resize(offset + (length + 3) / 4 * 4); // every view starts on four bytes
        std::memcpy(bytes_.data() + offset, values.data(), length);
        views_.push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", length}, {"target", target}});
        accessors_.push_back({{"bufferView", views_.size() - 1},
                              {"componentType", component_type},
                              {"count", values.size()},
                              {"type", type}});
        return accessors_.size() - 1;
    }

    std::size_t add_positions(const std::vector<glm::vec3>& positions) {
        const std::size_t accessor = add(positions, component_f32, "VEC3", target_vertices);
        glm::vec3 low{std::numeric_limits<float>::max()};
        glm::vec3 high{std::numeric_limits<float>::lowest()};
        for (const glm::vec3 position : positions) {
            low = glm::min(low, position);
            high = glm::max(high, position);
        }
        accessors_[accessor]["min"] = to_json(low);
        accessors_[accessor]["max"] = to_json(high);
        return accessor;
    }

    [[nodiscard]] const std::vector<char>& bytes() const { return bytes_; }
    [[nodiscard]] const Json& views() const { return views_; }
    [[nodiscard]] const Json& accessors() const { return accessors_; }

private:
    std::vector<char> bytes_;
    Json views_ = Json::array();
    Json accessors_ = Json::array();
};

Json write_primitive(BufferBuilder& buffer, const Part& part, const Material& material) {
    Geometry geometry = part.geometry;
    if (material.normal_texture) {
        compute_tangents(geometry);
    }
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;
    std::vector<glm::vec2> uvs;
    std::vector<glm::vec4> tangents;
    for (const Vertex& vertex : geometry.vertices) {
        positions.push_back(vertex.position);
        normals.push_back(vertex.normal);
        uvs.push_back(vertex.uv / material.tile_size_m);
        tangents.push_back(vertex.tangent);
    }
    Json attributes{{"POSITION", buffer.add_positions(positions)},
                    {"NORMAL", buffer.add(normals, component_f32, "VEC3", target_vertices)},
                    {"TEXCOORD_0", buffer.add(uvs, component_f32, "VEC2", target_vertices)}};
    if (material.normal_texture) {
        attributes["TANGENT"] = buffer.add(tangents, component_f32, "VEC4", target_vertices);
    }
    Json primitive{{"attributes", attributes}, {"material", part.material}};
    if (positions.size() <= std::numeric_limits<std::uint16_t>::max()) {
        const std::vector<std::uint16_t> narrow(geometry.indices.begin(), geometry.indices.end());
        primitive["indices"] = buffer.add(narrow, component_u16, "SCALAR", target_indices);
    } else {
        primitive["indices"] = buffer.add(geometry.indices, component_u32, "SCALAR", target_indices);
    }
    return primitive;
}

Json write_material(const Material& material) {
    Json surface{{"baseColorFactor", to_json(material.base_color)},
                 {"metallicFactor", material.metallic},
                 {"roughnessFactor", material.roughness}};
    if (material.base_texture) {
        surface["baseColorTexture"] = {{"index", *material.base_texture}};
    }
    Json json{{"name", material.name}};
    if (material.surface_texture) {
        surface["metallicRoughnessTexture"] = {{"index", *material.surface_texture}};
        json["occlusionTexture"] = {{"index", *material.surface_texture}};
    }
    json["pbrMetallicRoughness"] = surface;
    if (material.normal_texture) {
        json["normalTexture"] = {{"index", *material.normal_texture}};
    }
    if (material.emissive_color != glm::vec3{0.0F}) {
        json["emissiveFactor"] = to_json(material.emissive_color);
        json["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", material.emissive_strength}};
        if (material.emissive_texture) {
            json["emissiveTexture"] = {{"index", *material.emissive_texture}};
        }
    }
    if (material.alpha_mode == AlphaMode::mask) {
        json["alphaMode"] = "MASK";
        json["alphaCutoff"] = material.alpha_cutoff;
    } else if (material.alpha_mode == AlphaMode::blend) {
        json["alphaMode"] = "BLEND";
    }
    if (material.double_sided) {
        json["doubleSided"] = true;
    }
    return json;
}

Json write_light(const Light& light) {
    Json json{{"name", light.name}, {"color", to_json(light.color)}, {"intensity", light.intensity}};
    switch (light.kind) {
    case LightKind::directional: json["type"] = "directional"; return json;
    case LightKind::point: json["type"] = "point"; break;
    case LightKind::spot:
        json["type"] = "spot";
        json["spot"] = {{"innerConeAngle", light.inner_cone_rad}, {"outerConeAngle", light.outer_cone_rad}};
        break;
    }
    json["range"] = light.range_m;
    return json;
}

Json write_node(const Node& node) {
    Json json{{"name", node.name}};
    if (node.translation != glm::vec3{0.0F}) {
        json["translation"] = to_json(node.translation);
    }
    if (node.rotation != glm::quat{1.0F, 0.0F, 0.0F, 0.0F}) {
        json["rotation"] = to_json(glm::vec4{node.rotation.x, node.rotation.y, node.rotation.z, node.rotation.w});
    }
    if (node.scale != 1.0F) {
        json["scale"] = to_json(glm::vec3{node.scale});
    }
    if (node.mesh) {
        json["mesh"] = *node.mesh;
    }
    if (node.camera) {
        json["camera"] = *node.camera;
    }
    if (node.light) {
        json["extensions"]["KHR_lights_punctual"] = {{"light", *node.light}};
    }
    return json;
}

Json write_meshes(BufferBuilder& buffer, const Scene& scene) {
    Json meshes = Json::array();
    for (const Mesh& mesh : scene.meshes) {
        Json primitives = Json::array();
        for (const Part& part : mesh.parts) {
            primitives.push_back(write_primitive(buffer, part, scene.materials[part.material]));
        }
        meshes.push_back({{"name", mesh.name}, {"primitives", primitives}});
    }
    return meshes;
}

template <typename Item, typename Convert>
Json write_each(const std::vector<Item>& items, const Convert& convert) {
    Json array = Json::array();
    for (const Item& item : items) {
        array.push_back(convert(item));
    }
    return array;
}

} // namespace

tl::expected<void, std::string> write_text(const std::filesystem::path& path, const std::string& text) {
    std::ofstream file(path, std::ios::binary);
    file << text;
    file.close();
    if (!file) {
        return tl::unexpected("cannot write the file " + path.string());
    }
    return {};
}

tl::expected<void, std::string> write_gltf(const Scene& scene, const std::filesystem::path& folder,
                                           const std::string& name) {
    BufferBuilder buffer;
    Json gltf{{"asset", {{"version", "2.0"}, {"generator", "tyndall generate_hall"}}}};
    gltf["extensionsUsed"] = {"KHR_lights_punctual", "KHR_materials_emissive_strength"};
    gltf["extensions"]["KHR_lights_punctual"]["lights"] = write_each(scene.lights, write_light);
    gltf["scene"] = 0;
    Json roots = Json::array();
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        roots.push_back(i);
    }
    gltf["scenes"] = Json::array({{{"name", name}, {"nodes", roots}}});
    gltf["nodes"] = write_each(scene.nodes, write_node);
    gltf["cameras"] = write_each(scene.cameras, [](const Camera& camera) {
        return Json{{"name", camera.name},
                    {"type", "perspective"},
                    {"perspective",
                     {{"aspectRatio", 16.0F / 9.0F},
                      {"yfov", camera.vertical_field_of_view_rad},
                      {"znear", camera.near_m},
                      {"zfar", camera.far_m}}}};
    });
    gltf["meshes"] = write_meshes(buffer, scene);
    gltf["materials"] = write_each(scene.materials, write_material);
    gltf["samplers"] = Json::array({{{"magFilter", 9729}, {"minFilter", 9987}, {"wrapS", 10497}, {"wrapT", 10497}}});
    Json textures = Json::array();
    for (std::size_t i = 0; i < scene.textures.size(); ++i) {
        textures.push_back({{"sampler", 0}, {"source", i}});
    }
    gltf["textures"] = textures;
    gltf["images"] = write_each(scene.textures, [](const Texture& texture) {
        return Json{{"uri", texture.file_name}};
    });
    gltf["accessors"] = buffer.accessors();
    gltf["bufferViews"] = buffer.views();
    gltf["buffers"] = Json::array({{{"uri", name + ".bin"}, {"byteLength", buffer.bytes().size()}}});

    for (const Texture& texture : scene.textures) {
        if (auto written = texture.image.write_png(folder / texture.file_name); !written) {
            return written;
        }
    }
    const std::string binary(buffer.bytes().begin(), buffer.bytes().end());
    if (auto written = write_text(folder / (name + ".bin"), binary); !written) {
        return written;
    }
    return write_text(folder / (name + ".gltf"), gltf.dump(1) + "\n");
}

} // namespace tyndall::hall
