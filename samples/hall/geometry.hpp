#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace tyndall::hall {

/// Texture coordinates are kept in metres until the material, which knows the size of its tile, is applied.
struct Vertex {
    glm::vec3 position{0.0F};
    glm::vec3 normal{0.0F, 1.0F, 0.0F};
    glm::vec2 uv{0.0F};
    glm::vec4 tangent{1.0F, 0.0F, 0.0F, 1.0F};
};

/// An indexed triangle list. Faces are counter-clockwise seen from the side that their normals point to.
struct Geometry {
    std::vector<Vertex> vertices;
    std::vector<std::uint32_t> indices;
};

/// Planar texture coordinates in metres for a face: u to the right and v downwards as seen from its front.
[[nodiscard]] glm::vec2 planar_uv(glm::vec3 position, glm::vec3 facing);

/// Joins four existing vertices into two triangles wound to agree with the vertex normals; triangles without area are
/// dropped.
void join_quad(Geometry& geometry, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d);

/// A flat quad facing `facing`, corners in order around it, with planar texture coordinates.
void add_quad(Geometry& geometry, const std::array<glm::vec3, 4>& corners, glm::vec3 facing);

/// A flat quad with texture coordinates of its own (in the same order as the corners).
void add_quad(Geometry& geometry, const std::array<glm::vec3, 4>& corners, glm::vec3 facing,
              const std::array<glm::vec2, 4>& uvs);

/// An axis-aligned solid box; `bevel_m` > 0 cuts its edges at 45 degrees.
void add_box(Geometry& geometry, glm::vec3 low, glm::vec3 high, float bevel_m = 0.0F);

/// A solid square bar between two points.
void add_bar(Geometry& geometry, glm::vec3 from, glm::vec3 to, float half_thickness_m);

/// How a profile is turned around the y axis.
struct Lathe {
    int segments = 32;
    /// Length given to one turn in texture coordinates: a whole number of tiles leaves no seam.
    float turn_uv_m = 1.0F;
    /// Flat facets (an octagonal plinth) in place of a smooth round.
    bool faceted = false;
};

/// Turns a profile of (radius, y) points around the y axis. The solid lies to the left of the direction of travel:
/// upwards on the outside of a column, downwards inside a bowl. Corners sharper than 35 degrees stay sharp.
void add_lathe(Geometry& geometry, std::span<const glm::vec2> profile, const Lathe& lathe);

/// Appends `source` moved by a rigid transform with uniform scale.
void append(Geometry& target, const Geometry& source, const glm::mat4& transform);

/// Per-vertex tangents from positions and texture coordinates, w such that cross(normal, tangent) * w points against v
/// (glTF 2.0, section 3.7.2.1: texture v runs downwards, the normal texture's green upwards).
void compute_tangents(Geometry& geometry);

} // namespace tyndall::hall
