// Vertices and triangles: accessors in all their forms, primitive modes, normals and tangents that are made.
#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/engine/gltf_fixture.hpp"

namespace tyndall::engine::test {
namespace {

/// Unit square in the xy plane, counter-clockwise from the lower left corner.
const std::vector<float> square = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
const std::vector<std::uint16_t> square_indices = {0, 1, 2, 0, 2, 3};

Primitive only_primitive(const GltfFile& file) {
    auto scene = file.load();
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
    if (!scene || scene->primitives.size() != 1) {
        ADD_FAILURE() << "no single primitive";
        return {};
    }
    return std::move(scene->primitives.front());
}

/// Corner positions of a triangle.
std::array<glm::vec3, 3> corners(const Primitive& primitive, std::size_t triangle) {
    std::array<glm::vec3, 3> result;
    for (std::size_t i = 0; i < 3; ++i) {
        result[i] = primitive.positions[primitive.indices[3 * triangle + i]];
    }
    return result;
}

glm::vec3 normal_of(const Primitive& primitive, std::size_t triangle) {
    const auto [a, b, c] = corners(primitive, triangle);
    return glm::normalize(glm::cross(b - a, c - a));
}

TEST(GltfGeometry, TriangleWithoutIndicesAndNormalsGetsBoth) {
    GltfFile file;
    file.add_triangle();
    const Primitive primitive = only_primitive(file);
    EXPECT_EQ(primitive.indices, (std::vector<std::uint32_t>{0, 1, 2}));
    for (const glm::vec3& normal : primitive.normals) {
        EXPECT_EQ(normal, glm::vec3(0, 0, 1));
    }
}

TEST(GltfGeometry, EveryArrayHasOneElementAVertex) {
    GltfFile file;
    file.add_triangle();
    const Primitive primitive = only_primitive(file);
    EXPECT_EQ(primitive.positions.size(), 3U);
    EXPECT_EQ(primitive.normals.size(), 3U);
    EXPECT_EQ(primitive.tangents.size(), 3U);
    EXPECT_EQ(primitive.uv0, std::vector<glm::vec2>(3, glm::vec2(0.0F)));
    EXPECT_EQ(primitive.uv1, std::vector<glm::vec2>(3, glm::vec2(0.0F)));
    EXPECT_EQ(primitive.colors, std::vector<glm::vec4>(3, glm::vec4(1.0F)));
}

TEST(GltfGeometry, MissingNormalsSplitSharedVertices) {
    // Two triangles that share an edge but not a plane.
    GltfFile file;
    const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    file.add_shown_mesh(
        {{"attributes", {{"POSITION", file.add_accessor(positions, "VEC3", type_float)}}},
         {"indices", file.add_accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 3, 1}, "SCALAR", type_unsigned_short)}});
    const Primitive primitive = only_primitive(file);
    ASSERT_EQ(primitive.positions.size(), 6U);
    EXPECT_EQ(primitive.normals[primitive.indices[0]], glm::vec3(0, 0, 1));
    EXPECT_EQ(primitive.normals[primitive.indices[3]], glm::vec3(0, 1, 0));
}

TEST(GltfGeometry, IndicesOfEveryUnsignedTypeReadAlike) {
    for (const int type : {type_unsigned_byte, type_unsigned_short, type_unsigned_int}) {
        GltfFile file;
        const int positions = file.add_accessor(square, "VEC3", type_float);
        const int normals =
            file.add_accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", type_float);
        const std::vector<std::uint8_t> bytes(square_indices.begin(), square_indices.end());
        const std::vector<std::uint32_t> words(square_indices.begin(), square_indices.end());
        const int indices = type == type_unsigned_byte    ? file.add_accessor(bytes, "SCALAR", type)
                            : type == type_unsigned_short ? file.add_accessor(square_indices, "SCALAR", type)
                                                          : file.add_accessor(words, "SCALAR", type);
        file.add_shown_mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}, {"indices", indices}});
        EXPECT_EQ(only_primitive(file).indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3})) << type;
    }
}

