// Bounding volumes of geometry, and what a transform makes of them.
#pragma once

#include <glm/glm.hpp>

#include "engine/scene.hpp"

namespace tyndall::engine {

/// Around the vertices that the primitive's triangles use, in object space.
struct Bounds {
    Box box;
    Sphere sphere;
};

/// Tight box; sphere around the box's centre. Both empty (radius zero) for a primitive without triangles.
[[nodiscard]] Bounds bounds_of(const Primitive& primitive);

/// A box that holds the transformed box (Arvo, Transforming Axis-Aligned Bounding Boxes, Graphics Gems 1990).
[[nodiscard]] Box transformed(const Box& box, const glm::dmat4& transform);

/// A sphere that holds the transformed sphere: its radius grows by the transform's largest singular value.
[[nodiscard]] Sphere transformed(const Sphere& sphere, const glm::dmat4& transform);

} // namespace tyndall::engine
