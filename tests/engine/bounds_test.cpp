// Bounding volumes hold what they bound, before and after a transform.
#include <cmath>
#include <random>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "engine/bounds.hpp"

namespace tyndall::engine {
namespace {

TEST(Bounds, IgnoreVerticesThatNoTriangleUses) {
    Primitive primitive;
    primitive.positions = {{0, 0, 0}, {2, 0, 0}, {0, 4, 0}, {100, 100, 100}};
    primitive.indices = {0, 1, 2};
    const Bounds bounds = bounds_of(primitive);
    EXPECT_EQ(bounds.box.max, glm::dvec3(2, 4, 0));
    EXPECT_EQ(bounds.sphere.center, glm::dvec3(1, 2, 0));
    EXPECT_DOUBLE_EQ(bounds.sphere.radius_m, std::sqrt(5.0));
}

TEST(Bounds, RotationAndUniformScaleKeepTheSphereTight) {
    glm::dmat4 transform = glm::rotate(glm::dmat4(1.0), 0.7, glm::normalize(glm::dvec3(1, 2, 3)));
    transform = glm::scale(transform, glm::dvec3(3.0));
    EXPECT_NEAR(transformed(Sphere{{}, 2.0}, transform).radius_m, 6.0, 1e-9);
}

TEST(Bounds, HoldEveryPointUnderAnyTransform) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> number(-3.0, 3.0);
    const auto point = [&] { return glm::dvec3(number(random), number(random), number(random)); };
    for (int trial = 0; trial < 200; ++trial) {
        glm::dmat4 transform(1.0);
        for (int column = 0; column < 4; ++column) {
            transform[column] = glm::dvec4(point(), column == 3 ? 1.0 : 0.0);
        }
        Primitive primitive;
        for (std::uint32_t i = 0; i < 9; ++i) {
            primitive.positions.emplace_back(point());
            primitive.indices.push_back(i);
        }
        const Bounds bounds = bounds_of(primitive);
        const Box box = transformed(bounds.box, transform);
        const Sphere sphere = transformed(bounds.sphere, transform);
        for (const glm::vec3& position : primitive.positions) {
            const glm::dvec3 world(transform * glm::dvec4(glm::dvec3(position), 1.0));
            EXPECT_LE(glm::distance(world, sphere.center), sphere.radius_m * (1.0 + 1e-9));
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_GE(world[axis], box.min[axis] - 1e-9);
                EXPECT_LE(world[axis], box.max[axis] + 1e-9);
            }
        }
    }
}

} // namespace
} // namespace tyndall::engine
