// Matrices of a camera, and what lies in its view.
#pragma once

#include <array>
#include <cstdint>

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include "engine/frame.hpp"
#include "engine/scene.hpp"

namespace tyndall::engine {

/// Matrices, origin and size of the view; the rest is left at its default. The image's own aspect ratio is used: a
/// perspective camera keeps its vertical field of view, an orthographic one its half height.
[[nodiscard]] FrameView make_view(const Camera& camera, VkExtent2D size);

/// View depth of the far plane; infinity without one.
[[nodiscard]] double far_depth_m(const FrameView& view);
[[nodiscard]] bool is_perspective(const FrameView& view);

/// The direction, not of unit length, from the eye through uv of the image is origin + uv.x u + uv.y v, in render
/// space, and advances view depth by 1.
struct ViewRays {
    glm::dvec3 origin{0.0, 0.0, -1.0};
    glm::dvec3 u{0.0};
    glm::dvec3 v{0.0};
};
[[nodiscard]] ViewRays view_rays(const FrameView& view);

/// Half spaces, inside where dot(xyz, p) + w >= 0, render space, xyz of unit length. An infinite far plane is left out.
struct Frustum {
    std::array<glm::dvec4, 6> planes;
    std::uint32_t count = 0;
};
[[nodiscard]] Frustum make_frustum(const FrameView& view);

/// False only if no part of `box` (world space) is in the view whose render space starts at `origin_m`.
[[nodiscard]] bool may_be_visible(const Frustum& frustum, const Box& box, const glm::dvec3& origin_m);

/// Positive in front of the camera; of a world position.
[[nodiscard]] double view_depth_m(const FrameView& view, const glm::dvec3& world_position);

} // namespace tyndall::engine
