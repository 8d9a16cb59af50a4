#include "engine/camera.hpp"

#include <cmath>
#include <limits>

namespace tyndall::engine {
namespace {

/// Reverse-Z with y down. Depth d maps to near (far - d) / ((far - near) d), without a far plane to near / d.
glm::dmat4 perspective(const Perspective& lens, double aspect) {
    const double y = 1.0 / std::tan(0.5 * lens.fov_y_rad);
    glm::dmat4 clip(0.0);
    clip[0][0] = y / aspect;
    clip[1][1] = -y;
    clip[2][3] = -1.0;
    clip[3][2] = lens.near_m;
    if (lens.far_m) {
        const double length_m = *lens.far_m - lens.near_m;
        clip[2][2] = lens.near_m / length_m;
        clip[3][2] = lens.near_m * *lens.far_m / length_m;
    }
    return clip;
}

glm::dmat4 orthographic(const Orthographic& lens, double aspect) {
    const double length_m = lens.far_m - lens.near_m;
    glm::dmat4 clip(0.0);
    clip[0][0] = 1.0 / (lens.half_height_m * aspect);
    clip[1][1] = -1.0 / lens.half_height_m;
    clip[2][2] = 1.0 / length_m;
    clip[3][2] = lens.far_m / length_m;
    clip[3][3] = 1.0;
    return clip;
}

glm::dvec4 row(const glm::dmat4& m, int i) {
    return {m[0][i], m[1][i], m[2][i], m[3][i]};
}

} // namespace

FrameView make_view(const Camera& camera, VkExtent2D size) {
    const double aspect = static_cast<double>(size.width) / static_cast<double>(size.height);
    FrameView view;
    view.view_from_render = glm::dmat4(glm::transpose(glm::dmat3(camera.world_from_camera)));
    view.clip_from_view =
        camera.orthographic ? orthographic(*camera.orthographic, aspect) : perspective(camera.perspective, aspect);
    view.origin_m = glm::dvec3(camera.world_from_camera[3]);
    view.size = size;
    return view;
}

bool is_perspective(const FrameView& view) {
    return view.clip_from_view[2][3] != 0.0;
}

double far_depth_m(const FrameView& view) {
    // Clip z is 0 at the far plane: m22 z + m32 = 0, depth = -z.
    const double m22 = view.clip_from_view[2][2];
    return m22 == 0.0 ? std::numeric_limits<double>::infinity() : view.clip_from_view[3][2] / m22;
}

ViewRays view_rays(const FrameView& view) {
    const glm::dmat3 render_from_view = glm::transpose(glm::dmat3(view.view_from_render));
    ViewRays rays;
    rays.origin = -render_from_view[2];
    if (is_perspective(view)) {
        const double half_x = 1.0 / view.clip_from_view[0][0];
        const double half_y = 1.0 / view.clip_from_view[1][1];
        rays.origin -= half_x * render_from_view[0] + half_y * render_from_view[1];
        rays.u = 2.0 * half_x * render_from_view[0];
        rays.v = 2.0 * half_y * render_from_view[1];
    }
    return rays;
}

// Gribb and Hartmann, Fast Extraction of Viewing Frustum Planes from the World-View-Projection Matrix, 2001.
Frustum make_frustum(const FrameView& view) {
    const glm::dmat4 clip = view.clip_from_view * view.view_from_render;
    const glm::dvec4 x = row(clip, 0);
    const glm::dvec4 y = row(clip, 1);
    const glm::dvec4 z = row(clip, 2);
    const glm::dvec4 w = row(clip, 3);
    Frustum frustum;
    for (const glm::dvec4& plane : {w + x, w - x, w + y, w - y, w - z, z}) {
        const double length = glm::length(glm::dvec3(plane));
        if (length > 0.0) {
            frustum.planes[frustum.count++] = plane / length;
        }
    }
    return frustum;
}

bool may_be_visible(const Frustum& frustum, const Box& box, const glm::dvec3& origin_m) {
    const glm::dvec3 center = box.center() - origin_m;
    const glm::dvec3 half = 0.5 * box.extent();
    for (std::uint32_t i = 0; i < frustum.count; ++i) {
        const glm::dvec4& plane = frustum.planes[i];
        const glm::dvec3 normal(plane);
        if (glm::dot(normal, center) + glm::dot(glm::abs(normal), half) + plane.w < 0.0) {
            return false;
        }
    }
    return true;
}

double view_depth_m(const FrameView& view, const glm::dvec3& world_position) {
    return -(view.view_from_render * glm::dvec4(world_position - view.origin_m, 1.0)).z;
}

} // namespace tyndall::engine
