// Broken files: each ends with one sentence that names the file and the culprit.
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "tests/engine/gltf_fixture.hpp"

namespace tyndall::engine::test {
namespace {

GltfFile textured_triangle() {
    GltfFile file;
    file.add_triangle({{"name", "wall"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    file.add("textures", {{"source", 0}});
    file.add("images", {{"uri", "data:image/png;base64," + base64(one_pixel_png(1, 2, 3, 4))}});
    return file;
}

struct Mistake {
    const char* name;
    std::function<void(GltfFile&)> make;
    std::string message; ///< after the file's name
};

class GltfMistake : public testing::TestWithParam<Mistake> {};

TEST_P(GltfMistake, IsToldInOneSentence) {
    GltfFile file = textured_triangle();
    ASSERT_EQ(file.error(), "loaded");
    GetParam().make(file);
    EXPECT_EQ(file.error(), GetParam().message);
}

json& first_accessor(GltfFile& file) {
    return file.root["accessors"][0];
}
json& first_primitive(GltfFile& file) {
    return file.root["meshes"][0]["primitives"][0];
}
json& first_node(GltfFile& file) {
    return file.root["nodes"][0];
}

const std::vector<Mistake> mistakes = {
    {"Version", [](GltfFile& f) { f.root["asset"]["version"] = "1.0"; }, "it is glTF 1.0, only glTF 2 is read."},
    {"NoAsset", [](GltfFile& f) { f.root.erase("asset"); }, "it has no asset.version, so it is not glTF 2."},
    {"RequiredExtension",
     [](GltfFile& f) {
         f.root["extensionsRequired"] = {"KHR_lights_punctual", "EXT_teapot"};
     },
     "it requires the extension EXT_teapot, which is not supported."},
    {"ExtensionListType", [](GltfFile& f) { f.root["extensionsRequired"] = 3; },
     "'/extensionsRequired' should be a list of strings."},
    {"NodesType", [](GltfFile& f) { f.root["meshes"] = 3; }, "'/meshes' should be a list of objects."},
    {"NegativeIndex", [](GltfFile& f) { first_node(f)["mesh"] = -1; },
     "'/nodes/0/mesh' should be a non-negative integer of 32 bits."},
    {"IndexOf33Bits", [](GltfFile& f) { first_node(f)["mesh"] = std::int64_t{1} << 32; },
     "'/nodes/0/mesh' should be a non-negative integer of 32 bits."},
    {"Mesh", [](GltfFile& f) { first_node(f)["mesh"] = 1; }, "there is no mesh 1."},
    {"Camera", [](GltfFile& f) { first_node(f)["camera"] = 0; }, "there is no camera 0."},
    {"Light", [](GltfFile& f) { first_node(f)["extensions"]["KHR_lights_punctual"]["light"] = 4; },
     "there is no light 4."},
    {"Scene",
     [](GltfFile& f) {
         f.root["scene"] = 2;
         f.root["scenes"] = json::parse(R"([{"nodes":[0]}])");
     },
     "it shows scene 2, which is not there."},
    {"Child", [](GltfFile& f) { first_node(f)["children"] = {7}; }, "there is no node 7."},
    {"OwnChild",
     [](GltfFile& f) {
         f.root["scenes"] = json::parse(R"([{"nodes":[0]}])");
         first_node(f)["children"] = {0};
     },
     "node 0 is below itself or has two parents."},
    {"TwoParents",
     [](GltfFile& f) {
         f.add("nodes", {{"name", "a"}, {"children", {0}}});
         f.add("nodes", {{"name", "b"}, {"children", {0}}});
     },
     "node 0 is below itself or has two parents."},
    {"MatrixLength",
     [](GltfFile& f) {
         first_node(f)["matrix"] = {1, 0, 0};
     },
     "node 0 has a matrix, translation, rotation or scale of a wrong length."},
    {"HugeTransform",
     [](GltfFile& f) {
         first_node(f)["scale"] = {1e300, 1, 1};
     },
     "node 0 has a transform that leaves the range of numbers."},
    {"Material", [](GltfFile& f) { first_primitive(f)["material"] = 5; },
     "mesh 0 names material 5, which is not there."},
    {"Mode", [](GltfFile& f) { first_primitive(f)["mode"] = 9; }, "mesh 0 has the mode 9, allowed are 0 to 6."},
    {"Accessor", [](GltfFile& f) { first_primitive(f)["attributes"]["POSITION"] = 8; },
     "mesh 0 has a POSITION that cannot be read: there is no accessor 8."},
    {"Components", [](GltfFile& f) { first_accessor(f)["type"] = "VEC2"; },
     "mesh 0 has a POSITION of 2 components, needed are 3."},
    {"Matrices", [](GltfFile& f) { first_accessor(f)["type"] = "MAT2"; },
     "mesh 0 has a POSITION that cannot be read: accessor 0 holds matrices where numbers or vectors are needed."},
    {"ComponentType", [](GltfFile& f) { first_accessor(f)["componentType"] = 5124; },
     "mesh 0 has a POSITION that cannot be read: accessor 0 has the component type 5124, which glTF does not have."},
    {"NoElements", [](GltfFile& f) { first_accessor(f)["count"] = 0; },
     "mesh 0 has a POSITION that cannot be read: accessor 0 has no elements."},
    {"Count", [](GltfFile& f) { first_accessor(f)["count"] = 4; },
     "mesh 0 has a POSITION that cannot be read: accessor 0 reads past the end of buffer view 0."},
    {"HugeCount", [](GltfFile& f) { first_accessor(f)["count"] = std::numeric_limits<std::uint64_t>::max(); },
     "mesh 0 has a POSITION that cannot be read: accessor 0 reads past the end of buffer view 0."},
    {"HugeOffset", [](GltfFile& f) { first_accessor(f)["byteOffset"] = std::numeric_limits<std::uint64_t>::max() - 3; },
     "mesh 0 has a POSITION that cannot be read: accessor 0 reads past the end of buffer view 0."},
    {"HugeCountOfNothing",
     [](GltfFile& f) {
         first_accessor(f).erase("bufferView");
         first_accessor(f)["count"] = std::uint64_t{1} << 60;
     },
     "mesh 0 has a POSITION that cannot be read: accessor 0 has 1152921504606846976 elements but no buffer view that "
     "holds them."},
    {"Stride", [](GltfFile& f) { f.root["bufferViews"][0]["byteStride"] = 4; },
     "mesh 0 has a POSITION that cannot be read: accessor 0 has elements of 12 bytes, but buffer view 0 steps by 4."},
    {"BufferView", [](GltfFile& f) { first_accessor(f)["bufferView"] = 6; },
     "mesh 0 has a POSITION that cannot be read: accessor 0 cannot be read: there is no buffer view 6."},
    {"ViewBuffer", [](GltfFile& f) { f.root["bufferViews"][0]["buffer"] = 3; },
     "mesh 0 has a POSITION that cannot be read: accessor 0 cannot be read: buffer view 0 names buffer 3, which is not "
     "there."},
    {"ViewLength", [](GltfFile& f) { f.root["bufferViews"][0]["byteLength"] = 37; },
     "mesh 0 has a POSITION that cannot be read: accessor 0 cannot be read: buffer view 0 reaches past the end of "
     "buffer "
     "0."},
    {"VertexCounts",
     [](GltfFile& f) {
         first_primitive(f)["attributes"]["NORMAL"] = f.add_accessor(std::vector<float>{0, 0, 1}, "VEC3", type_float);
     },
     "mesh 0 has 3 positions but 1 elements of NORMAL."},
    {"IndexRange",
     [](GltfFile& f) {
         first_primitive(f)["indices"] =
             f.add_accessor(std::vector<std::uint16_t>{0, 1, 3}, "SCALAR", type_unsigned_short);
     },
     "mesh 0 has an index 3 but only 3 vertices."},
    {"IndexType",
     [](GltfFile& f) {
         first_primitive(f)["indices"] = f.add_accessor(std::vector<float>{0, 1, 2}, "SCALAR", type_float);
     },
     "mesh 0 has indices that cannot be read: accessor 1 holds indices, so it should be SCALAR of unsigned integers."},
    {"NotFinite",
     [](GltfFile& f) {
         const std::vector<float> positions = {0, 0, std::numeric_limits<float>::quiet_NaN(), 1, 0, 0, 0, 1, 0};
         first_primitive(f)["attributes"]["POSITION"] = f.add_accessor(positions, "VEC3", type_float);
     },
     "mesh 0 has a position that is not finite or beyond 1e12 m."},
    {"SparseIndex",
     [](GltfFile& f) {
         const int indices = f.add_view(std::vector<std::uint16_t>{3});
         const int values = f.add_view(std::vector<float>{5, 0, 0});
         first_accessor(f)["sparse"] = {{"count", 1},
                                        {"indices", {{"bufferView", indices}, {"componentType", type_unsigned_short}}},
                                        {"values", {{"bufferView", values}}}};
     },
     "mesh 0 has a POSITION that cannot be read: accessor 0 has a sparse index 3 but only 3 elements."},
    {"AlphaMode", [](GltfFile& f) { f.root["materials"][0]["alphaMode"] = "GLASS"; },
     "material 0 'wall' has the alphaMode 'GLASS', allowed are OPAQUE, MASK and BLEND."},
    {"Texture", [](GltfFile& f) { f.root["materials"][0]["normalTexture"]["index"] = 2; },
     "material 0 'wall' cannot be read: there is no texture 2."},
    {"TextureImage", [](GltfFile& f) { f.root["textures"][0]["source"] = 2; },
     "material 0 'wall' cannot be read: texture 0 names image 2, which is not there."},
    {"TextureSampler", [](GltfFile& f) { f.root["textures"][0]["sampler"] = 2; },
     "material 0 'wall' cannot be read: texture 0 names sampler 2, which is not there."},
    {"ImageContents", [](GltfFile& f) { f.root["images"][0]["uri"] = "data:image/png;base64,AAAA"; },
     "image 0 (a data URI) is not an image in a format that is read (PNG or JPEG)."},
    {"ImageBase64", [](GltfFile& f) { f.root["images"][0]["uri"] = "data:image/png;base64,A*AA"; },
     "image 0 (a data URI) cannot be read: its data URI holds a character that base64 does not have."},
    {"ImageEncoding", [](GltfFile& f) { f.root["images"][0]["uri"] = "data:image/svg+xml,<svg/>"; },
     "image 0 (a data URI) cannot be read: its data URI is not base64."},
    {"CameraAngle",
     [](GltfFile& f) {
         f.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 4.0}, {"znear", 1}}}});
         first_node(f)["camera"] = 0;
     },
     "camera 0 has a yfov that is not between 0 and pi."},
    {"CameraFar",
     [](GltfFile& f) {
         f.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 2}, {"zfar", 1}}}});
         first_node(f)["camera"] = 0;
     },
     "camera 0 has a zfar that is not beyond its znear."},
    {"LightType",
     [](GltfFile& f) {
         f.root["extensions"]["KHR_lights_punctual"]["lights"] = json::parse(R"([{"type":"area","name":"panel"}])");
         first_node(f)["extensions"]["KHR_lights_punctual"]["light"] = 0;
     },
     "light 0 'panel' has the type 'area', allowed are directional, point and spot."},
};

