#include "engine/cascades.hpp"

#include <algorithm>
#include <cmath>

#include "engine/camera.hpp"

namespace tyndall::engine {
namespace {

/// Texels at each side that no point of the slice falls on: one for the movement in whole texels, the rest for what
/// filters and offsets of the receiver reach.
constexpr double border_texels = 4.0;

struct Interval {
    double low = 0.0;
    double high = 0.0;
};

/// Rows across and along `direction`; which way x and y turn around it does not matter.
glm::dmat3 light_from_world(const glm::dvec3& direction) {
    const glm::dvec3 a = glm::abs(direction);
    const glm::dvec3 helper = a.y < 0.9 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(0.0, 0.0, 1.0);
    const glm::dvec3 x = glm::normalize(glm::cross(helper, direction));
    const glm::dvec3 y = glm::cross(direction, x);
    return glm::transpose(glm::dmat3(x, y, direction));
}

/// Of the box's projection on a unit direction.
Interval project(const Box& box, const glm::dvec3& direction) {
    const double middle = glm::dot(direction, box.center());
    const double half = glm::dot(glm::abs(direction), 0.5 * box.extent());
    return {middle - half, middle + half};
}

glm::dvec3 row(const glm::dmat3& m, int i) {
    return {m[0][i], m[1][i], m[2][i]};
}

/// The view depth at which shadows end. Found from the scene it is rounded up to a power of the square root of 2, so
/// that a moving camera seldom changes it and with it the size of the cascades.
double shadow_range_m(const FrameView& view, const Box& casters, const CascadeSettings& settings) {
    double range_m = 0.0;
    if (settings.range_m) {
        range_m = *settings.range_m;
    } else {
        const double reach_m =
            glm::length(casters.center() - view.origin_m) + 0.5 * glm::length(casters.extent()) + 1e-6;
        range_m = std::exp2(0.5 * std::ceil(2.0 * std::log2(reach_m)));
    }
    return std::min(range_m, far_depth_m(view));
}

/// Practical splits (Zhang, Sun, Xu and Lun, Parallel-Split Shadow Maps for Large-scale Virtual Environments, 2006): a
/// mean of equal ratios and equal lengths. The ratios start at a fraction of the range and not at the near plane, whose
/// closeness says nothing about the scene.
std::array<double, most_cascades> split_depths_m(double near_m, double range_m, const CascadeSettings& settings) {
    const double start_m = std::clamp(near_m, 0.005 * range_m, 0.5 * range_m);
    std::array<double, most_cascades> splits{};
    for (std::uint32_t i = 0; i < settings.count; ++i) {
        const double t = static_cast<double>(i + 1) / settings.count;
        const double even_ratio = start_m * std::pow(range_m / start_m, t);
        splits[i] = settings.log_share * even_ratio + (1.0 - settings.log_share) * range_m * t;
    }
    return splits;
}

struct SliceSphere {
    double depth_m = 0.0; ///< of its middle, on the view's axis
    double radius_m = 0.0;
};

/// The smallest sphere with its middle on the view's axis that holds the slice.
SliceSphere slice_sphere(const FrameView& view, double start_m, double end_m) {
    const glm::dvec2 half = 1.0 / glm::abs(glm::dvec2(view.clip_from_view[0][0], view.clip_from_view[1][1]));
    const double half_diagonal = glm::length(half);
    const bool perspective = is_perspective(view);
    const double start_radius_m = perspective ? half_diagonal * start_m : half_diagonal;
    const double end_radius_m = perspective ? half_diagonal * end_m : half_diagonal;
    // The depth that is equally far from the near and the far corners, if it lies within the slice.
    const double length_m = end_m - start_m;
    const double equal =
        0.5 * (start_m + end_m) + 0.5 * (end_radius_m - start_radius_m) * (end_radius_m + start_radius_m) / length_m;
    SliceSphere sphere;
    sphere.depth_m = std::clamp(equal, start_m, end_m);
    sphere.radius_m = std::max(std::hypot(sphere.depth_m - start_m, start_radius_m),
                               std::hypot(end_m - sphere.depth_m, end_radius_m));
    return sphere;
}

} // namespace

CascadesFit fit_cascades(const FrameView& view, const Box& casters, const glm::dvec3& direction,
                         const CascadeSettings& settings) {
    CascadesFit fit;
    fit.light_from_world = light_from_world(direction);
    fit.count = settings.count;
    fit.resolution = settings.resolution;
    const Interval depth = project(casters, row(fit.light_from_world, 2));
    // A little more than the casters, for rounding, and something where they are flat.
    const double margin_m = std::max(0.005 * glm::length(casters.extent()), 1e-4);
    fit.near_m = depth.low - margin_m;
    fit.range_m = depth.high - depth.low + 2.0 * margin_m;

    const double near_m = is_perspective(view) ? view.clip_from_view[3][2] : 0.0;
    const double range_m = shadow_range_m(view, casters, settings);
    const std::array<double, most_cascades> splits = split_depths_m(near_m, range_m, settings);
    const glm::dvec3 forward = -row(glm::dmat3(view.view_from_render), 2);
    for (std::uint32_t i = 0; i < settings.count; ++i) {
        CascadeFit& cascade = fit.cascades[i];
        cascade.start_depth_m = i == 0 ? 0.0 : splits[i - 1];
        cascade.end_depth_m = splits[i];
        const SliceSphere sphere = slice_sphere(view, cascade.start_depth_m, cascade.end_depth_m);
        const double inner_texels = static_cast<double>(settings.resolution) - 2.0 * border_texels;
        cascade.texel_m = 2.0 * sphere.radius_m / inner_texels;
        const glm::dvec3 center = fit.light_from_world * (view.origin_m + sphere.depth_m * forward);
        cascade.center_m = glm::floor(glm::dvec2(center) / cascade.texel_m) * cascade.texel_m;
        // In steps, so that a small movement does not ask for another image.
        cascade.farthest_m = std::ceil(center.z / sphere.radius_m + 1.0) * sphere.radius_m;
    }
    return fit;
}

bool same_texels(const CascadesFit& a, const CascadesFit& b, std::uint32_t cascade) {
    const CascadeFit& one = a.cascades[cascade];
    const CascadeFit& other = b.cascades[cascade];
    // What lies behind the slice may be missing from the image: it must reach at least as far as it is now needed.
    return a.light_from_world == b.light_from_world && a.resolution == b.resolution && a.near_m == b.near_m &&
           a.range_m == b.range_m && one.center_m == other.center_m && one.texel_m == other.texel_m &&
           one.farthest_m >= other.farthest_m;
}

glm::dmat4 shadow_from_render(const CascadesFit& fit, std::uint32_t cascade, const glm::dvec3& origin_m) {
    const CascadeFit& c = fit.cascades[cascade];
    const double side_m = c.texel_m * static_cast<double>(fit.resolution);
    const glm::dvec3 scale(1.0 / side_m, 1.0 / side_m, 1.0 / fit.range_m);
    const glm::dvec3 corner(c.center_m - 0.5 * side_m, fit.near_m);
    const glm::dvec3 offset = (fit.light_from_world * origin_m - corner) * scale;
    glm::dmat4 m(1.0);
    for (int column = 0; column < 3; ++column) {
        m[column] = glm::dvec4(fit.light_from_world[column] * scale, 0.0);
    }
    m[3] = glm::dvec4(offset, 1.0);
    return m;
}

gpu::SunCascades make_sun_cascades(const CascadesFit& fit, const glm::dvec3& origin_m,
                                   const glm::vec3& illuminance_lux) {
    gpu::SunCascades out{};
    for (std::uint32_t i = 0; i < most_cascades; ++i) {
        const std::uint32_t cascade = std::min(i, fit.count - 1); // the rest repeat the last one
        const int component = static_cast<int>(i);
        out.shadow_from_render[i] = glm::mat4(shadow_from_render(fit, cascade, origin_m));
        out.split_depth_m[component] = static_cast<float>(fit.cascades[cascade].end_depth_m);
        out.depth_range_m[component] = static_cast<float>(fit.range_m);
        out.texel_m[component] = static_cast<float>(fit.cascades[cascade].texel_m);
    }
    out.direction_count = glm::vec4(row(fit.light_from_world, 2), static_cast<float>(fit.count));
    out.illuminance = glm::vec4(illuminance_lux, 0.0F);
    return out;
}

bool may_cast_into(const CascadesFit& fit, std::uint32_t cascade, const Box& box) {
    const CascadeFit& c = fit.cascades[cascade];
    const double half_m = 0.5 * c.texel_m * static_cast<double>(fit.resolution);
    for (int axis = 0; axis < 2; ++axis) {
        const Interval extent = project(box, row(fit.light_from_world, axis));
        if (extent.high < c.center_m[axis] - half_m || extent.low > c.center_m[axis] + half_m) {
            return false;
        }
    }
    return project(box, row(fit.light_from_world, 2)).low <= c.farthest_m;
}

} // namespace tyndall::engine