TEST(GltfGeometry, StripsAndFansFaceTheSameWayAsLists) {
    // glTF modes: 4 list, 5 strip, 6 fan; the same square each time.
    const std::vector<std::pair<int, std::vector<std::uint16_t>>> modes = {
        {4, square_indices}, {5, {0, 1, 3, 2}}, {6, {0, 1, 2, 3}}};
    for (const auto& [mode, indices] : modes) {
        GltfFile file;
        file.add_shown_mesh({{"attributes", {{"POSITION", file.add_accessor(square, "VEC3", type_float)}}},
                             {"indices", file.add_accessor(indices, "SCALAR", type_unsigned_short)},
                             {"mode", mode}});
        const Primitive primitive = only_primitive(file);
        ASSERT_EQ(primitive.indices.size(), 6U) << mode;
        EXPECT_EQ(normal_of(primitive, 0), glm::vec3(0, 0, 1)) << mode;
        EXPECT_EQ(normal_of(primitive, 1), glm::vec3(0, 0, 1)) << mode;
        double area = 0.0;
        for (std::size_t t = 0; t < 2; ++t) {
            const auto [a, b, c] = corners(primitive, t);
            area += 0.5 * static_cast<double>(glm::length(glm::cross(b - a, c - a)));
        }
        EXPECT_DOUBLE_EQ(area, 1.0) << mode;
    }
}

TEST(GltfGeometry, PointsAndLinesAreLeftOutWithANote) {
    for (const int mode : {0, 1, 2, 3}) {
        GltfFile file;
        file.add_shown_mesh(
            {{"attributes", {{"POSITION", file.add_accessor(square, "VEC3", type_float)}}}, {"mode", mode}});
        const auto scene = file.load();
        ASSERT_TRUE(scene) << mode;
        EXPECT_TRUE(scene->primitives.empty()) << mode;
        EXPECT_TRUE(has_note(*scene, "Mesh 0 consists of points or lines and is left out.")) << mode;
    }
}

TEST(GltfGeometry, NormalisedIntegersMapToTheirRange) {
    GltfFile file;
    const int positions = file.add_accessor(square, "VEC3", type_float);
    const int uv0 =
        file.add_accessor(std::vector<std::uint8_t>{0, 255, 51, 102, 0, 0, 0, 0}, "VEC2", type_unsigned_byte, true);
    const int uv1 = file.add_accessor(std::vector<std::uint16_t>{65535, 0, 13107, 26214, 0, 0, 0, 0}, "VEC2",
                                      type_unsigned_short, true);
    const int normals = file.add_accessor(std::vector<std::int8_t>{0, 0, 127, 0, -128, 0, -127, 0, 0, 0, 0, 127},
                                          "VEC3", type_byte, true);
    const int colors = file.add_accessor(std::vector<std::uint16_t>{65535, 0, 13107, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC3",
                                         type_unsigned_short, true);
    file.add_shown_mesh({{"attributes",
                          {{"POSITION", positions},
                           {"NORMAL", normals},
                           {"TEXCOORD_0", uv0},
                           {"TEXCOORD_1", uv1},
                           {"COLOR_0", colors}}},
                         {"indices", file.add_accessor(square_indices, "SCALAR", type_unsigned_short)}});
    const Primitive primitive = only_primitive(file);
    EXPECT_EQ(primitive.uv0[0], glm::vec2(0.0F, 1.0F));
    EXPECT_EQ(primitive.uv0[1], glm::vec2(0.2F, 0.4F));
    EXPECT_EQ(primitive.uv1[0], glm::vec2(1.0F, 0.0F));
    EXPECT_EQ(primitive.uv1[1], glm::vec2(0.2F, 0.4F));
    EXPECT_EQ(primitive.normals[1], glm::vec3(0, -1, 0));
    EXPECT_EQ(primitive.normals[2], glm::vec3(-1, 0, 0));
    EXPECT_EQ(primitive.colors[0], glm::vec4(1.0F, 0.0F, 0.2F, 1.0F));
}

TEST(GltfGeometry, QuantisedPositionsKeepTheirValue) {
    GltfFile file;
    file.root["extensionsRequired"] = {"KHR_mesh_quantization"};
    const std::vector<std::int16_t> positions = {0, 0, 0, 0, -300, 0, 0, 0, 0, 200, 0, 0};
    const int view = file.add_view(positions, 8);
    const int accessor =
        file.add("accessors", {{"bufferView", view}, {"componentType", type_short}, {"count", 3}, {"type", "VEC3"}});
    file.add_shown_mesh({{"attributes", {{"POSITION", accessor}}}});
    const Primitive primitive = only_primitive(file);
    EXPECT_EQ(primitive.positions[1], glm::vec3(-300, 0, 0));
    EXPECT_EQ(primitive.positions[2], glm::vec3(0, 200, 0));
}

TEST(GltfGeometry, LeastNormalisedIntegerIsMinusOneToo) {
    // Section 3.6.2.2: -128 and -127 both map to -1.
    GltfFile file;
    const int view = file.add_view(std::vector<std::int8_t>{-128, 0, 0, 0, -127, 127, 0, 0, 0, 127, 0, 0}, 4);
    const int accessor = file.add(
        "accessors",
        {{"bufferView", view}, {"componentType", type_byte}, {"normalized", true}, {"count", 3}, {"type", "VEC3"}});
    file.add_shown_mesh({{"attributes", {{"POSITION", accessor}}}});
    const Primitive primitive = only_primitive(file);
    EXPECT_EQ(primitive.positions[0], glm::vec3(-1, 0, 0));
    EXPECT_EQ(primitive.positions[1], glm::vec3(-1, 1, 0));
}

TEST(GltfGeometry, InterleavedVerticesAreTakenApart) {
    GltfFile file;
    const std::vector<float> interleaved = {0, 0, 0, 0.1F, 0.2F, 1, 0, 0, 0.3F, 0.4F, 0, 1, 0, 0.5F, 0.6F};
    const int view = file.add_view(interleaved, 20);
    const int positions =
        file.add("accessors", {{"bufferView", view}, {"componentType", type_float}, {"count", 3}, {"type", "VEC3"}});
    const int uv = file.add(
        "accessors",
        {{"bufferView", view}, {"byteOffset", 12}, {"componentType", type_float}, {"count", 3}, {"type", "VEC2"}});
    file.add_shown_mesh({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uv}}}});
    const Primitive primitive = only_primitive(file);
    EXPECT_EQ(primitive.positions[2], glm::vec3(0, 1, 0));
    EXPECT_EQ(primitive.uv0[0], glm::vec2(0.1F, 0.2F));
    EXPECT_EQ(primitive.uv0[2], glm::vec2(0.5F, 0.6F));
}

