// Which parts of a ray triangles keep the light of one source from: exact, in double precision.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "features/volumetrics/reference/geometry.hpp"

namespace tyndall::volumetrics::reference {

/// A tree of boxes over triangles, asked which of them touch a part of a plane.
class ShadowTree {
public:
    explicit ShadowTree(const std::vector<Triangle>& triangles);

    /// See Geometry. The plane through the ray and the light cuts each triangle in a line; what lies between the ray
    /// and the light throws its shadow on the ray. Neither may be called with a ray through the light.
    [[nodiscard]] std::vector<Interval> lit_from_direction(const Ray& ray, Interval part,
                                                           const glm::dvec3& toward) const;
    [[nodiscard]] std::vector<Interval> lit_from_point(const Ray& ray, Interval part, const glm::dvec3& light) const;

private:
    struct Node {
        glm::dvec3 centre{0.0};
        glm::dvec3 half{0.0};
        std::uint32_t first = 0; ///< of its triangles, or its left child; the right one follows
        std::uint32_t count = 0; ///< 0: no leaf
    };

    void build(std::uint32_t node, std::uint32_t first, std::uint32_t count);
    template <class Wants, class Visit>
    void visit(const Wants& wants, const Visit& each) const;

    std::vector<std::array<glm::dvec3, 3>> triangles_;
    std::vector<Node> nodes_;
};

} // namespace tyndall::volumetrics::reference