INSTANTIATE_TEST_SUITE_P(All, GltfMistake, testing::ValuesIn(mistakes),
                         [](const testing::TestParamInfo<Mistake>& mistake) {
                             return std::string(mistake.param.name);
                         });

TEST(GltfErrors, OptionalUnknownExtensionIsOnlyNoted) {
    GltfFile file = textured_triangle();
    file.root["extensionsUsed"] = {"EXT_teapot"};
    const auto scene = file.load();
    ASSERT_TRUE(scene);
    EXPECT_TRUE(has_note(*scene, "The optional extension EXT_teapot is not supported and left out."));
}

TEST(GltfErrors, MissingFilesAreNamed) {
    const TemporaryFolder folder;
    const std::string missing = (folder.path() / "nothing.gltf").string();
    EXPECT_EQ(load_gltf(missing).error().message, missing + ": there is no file '" + missing + "'.");
    EXPECT_EQ(load_gltf(folder.path()).error().message,
              folder.path().string() + ": '" + folder.path().string() + "' is not a regular file.");

    GltfFile file = textured_triangle();
    file.root["images"][0] = {{"name", "bark"}, {"uri", "textures/bark.png"}};
    const std::string path = folder.write("test.gltf", file.text()).string();
    EXPECT_EQ(load_gltf(path).error().message, path +
                                                   ": image 0 'bark' ('textures/bark.png') cannot be read: there is no "
                                                   "file '" +
                                                   (folder.path() / "textures/bark.png").string() + "'.");

    file.bytes.clear();
    file.root["buffers"] = json::parse(R"([{"byteLength":36,"uri":"short.bin"}])");
    folder.write("short.bin", "1234");
    folder.write("test.gltf", file.text());
    EXPECT_EQ(load_gltf(path).error().message, path + ": buffer 0 should have 36 bytes but 'short.bin' has 4.");
    std::filesystem::remove(folder.path() / "short.bin");
    EXPECT_EQ(load_gltf(path).error().message,
              path + ": buffer 0 cannot be read: there is no file '" + (folder.path() / "short.bin").string() + "'.");
}

