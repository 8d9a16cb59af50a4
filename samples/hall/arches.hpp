#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "samples/hall/geometry.hpp"

namespace tyndall::hall {

/// A vertical plane to draw walls on: `right` and up (+Y) span it, seen from its front. Depth grows away from the
/// viewer.
struct WallPlane {
    glm::vec3 origin{0.0F};
    glm::vec3 right{1.0F, 0.0F, 0.0F};

    [[nodiscard]] glm::vec3 normal() const { return glm::cross(right, glm::vec3{0.0F, 1.0F, 0.0F}); }
    [[nodiscard]] glm::vec3 at(glm::vec2 point, float depth_m = 0.0F) const {
        return origin + right * point.x + glm::vec3{0.0F, point.y, 0.0F} - normal() * depth_m;
    }
};

/// An opening with a two-centred arch, in the coordinates of a wall plane, metres.
struct Opening {
    float center = 0.0F;
    float half_width = 1.0F;
    float sill = 0.0F;
    float spring = 1.0F;
    /// Arch radius over half width: 1 is a semicircle, more is pointed.
    float pointedness = 1.0F;

    [[nodiscard]] float crown() const;
};

/// A rectangle in the coordinates of a wall plane, metres.
struct Panel {
    float left = 0.0F;
    float right = 0.0F;
    float bottom = 0.0F;
    float top = 0.0F;
};

/// Points of an arch from its left spring to its right, `2 * steps + 1` of them, relative to (center, spring).
[[nodiscard]] std::vector<glm::vec2> arch_curve(float half_width, float pointedness, int steps);

/// Outline of an opening from the left end of its sill over the arch to the right end: `2 * steps + 3` points.
[[nodiscard]] std::vector<glm::vec2> opening_outline(const Opening& opening, int steps);

/// The front of a wall with an opening in it; no vertex stands on the middle of a neighbour's edge.
void add_pierced_front(Geometry& geometry, const WallPlane& plane, const Panel& panel, const Opening& opening,
                       int steps);

/// A solid wall with an opening: front, back and the reveal between them (splayed when the openings differ), with the
/// sill when the opening starts above the bottom of the panel, with the undersides of the piers when it does not.
void add_pierced_wall(Geometry& geometry, const WallPlane& plane, const Panel& panel, const Opening& front,
                      const Opening& back, float thickness_m, int steps);

/// A flat sheet that fills an opening at a depth, both sides drawn by a double-sided material. Texture coordinates run
/// over the bounding box of the opening: [0, width] and [-height, 0] metres when `unit_uv` is false, the unit square
/// when it is true.
void add_filling(Geometry& geometry, const WallPlane& plane, const Opening& opening, float depth_m, int steps,
                 bool unit_uv);

/// A moulding of rectangular section that follows a curve of the plane: `width_m` to both sides of the curve, proud of
/// the plane by `proud_m` and reaching `depth_m` behind it. Closed curves repeat their first point at the end.
void add_moulding(Geometry& geometry, const WallPlane& plane, std::span<const glm::vec2> curve, float half_width_m,
                  float proud_m, float depth_m);

} // namespace tyndall::hall
