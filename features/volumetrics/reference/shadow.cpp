#include "features/volumetrics/reference/shadow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace tyndall::volumetrics::reference {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t leaf_size = 4;

/// Coordinates in the plane of ray and light: `along` the ray from its origin, `toward` the light, `off` the plane.
struct Plane {
    glm::dvec3 origin;
    glm::dvec3 along;
    glm::dvec3 toward;
    glm::dvec3 off;

    [[nodiscard]] double along_of(const glm::dvec3& p) const { return glm::dot(p - origin, along); }
    [[nodiscard]] double toward_of(const glm::dvec3& p) const { return glm::dot(p - origin, toward); }
    [[nodiscard]] double off_of(const glm::dvec3& p) const { return glm::dot(p - origin, off); }
};

/// A point of the plane.
struct Point {
    double along;
    double toward;
};
using Segment = std::pair<Point, Point>;

/// The same bits whichever way round the edge is given, so that neighbours leave no gap.
Point cut_edge(const Plane& plane, glm::dvec3 a, glm::dvec3 b, double off_a, double off_b) {
    if (std::array{a.x, a.y, a.z} > std::array{b.x, b.y, b.z}) {
        std::swap(a, b);
        std::swap(off_a, off_b);
    }
    const glm::dvec3 p = a + (b - a) * (off_a / (off_a - off_b));
    return {plane.along_of(p), plane.toward_of(p)};
}

/// The line in which the plane cuts the triangle. None if they do not meet or lie in each other.
std::optional<Segment> cut(const Plane& plane, const std::array<glm::dvec3, 3>& triangle) {
    std::array<double, 3> off{};
    for (std::size_t i = 0; i < 3; ++i) {
        off[i] = plane.off_of(triangle[i]);
    }
    std::array<Point, 2> ends{};
    std::size_t count = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        if ((off[i] < 0.0) != (off[j] < 0.0)) {
            ends[count++] = cut_edge(plane, triangle[i], triangle[j], off[i], off[j]);
        }
    }
    return count == 2 ? std::optional(Segment{ends[0], ends[1]}) : std::nullopt;
}

/// The part of the segment with low < toward < high.
std::optional<Segment> clip(Segment s, double low, double high) {
    if (s.first.toward > s.second.toward) {
        std::swap(s.first, s.second);
    }
    if (!(s.second.toward > low && s.first.toward < high)) {
        return std::nullopt;
    }
    const auto at = [&](double toward) {
        const double f = (toward - s.first.toward) / (s.second.toward - s.first.toward);
        return Point{s.first.along + f * (s.second.along - s.first.along), toward};
    };
    const Segment whole = s;
    if (whole.first.toward < low) {
        s.first = at(low);
    }
    if (whole.second.toward > high) {
        s.second = at(high);
    }
    return s;
}

/// `part` without the union of `shadows`. Gaps between shadows that rounding opens between neighbours are closed.
std::vector<Interval> without(Interval part, std::vector<Interval> shadows) {
    std::sort(shadows.begin(), shadows.end(), [](const Interval& a, const Interval& b) { return a.begin < b.begin; });
    std::vector<Interval> lit;
    double reached = part.begin;
    const auto add = [&](double end) {
        if (end - reached > 1e-12 * (1.0 + std::abs(reached))) {
            lit.push_back({reached, end});
        }
    };
    for (const Interval& shadow : shadows) {
        if (shadow.begin >= part.end) {
            break;
        }
        if (shadow.end > reached) {
            add(shadow.begin);
            reached = std::max(reached, shadow.end);
        }
    }
    if (reached < part.end) {
        add(part.end);
    }
    return lit;
}

} // namespace

ShadowTree::ShadowTree(const std::vector<Triangle>& triangles) {
    for (const Triangle& triangle : triangles) {
        triangles_.push_back(triangle.corners);
    }
    if (!triangles_.empty()) {
        nodes_.emplace_back();
        build(0, 0, static_cast<std::uint32_t>(triangles_.size()));
    }
}