TEST(GltfErrors, TextThatIsNotJsonIsToldWithItsPlace) {
    EXPECT_NE(load_text("").error().message.find("its JSON is broken at byte 1."), std::string::npos);
    EXPECT_NE(load_text("{\"asset\":}").error().message.find("its JSON is broken at byte 10."), std::string::npos);
    EXPECT_NE(load_text("[1]").error().message.find("its JSON is not an object."), std::string::npos);
    EXPECT_NE(load_text("{\"asset\":{\"version\":\"2.0\"},\"a\":1e999}").error().message.find("a number too large"),
              std::string::npos);
}

TEST(GltfErrors, DeepNestingIsRefusedBeforeItExhaustsTheStack) {
    constexpr std::size_t depth = 200000;
    const std::string nested =
        "{\"asset\":{\"version\":\"2.0\"},\"extensions\":" + std::string(depth, '[') + std::string(depth, ']') + "}";
    const auto scene = load_text(nested);
    ASSERT_FALSE(scene);
    EXPECT_NE(scene.error().message.find("should be an object"), std::string::npos) << scene.error().message;
    const std::string inside = "{\"asset\":{\"version\":\"2.0\"},\"extensions\":{\"a\":" + std::string(depth, '[') +
                               std::string(depth, ']') + "}}";
    const auto refused = load_text(inside);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("nested more than"), std::string::npos) << refused.error().message;
}

} // namespace
} // namespace tyndall::engine::test