TEST(GltfGeometry, SparseAccessorsOverwriteTheirBase) {
    for (const bool with_base : {true, false}) {
        GltfFile file;
        const int indices = file.add_view(std::vector<std::uint16_t>{1, 2});
        const int values = file.add_view(std::vector<float>{5, 0, 0, 0, 7, 0});
        json accessor = {{"componentType", type_float},
                         {"count", 3},
                         {"type", "VEC3"},
                         {"sparse",
                          {{"count", 2},
                           {"indices", {{"bufferView", indices}, {"componentType", type_unsigned_short}}},
                           {"values", {{"bufferView", values}}}}}};
        if (with_base) {
            accessor["bufferView"] = file.add_view(std::vector<float>{1, 2, 3, 4, 5, 6, 7, 8, 9});
        }
        file.add_shown_mesh({{"attributes", {{"POSITION", file.add("accessors", accessor)}}}});
        const Primitive primitive = only_primitive(file);
        EXPECT_EQ(primitive.positions[0], with_base ? glm::vec3(1, 2, 3) : glm::vec3(0)) << with_base;
        EXPECT_EQ(primitive.positions[1], glm::vec3(5, 0, 0)) << with_base;
        EXPECT_EQ(primitive.positions[2], glm::vec3(0, 7, 0)) << with_base;
    }
}

TEST(GltfGeometry, CoordinatesThatAreNotFiniteAreReplacedWithANote) {
    GltfFile file;
    file.add_triangle();
    const std::vector<float> uv = {0.25F, 0.5F, std::nanf(""), 1, 1, std::numeric_limits<float>::infinity()};
    file.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = file.add_accessor(uv, "VEC2", type_float);
    const auto scene = file.load();
    ASSERT_TRUE(scene);
    EXPECT_EQ(scene->primitives[0].uv0, (std::vector<glm::vec2>{{0.25F, 0.5F}, {0, 0}, {0, 0}}));
    EXPECT_TRUE(has_note(*scene, "Mesh 0 has texture coordinates that are not finite"));
}

TEST(GltfGeometry, BrokenNormalsAreReplacedWithANote) {
    GltfFile file;
    const int positions = file.add_accessor(square, "VEC3", type_float);
    const std::vector<float> broken = {0, 0, 0, 0, 0, std::nanf(""), 0, 0, 9, 0, 0, 1};
    const int normals = file.add_accessor(broken, "VEC3", type_float);
    file.add_shown_mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}},
                         {"indices", file.add_accessor(square_indices, "SCALAR", type_unsigned_short)}});
    const auto scene = file.load();
    ASSERT_TRUE(scene);
    for (const glm::vec3& normal : scene->primitives[0].normals) {
        EXPECT_EQ(normal, glm::vec3(0, 0, 1));
    }
    EXPECT_TRUE(has_note(*scene, "Mesh 0 has broken normals"));
}

} // namespace
} // namespace tyndall::engine::test