void ShadowTree::build(std::uint32_t node, std::uint32_t first, std::uint32_t count) {
    glm::dvec3 low(infinity);
    glm::dvec3 high(-infinity);
    for (std::uint32_t i = first; i < first + count; ++i) {
        for (const glm::dvec3& corner : triangles_[i]) {
            low = glm::min(low, corner);
            high = glm::max(high, corner);
        }
    }
    nodes_[node].centre = 0.5 * (low + high);
    // Wider by more than the rounding of the tests against it.
    nodes_[node].half = 0.5 * (high - low) + 1e-12 * (glm::abs(low) + glm::abs(high));
    if (count <= leaf_size) {
        nodes_[node].first = first;
        nodes_[node].count = count;
        return;
    }
    const glm::dvec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const auto middle_of = [axis](const std::array<glm::dvec3, 3>& t) { return t[0][axis] + t[1][axis] + t[2][axis]; };
    const auto begin = triangles_.begin() + first;
    const std::uint32_t left = count / 2;
    std::nth_element(begin, begin + left, begin + count,
                     [&](const auto& a, const auto& b) { return middle_of(a) < middle_of(b); });
    const auto child = static_cast<std::uint32_t>(nodes_.size());
    nodes_[node].first = child;
    nodes_.resize(nodes_.size() + 2);
    build(child, first, left);
    build(child + 1, first + left, count - left);
}

/// Calls `each` with every triangle in a box that the half-plane may touch: where `wants` is true of the box's centre
/// and half size.
template <class Wants, class Visit>
void ShadowTree::visit(const Wants& wants, const Visit& each) const {
    std::array<std::uint32_t, 64> open{};
    std::size_t count = nodes_.empty() ? 0 : 1;
    while (count > 0) {
        const Node& node = nodes_[open[--count]];
        if (!wants(node.centre, node.half)) {
            continue;
        }
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
            each(triangles_[i]);
        }
        if (node.count == 0) {
            open[count++] = node.first;
            open[count++] = node.first + 1;
        }
    }
}

std::vector<Interval> ShadowTree::lit_from_direction(const Ray& ray, Interval part, const glm::dvec3& toward) const {
    // Oblique coordinates: p = origin + along * direction + toward * light.
    const glm::dvec3 off = glm::normalize(glm::cross(ray.direction, toward));
    const glm::dvec3 across_light = glm::cross(toward, off);
    const glm::dvec3 across_ray = glm::cross(off, ray.direction);
    const Plane plane{ray.origin, across_light / glm::dot(across_light, ray.direction),
                      across_ray / glm::dot(across_ray, toward), off};
    std::vector<Interval> shadows;
    const auto wants = [&](const glm::dvec3& centre, const glm::dvec3& half) {
        const double along = plane.along_of(centre);
        const double reach = glm::dot(glm::abs(plane.along), half);
        return std::abs(plane.off_of(centre)) <= glm::dot(glm::abs(off), half) &&
               plane.toward_of(centre) + glm::dot(glm::abs(plane.toward), half) >= 0.0 && along + reach >= part.begin &&
               along - reach <= part.end;
    };
    visit(wants, [&](const std::array<glm::dvec3, 3>& triangle) {
        const std::optional<Segment> line = cut(plane, triangle);
        const std::optional<Segment> blocker = line ? clip(*line, 0.0, infinity) : std::nullopt;
        if (blocker) {
            const double first = blocker->first.along;
            const double second = blocker->second.along;
            shadows.push_back({std::min(first, second), std::max(first, second)});
        }
    });
    return without(part, std::move(shadows));
}

std::vector<Interval> ShadowTree::lit_from_point(const Ray& ray, Interval part, const glm::dvec3& light) const {
    const double foot = glm::dot(light - ray.origin, ray.direction);
    const glm::dvec3 up = light - point_at(ray, foot);
    const double height = glm::length(up);
    const Plane plane{ray.origin, ray.direction, up / height, glm::normalize(glm::cross(ray.direction, up))};
    std::vector<Interval> shadows;
    const auto wants = [&](const glm::dvec3& centre, const glm::dvec3& half) {
        const double toward = plane.toward_of(centre);
        const double reach = glm::dot(glm::abs(plane.toward), half);
        return std::abs(plane.off_of(centre)) <= glm::dot(glm::abs(plane.off), half) && toward + reach >= 0.0 &&
               toward - reach <= height;
    };
    // Where the line from the light through a point of the plane meets the ray.
    const auto thrown = [&](const Point& p) {
        const double rest = height - p.toward;
        const double offset = p.along - foot;
        return rest > 0.0 ? foot + offset * (height / rest) : std::copysign(infinity, offset);
    };
    visit(wants, [&](const std::array<glm::dvec3, 3>& triangle) {
        const std::optional<Segment> line = cut(plane, triangle);
        const std::optional<Segment> blocker = line ? clip(*line, 0.0, height) : std::nullopt;
        if (blocker) {
            const double first = thrown(blocker->first);
            const double second = thrown(blocker->second);
            shadows.push_back({std::min(first, second), std::max(first, second)});
        }
    });
    return without(part, std::move(shadows));
}

} // namespace tyndall::volumetrics::reference
