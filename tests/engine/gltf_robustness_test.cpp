// Binary containers, files damaged at random, and the models of Debian's assimp-testmodels: none crashes or throws.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/engine/gltf_fixture.hpp"

namespace tyndall::engine::test {
namespace {

void append_u32(std::string& text, std::size_t value) {
    for (int shift = 0; shift < 32; shift += 8) {
        text.push_back(static_cast<char>((value >> shift) & 0xFFU));
    }
}

void append_chunk(std::string& text, const char* type, std::string data, char padding) {
    while (data.size() % 4 != 0) {
        data.push_back(padding);
    }
    append_u32(text, data.size());
    text.append(type, 4);
    text += data;
}

/// The file as .glb, its bytes in the binary chunk.
std::string to_glb(const GltfFile& file) {
    json root = file.root;
    root["buffers"] = json::array({{{"byteLength", file.bytes.size()}}});
    std::string chunks;
    append_chunk(chunks, "JSON", root.dump(), ' ');
    append_chunk(chunks, "BIN\0", std::string(file.bytes.begin(), file.bytes.end()), '\0');
    std::string glb = "glTF";
    append_u32(glb, 2);
    append_u32(glb, 12 + chunks.size());
    return glb + chunks;
}

/// A file that uses most of what is read, so that damage finds something to hit.
GltfFile rich_file() {
    GltfFile file;
    const json texture = {
        {"index", 0}, {"texCoord", 1}, {"extensions", {{"KHR_texture_transform", {{"rotation", 0.5}}}}}};
    file.add_triangle({{"pbrMetallicRoughness", {{"baseColorTexture", texture}, {"metallicFactor", 0.5}}},
                       {"normalTexture", texture},
                       {"alphaMode", "MASK"},
                       {"extensions", {{"KHR_materials_specular", {{"specularTexture", texture}}}}}});
    json& attributes = file.root["meshes"][0]["primitives"][0]["attributes"];
    attributes["TEXCOORD_1"] =
        file.add_accessor(std::vector<std::uint16_t>{0, 0, 65535, 0, 0, 65535}, "VEC2", type_unsigned_short, true);
    attributes["NORMAL"] = file.add_accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", type_float);
    file.root["meshes"][0]["primitives"][0]["indices"] =
        file.add_accessor(std::vector<std::uint8_t>{0, 1, 2}, "SCALAR", type_unsigned_byte);
    const int sparse_indices = file.add_view(std::vector<std::uint8_t>{1});
    const int sparse_values = file.add_view(std::vector<float>{2, 0, 0});
    file.root["accessors"][0]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", sparse_indices}, {"byteOffset", 0}, {"componentType", type_unsigned_byte}}},
        {"values", {{"bufferView", sparse_values}, {"byteOffset", 0}}}};
    file.add("images", {{"bufferView", file.add_view(one_pixel_png(1, 2, 3, 4))}, {"mimeType", "image/png"}});
    file.add("samplers", {{"minFilter", 9987}, {"wrapS", 33071}});
    file.add("textures", {{"source", 0}, {"sampler", 0}});
    file.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.25}}}});
    file.root["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "spot"}, {"range", 5}, {"spot", {{"innerConeAngle", 0.2}}}}};
    file.add("nodes", {{"camera", 0},
                       {"children", {0}},
                       {"rotation", {0, 0, 0, 1}},
                       {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    file.root["scenes"] = json::parse(R"([{"nodes":[1]}])");
    file.root["scene"] = 0;
    return file;
}

bool all_finite(const Scene& scene) {
    const auto finite = [](double value) { return std::isfinite(value); };
    for (const Primitive& primitive : scene.primitives) {
        for (std::size_t i = 0; i < primitive.positions.size(); ++i) {
            const glm::dvec3 sum = glm::dvec3(primitive.positions[i]) + glm::dvec3(primitive.normals[i]) +
                                   glm::dvec3(primitive.tangents[i]) + glm::dvec3(primitive.uv0[i], primitive.uv1[i].x);
            if (!finite(sum.x + sum.y + sum.z + static_cast<double>(primitive.uv1[i].y))) {
                return false;
            }
        }
    }
    return std::all_of(scene.instances.begin(), scene.instances.end(), [&](const Instance& instance) {
        const glm::dvec3 sum = instance.box.min + instance.box.max + instance.sphere.center;
        return finite(sum.x + sum.y + sum.z + instance.sphere.radius_m);
    });
}

/// What every reader of a Scene relies on.
void expect_sound(const Scene& scene, const std::string& what) {
    EXPECT_TRUE(all_finite(scene)) << what;
    EXPECT_FALSE(scene.materials.empty()) << what;
    EXPECT_FALSE(scene.cameras.empty()) << what;
    EXPECT_FALSE(scene.lights.empty()) << what;
    for (const Primitive& primitive : scene.primitives) {
        EXPECT_LT(primitive.material, scene.materials.size()) << what;
        EXPECT_EQ(primitive.indices.size() % 3, 0U) << what;
        const std::size_t count = primitive.positions.size();
        EXPECT_TRUE(primitive.normals.size() == count && primitive.tangents.size() == count &&
                    primitive.uv0.size() == count && primitive.uv1.size() == count && primitive.colors.size() == count)
            << what;
        EXPECT_LT(*std::max_element(primitive.indices.begin(), primitive.indices.end()), count) << what;
    }
    for (const Instance& instance : scene.instances) {
        EXPECT_LT(instance.primitive, scene.primitives.size()) << what;
    }
    for (const Texture& texture : scene.textures) {
        EXPECT_LT(texture.image, scene.images.size()) << what;
    }
    for (const Image& image : scene.images) {
        EXPECT_EQ(image.rgba.size(), std::size_t{4} * image.width * image.height) << what;
    }
}

void expect_one_sentence(const std::string& message) {
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_TRUE(message.ends_with('.')) << message;
    EXPECT_FALSE(message.ends_with("..")) << message;
}

TEST(GltfRobustness, BinaryContainerLoadsLikeText) {
    const GltfFile file = rich_file();
    const auto text = file.load();
    const auto binary = load_text(to_glb(file), "test.glb");
    ASSERT_TRUE(text) << text.error().message;
    ASSERT_TRUE(binary) << binary.error().message;
    EXPECT_EQ(binary->primitives.at(0).positions, text->primitives.at(0).positions);
    EXPECT_EQ(binary->images.at(0).rgba, (std::vector<std::uint8_t>{1, 2, 3, 4}));
    EXPECT_EQ(binary->lights.at(0).type, LightType::spot);
    expect_sound(*binary, "glb");
}

TEST(GltfRobustness, BinaryContainerCutAnywhereIsAnError) {
    const std::string glb = to_glb(rich_file());
    const TemporaryFolder folder;
    for (std::size_t size = 0; size < glb.size(); size += 17) {
        const auto scene = load_gltf(folder.write("cut.glb", glb.substr(0, size)));
        ASSERT_FALSE(scene) << size;
        expect_one_sentence(scene.error().message);
    }
}

TEST(GltfRobustness, DamagedBytesNeverCrash) {
    const std::string glb = to_glb(rich_file());
    const TemporaryFolder folder;
    std::mt19937 random(7);
    for (int trial = 0; trial < 1000; ++trial) {
        std::string damaged = glb;
        const auto hits = 1 + random() % 3;
        for (std::uint_fast32_t i = 0; i < hits; ++i) {
            damaged[random() % damaged.size()] = static_cast<char>(random() % 256);
        }
        const auto scene = load_gltf(folder.write("damaged.glb", damaged));
        if (scene) {
            expect_sound(*scene, "trial " + std::to_string(trial));
        } else {
            expect_one_sentence(scene.error().message);
        }
    }
}

/// All values of the document that are neither objects nor lists, and those too.
void collect(json& value, std::vector<json*>& values) {
    values.push_back(&value);
    if (value.is_structured()) {
        for (json& child : value) {
            collect(child, values);
        }
    }
}

TEST(GltfRobustness, WrongValuesAnywhereNeverCrash) {
    const std::vector<json> wrong = {nullptr, -1, 1, 255, 2147483648, 1e300, "text", json::array(), json::object()};
    const GltfFile original = rich_file();
    GltfFile file = original;
    std::vector<json*> values;
    collect(file.root, values);
    const std::size_t count = values.size();
    const TemporaryFolder folder;
    for (std::size_t i = 0; i < count; ++i) {
        for (const json& replacement : wrong) {
            file.root = original.root;
            values.clear();
            collect(file.root, values);
            *values[i] = replacement;
            if (!file.root.is_object()) {
                continue;
            }
            const auto scene = load_gltf(folder.write("wrong.gltf", file.text()));
            if (scene) {
                expect_sound(*scene, file.root.dump());
            } else {
                expect_one_sentence(scene.error().message);
            }
        }
    }
}

TEST(GltfRobustness, EveryTestModelLoadsOrIsRefusedInOneSentence) {
    const std::filesystem::path models = "/usr/share/assimp/models";
    if (!std::filesystem::exists(models / "glTF2")) {
        GTEST_SKIP() << "Debian's package assimp-testmodels is not installed.";
    }
    std::size_t loaded = 0;
    std::vector<std::filesystem::path> files;
    for (const char* folder : {"glTF", "glTF2"}) {
        for (const auto& entry : std::filesystem::recursive_directory_iterator(models / folder)) {
            const std::string extension = entry.path().extension().string();
            if (extension == ".gltf" || extension == ".glb") {
                files.push_back(entry.path());
            }
        }
    }
    for (const std::filesystem::path& file : files) {
        const auto scene = load_gltf(file);
        if (scene) {
            expect_sound(*scene, file.string());
            ++loaded;
        } else {
            expect_one_sentence(scene.error().message);
        }
    }
    // Most are sound; the rest are glTF 1, need Draco or are broken on purpose.
    EXPECT_GE(2 * loaded, files.size()) << loaded << " of " << files.size();
}

} // namespace
} // namespace tyndall::engine::test
