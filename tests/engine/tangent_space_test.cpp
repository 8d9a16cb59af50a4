// Tangents: their direction, their sign, and vertices between mirrored charts.
#include <cmath>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include "engine/tangent_space.hpp"

namespace tyndall::engine {
namespace {

/// A square facing +Z whose image stands upright: u to the right, v down.
Primitive upright_square() {
    Primitive square;
    square.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    square.uv0 = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    square.uv1 = square.uv0;
    square.normals.assign(4, {0, 0, 1});
    square.colors.assign(4, glm::vec4(1.0F));
    square.indices = {0, 1, 2, 0, 2, 3};
    return square;
}

TEST(TangentSpace, FollowsGrowingUAndBitangentPointsUpTheImage) {
    Primitive square = upright_square();
    make_tangents(square, TextureUse{});
    ASSERT_EQ(square.tangents.size(), 4U);
    for (const glm::vec4& tangent : square.tangents) {
        EXPECT_NEAR(tangent.x, 1.0F, 1e-6F);
        EXPECT_EQ(tangent.w, 1.0F);
        // glTF 2.0, section 3.9.3: +Y of the normal map is up, bitangent = cross(normal, tangent) * w.
        const glm::vec3 bitangent = tangent.w * glm::cross(glm::vec3(0, 0, 1), glm::vec3(tangent));
        EXPECT_NEAR(bitangent.y, 1.0F, 1e-6F);
    }
}

TEST(TangentSpace, FollowsTheTransformedCoordinates) {
    Primitive square = upright_square();
    TextureUse quarter_turn; // u' = v, v' = -u
    quarter_turn.uv_row_u = {0, 1, 0};
    quarter_turn.uv_row_v = {-1, 0, 0};
    make_tangents(square, quarter_turn);
    EXPECT_NEAR(square.tangents[0].y, -1.0F, 1e-6F);
}

TEST(TangentSpace, MirroredChartsSplitTheirCommonVertices) {
    // The left triangle of the square reads the image mirrored: u is 1 at its far corner too.
    Primitive square = upright_square();
    square.uv0[3] = {2, 1};
    make_tangents(square, TextureUse{});
    EXPECT_EQ(square.positions.size(), 6U) << "vertices 0 and 2 are doubled";
    for (const std::vector<std::uint32_t>& triangle :
         {std::vector<std::uint32_t>(square.indices.begin(), square.indices.begin() + 3),
          std::vector<std::uint32_t>(square.indices.begin() + 3, square.indices.end())}) {
        const float sign = square.tangents[triangle[0]].w;
        EXPECT_EQ(square.tangents[triangle[1]].w, sign);
        EXPECT_EQ(square.tangents[triangle[2]].w, sign);
    }
    EXPECT_NE(square.tangents[square.indices[0]].w, square.tangents[square.indices[3]].w);
}

TEST(TangentSpace, IsUnitAndOrthogonalToTheNormalEvenWithoutCoordinates) {
    Primitive square = upright_square();
    square.uv0.assign(4, glm::vec2(0.5F));
    square.normals = {{0, 0, 1}, glm::normalize(glm::vec3(1, 2, 3)), {0, 0, -1}, {-1, 0, 0}};
    make_tangents(square, TextureUse{});
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::vec3 tangent(square.tangents[i]);
        EXPECT_NEAR(glm::length(tangent), 1.0F, 1e-6F) << i;
        EXPECT_NEAR(glm::dot(tangent, square.normals[i]), 0.0F, 1e-6F) << i;
    }
}

TEST(TangentSpace, GivenTangentsAreNormalisedAndBrokenOnesReplaced) {
    Primitive square = upright_square();
    square.tangents = {{3, 0, 0, 0.5F}, {0, 2, 0, -2}, {0, 0, 0, 1}, {std::nanf(""), 0, 0, 1}};
    repair_tangents(square);
    EXPECT_EQ(square.tangents[0], glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(square.tangents[1], glm::vec4(0, 1, 0, -1));
    for (std::size_t i = 2; i < 4; ++i) {
        EXPECT_NEAR(glm::length(glm::vec3(square.tangents[i])), 1.0F, 1e-6F) << i;
    }
}

} // namespace
} // namespace tyndall::engine
