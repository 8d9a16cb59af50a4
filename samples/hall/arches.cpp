#include "samples/hall/arches.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace tyndall::hall {
namespace {

/// Direction across the curve at a point, scaled so that the moulding keeps its width around corners.
glm::vec2 across(std::span<const glm::vec2> curve, std::size_t i) {
    const bool closed = glm::distance(curve.front(), curve.back()) < 1.0e-4F;
    const std::size_t last = curve.size() - 1;
    const glm::vec2 before =
        i > 0 ? curve[i] - curve[i - 1] : (closed ? curve[last] - curve[last - 1] : curve[1] - curve[0]);
    const glm::vec2 after = i < last ? curve[i + 1] - curve[i] : (closed ? curve[1] - curve[0] : before);
    const glm::vec2 a = glm::normalize(before);
    const glm::vec2 b = glm::normalize(after);
    const glm::vec2 sum = glm::normalize(a + b);
    const float stretch = 1.0F / std::max(0.5F, glm::dot(sum, a));
    return glm::vec2{-sum.y, sum.x} * stretch;
}

std::uint32_t push(Geometry& geometry, glm::vec3 position, glm::vec3 normal, glm::vec2 uv) {
    geometry.vertices.push_back({.position = position, .normal = normal, .uv = uv});
    return static_cast<std::uint32_t>(geometry.vertices.size() - 1);
}

/// The band between two outlines of equal length, facing `toward` the middle of the opening.
void add_reveal(Geometry& geometry, const WallPlane& plane, std::span<const glm::vec2> front,
                std::span<const glm::vec2> back, float thickness_m) {
    float length_m = 0.0F;
    for (std::size_t i = 0; i + 1 < front.size(); ++i) {
        const glm::vec3 a = plane.at(front[i]);
        const glm::vec3 b = plane.at(front[i + 1]);
        if (glm::distance(a, b) < 1.0e-5F) { // the arch springs from the sill itself
            continue;
        }
        const glm::vec3 c = plane.at(back[i + 1], thickness_m);
        const glm::vec3 d = plane.at(back[i], thickness_m);
        const float next_m = length_m + glm::distance(a, b);
        // Travelling left to right over the arch the opening lies to the right of the curve.
        const glm::vec3 facing = glm::normalize(glm::cross(d - a, b - a));
        const std::array<glm::vec2, 4> uvs{glm::vec2{0.0F, -length_m}, glm::vec2{0.0F, -next_m},
                                           glm::vec2{thickness_m, -next_m}, glm::vec2{thickness_m, -length_m}};
        add_quad(geometry, {a, b, c, d}, facing, uvs);
        length_m = next_m;
    }
}

Opening mirrored(Opening opening) {
    opening.center = -opening.center;
    return opening;
}

} // namespace

float Opening::crown() const {
    return spring + half_width * std::sqrt(2.0F * pointedness - 1.0F);
}

std::vector<glm::vec2> arch_curve(float half_width, float pointedness, int steps) {
    const float radius = half_width * pointedness;
    const float offset = radius - half_width; // the left half's centre lies this far right of the middle
    const float end_angle = std::acos(std::clamp(offset / radius, 0.0F, 1.0F));
    std::vector<glm::vec2> left;
    for (int i = 0; i <= steps; ++i) {
        const float angle = end_angle * static_cast<float>(i) / static_cast<float>(steps);
        left.emplace_back(offset - radius * std::cos(angle), radius * std::sin(angle));
    }
    left.back().x = 0.0F;
    std::vector<glm::vec2> curve = left;
    for (std::size_t i = left.size() - 1; i > 0; --i) {
        curve.emplace_back(-left[i - 1].x, left[i - 1].y);
    }
    return curve;
}

std::vector<glm::vec2> opening_outline(const Opening& opening, int steps) {
    std::vector<glm::vec2> outline{{opening.center - opening.half_width, opening.sill}};
    for (const glm::vec2 point : arch_curve(opening.half_width, opening.pointedness, steps)) {
        outline.push_back(point + glm::vec2{opening.center, opening.spring});
    }
    outline.emplace_back(opening.center + opening.half_width, opening.sill);
    return outline;
}

void add_pierced_front(Geometry& geometry, const WallPlane& plane, const Panel& panel, const Opening& opening,
                       int steps) {
    const auto rectangle = [&](float left, float right, float bottom, float top) {
        if (right - left > 1.0e-4F && top - bottom > 1.0e-4F) {
            add_quad(
                geometry,
                {plane.at({left, bottom}), plane.at({right, bottom}), plane.at({right, top}), plane.at({left, top})},
                plane.normal());
        }
    };
    const float low = opening.center - opening.half_width;
    const float high = opening.center + opening.half_width;
    const std::array<float, 4> rows{panel.bottom, opening.sill, opening.spring, panel.top};
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
        rectangle(panel.left, low, rows[i], rows[i + 1]);
        rectangle(high, panel.right, rows[i], rows[i + 1]);
    }
    rectangle(low, high, panel.bottom, opening.sill);
    const std::vector<glm::vec2> arch = arch_curve(opening.half_width, opening.pointedness, steps);
    const glm::vec2 base{opening.center, opening.spring};
    for (std::size_t i = 0; i + 1 < arch.size(); ++i) {
        const glm::vec2 a = base + arch[i];
        const glm::vec2 b = base + arch[i + 1];
        add_quad(geometry, {plane.at(a), plane.at(b), plane.at({b.x, panel.top}), plane.at({a.x, panel.top})},
                 plane.normal());
    }
}

void add_pierced_wall(Geometry& geometry, const WallPlane& plane, const Panel& panel, const Opening& front,
                      const Opening& back, float thickness_m, int steps) {
    add_pierced_front(geometry, plane, panel, front, steps);
    const WallPlane behind{plane.at({0.0F, 0.0F}, thickness_m), -plane.right};
    const Panel mirrored_panel{-panel.right, -panel.left, panel.bottom, panel.top};
    add_pierced_front(geometry, behind, mirrored_panel, mirrored(back), steps);
    std::vector<glm::vec2> front_outline = opening_outline(front, steps);
    std::vector<glm::vec2> back_outline = opening_outline(back, steps);
    if (front.sill > panel.bottom + 1.0e-4F) { // close the band with the sill
        front_outline.push_back(front_outline.front());
        back_outline.push_back(back_outline.front());
    } else { // the undersides of the two piers
        const float low = front.center - front.half_width;
        const float high = front.center + front.half_width;
        for (const glm::vec2 pier : {glm::vec2{panel.left, low}, glm::vec2{high, panel.right}}) {
            add_quad(geometry,
                     {plane.at({pier.x, panel.bottom}), plane.at({pier.y, panel.bottom}),
                      plane.at({pier.y, panel.bottom}, thickness_m), plane.at({pier.x, panel.bottom}, thickness_m)},
                     {0.0F, -1.0F, 0.0F});
        }
    }
    add_reveal(geometry, plane, front_outline, back_outline, thickness_m);
}

void add_filling(Geometry& geometry, const WallPlane& plane, const Opening& opening, float depth_m, int steps,
                 bool unit_uv) {
    const std::vector<glm::vec2> outline = opening_outline(opening, steps);
    const glm::vec2 low{opening.center - opening.half_width, opening.sill};
    const glm::vec2 size{2.0F * opening.half_width, opening.crown() - opening.sill};
    const glm::vec2 scale = unit_uv ? glm::vec2{1.0F} / size : glm::vec2{1.0F};
    const auto add_point = [&](glm::vec2 point) {
        const glm::vec2 relative = (point - low) * scale;
        const glm::vec2 uv{relative.x, (unit_uv ? 1.0F : 0.0F) - relative.y};
        return push(geometry, plane.at(point, depth_m), plane.normal(), uv);
    };
    // Horizontal strips between the two sides of the outline: point i on the left meets point n-1-i on the right.
    const std::size_t count = outline.size();
    for (std::size_t i = 0; i + 1 < count / 2 + 1; ++i) {
        const std::uint32_t a = add_point(outline[i]);
        const std::uint32_t b = add_point(outline[count - 1 - i]);
        const std::uint32_t c = add_point(outline[count - 2 - i]);
        const std::uint32_t d = add_point(outline[i + 1]);
        join_quad(geometry, a, b, c, d);
    }
}

void add_moulding(Geometry& geometry, const WallPlane& plane, std::span<const glm::vec2> curve, float half_width_m,
                  float proud_m, float depth_m) {
    // Section seen along the curve: (offset across, depth); its four sides are flat, each with the normal below.
    const std::array<glm::vec2, 5> section{glm::vec2{-half_width_m, depth_m}, glm::vec2{-half_width_m, -proud_m},
                                           glm::vec2{half_width_m, -proud_m}, glm::vec2{half_width_m, depth_m},
                                           glm::vec2{-half_width_m, depth_m}};
    float side_m = 0.0F;
    for (std::size_t side = 0; side + 1 < section.size(); ++side) {
        const float next_side_m = side_m + glm::distance(section[side], section[side + 1]);
        const glm::vec2 along = glm::normalize(section[side + 1] - section[side]);
        const glm::vec2 outward{along.y, -along.x};
        float length_m = 0.0F;
        std::uint32_t previous = 0;
        for (std::size_t i = 0; i < curve.size(); ++i) {
            if (i > 0) {
                length_m += glm::distance(curve[i], curve[i - 1]);
            }
            const glm::vec2 lateral = across(curve, i);
            const glm::vec2 unit = glm::normalize(lateral);
            const glm::vec3 normal = plane.right * (unit.x * outward.x) + glm::vec3{0.0F, unit.y * outward.x, 0.0F} -
                                     plane.normal() * outward.y;
            const std::uint32_t a = push(geometry, plane.at(curve[i] + lateral * section[side].x, section[side].y),
                                         normal, {side_m, -length_m});
            push(geometry, plane.at(curve[i] + lateral * section[side + 1].x, section[side + 1].y), normal,
                 {next_side_m, -length_m});
            if (i > 0) {
                join_quad(geometry, previous, previous + 1, a + 1, a);
            }
            previous = a;
        }
        side_m = next_side_m;
    }
}

} // namespace tyndall::hall
