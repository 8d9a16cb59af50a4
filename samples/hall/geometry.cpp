#include "samples/hall/geometry.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>

namespace tyndall::hall {
namespace {

constexpr float two_pi = 2.0F * std::numbers::pi_v<float>;
constexpr float crease_cosine = 0.819F; // cos 35 degrees

void join_triangle(Geometry& geometry, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const Vertex& va = geometry.vertices[a];
    const Vertex& vb = geometry.vertices[b];
    const Vertex& vc = geometry.vertices[c];
    const glm::vec3 area = glm::cross(vb.position - va.position, vc.position - va.position);
    if (glm::length(area) < 1.0e-8F) {
        return;
    }
    const bool agrees = glm::dot(area, va.normal + vb.normal + vc.normal) >= 0.0F;
    geometry.indices.insert(geometry.indices.end(), {a, agrees ? b : c, agrees ? c : b});
}

std::uint32_t push(Geometry& geometry, const Vertex& vertex) {
    geometry.vertices.push_back(vertex);
    return static_cast<std::uint32_t>(geometry.vertices.size() - 1);
}

/// Corner of a box: each sign component is -1 or +1; `inset` is what the bevel takes from each side.
glm::vec3 box_corner(glm::vec3 center, glm::vec3 half, glm::vec3 sign, glm::vec3 inset) {
    return center + sign * (half - inset);
}

void add_box_faces(Geometry& geometry, glm::vec3 center, glm::vec3 half, float bevel) {
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3;
        const int v = (axis + 2) % 3;
        for (const float side : {-1.0F, 1.0F}) {
            glm::vec3 inset{bevel};
            inset[axis] = 0.0F;
            std::array<glm::vec3, 4> corners{};
            for (std::size_t i = 0; i < 4; ++i) {
                glm::vec3 sign{0.0F};
                sign[axis] = side;
                sign[u] = (i == 0 || i == 3) ? -1.0F : 1.0F;
                sign[v] = i < 2 ? -1.0F : 1.0F;
                corners[i] = box_corner(center, half, sign, inset);
            }
            glm::vec3 facing{0.0F};
            facing[axis] = side;
            add_quad(geometry, corners, facing);
        }
    }
}

void add_box_edges(Geometry& geometry, glm::vec3 center, glm::vec3 half, float bevel) {
    for (int axis = 0; axis < 3; ++axis) { // the edge runs along `axis`
        const int u = (axis + 1) % 3;
        const int v = (axis + 2) % 3;
        for (const float su : {-1.0F, 1.0F}) {
            for (const float sv : {-1.0F, 1.0F}) {
                glm::vec3 low{0.0F};
                low[u] = su;
                low[v] = sv;
                glm::vec3 high = low;
                low[axis] = -1.0F;
                high[axis] = 1.0F;
                glm::vec3 on_u{bevel};
                on_u[u] = 0.0F;
                glm::vec3 on_v{bevel};
                on_v[v] = 0.0F;
                glm::vec3 facing{0.0F};
                facing[u] = su;
                facing[v] = sv;
                add_quad(geometry,
                         {box_corner(center, half, low, on_u), box_corner(center, half, high, on_u),
                          box_corner(center, half, high, on_v), box_corner(center, half, low, on_v)},
                         glm::normalize(facing));
            }
        }
    }
}

void add_box_corners(Geometry& geometry, glm::vec3 center, glm::vec3 half, float bevel) {
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 sign{(corner & 1) != 0 ? 1.0F : -1.0F, (corner & 2) != 0 ? 1.0F : -1.0F,
                             (corner & 4) != 0 ? 1.0F : -1.0F};
        const glm::vec3 facing = glm::normalize(sign);
        std::array<std::uint32_t, 3> ids{};
        for (int axis = 0; axis < 3; ++axis) {
            glm::vec3 inset{bevel};
            inset[axis] = 0.0F;
            const glm::vec3 position = box_corner(center, half, sign, inset);
            ids[static_cast<std::size_t>(axis)] =
                push(geometry, {.position = position, .normal = facing, .uv = planar_uv(position, facing)});
        }
        join_triangle(geometry, ids[0], ids[1], ids[2]);
    }
}

/// One ring of a lathe: a profile point with the normal that it has in one adjoining segment (or in both, when smooth).
struct Ring {
    glm::vec2 point{0.0F};
    glm::vec2 normal{0.0F};
    float length_m = 0.0F;
    bool joins_next = false;
};

std::vector<Ring> lathe_rings(std::span<const glm::vec2> profile) {
    std::vector<glm::vec2> normals;
    for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
        const glm::vec2 along = glm::normalize(profile[i + 1] - profile[i]);
        normals.emplace_back(along.y, -along.x);
    }
    std::vector<Ring> rings;
    float length_m = 0.0F;
    for (std::size_t i = 0; i < profile.size(); ++i) {
        if (i > 0) {
            length_m += glm::distance(profile[i], profile[i - 1]);
        }
        const bool first = i == 0;
        const bool last = i + 1 == profile.size();
        if (first || last) {
            rings.push_back({profile[i], first ? normals.front() : normals.back(), length_m, first});
        } else if (glm::dot(normals[i - 1], normals[i]) > crease_cosine) {
            rings.push_back({profile[i], glm::normalize(normals[i - 1] + normals[i]), length_m, true});
        } else {
            rings.push_back({profile[i], normals[i - 1], length_m, false});
            rings.push_back({profile[i], normals[i], length_m, true});
        }
    }
    return rings;
}

void push_ring(Geometry& geometry, const Ring& ring, const Lathe& lathe, float angle, float normal_angle) {
    push(geometry,
         {.position = {ring.point.x * std::cos(angle), ring.point.y, -ring.point.x * std::sin(angle)},
          .normal = {ring.normal.x * std::cos(normal_angle), ring.normal.y, -ring.normal.x * std::sin(normal_angle)},
          .uv = {lathe.turn_uv_m * angle / two_pi, -ring.length_m}});
}

} // namespace

glm::vec2 planar_uv(glm::vec3 position, glm::vec3 facing) {
    const glm::vec3 right = std::abs(facing.y) > 0.75F
                                ? glm::vec3{1.0F, 0.0F, 0.0F}
                                : glm::normalize(glm::cross(glm::vec3{0.0F, 1.0F, 0.0F}, facing));
    const glm::vec3 up = glm::normalize(glm::cross(facing, right));
    return {glm::dot(position, right), -glm::dot(position, up)};
}

void join_quad(Geometry& geometry, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    join_triangle(geometry, a, b, c);
    join_triangle(geometry, a, c, d);
}

void add_quad(Geometry& geometry, const std::array<glm::vec3, 4>& corners, glm::vec3 facing,
              const std::array<glm::vec2, 4>& uvs) {
    std::array<std::uint32_t, 4> ids{};
    for (std::size_t i = 0; i < 4; ++i) {
        ids[i] = push(geometry, {.position = corners[i], .normal = facing, .uv = uvs[i]});
    }
    join_quad(geometry, ids[0], ids[1], ids[2], ids[3]);
}

void add_quad(Geometry& geometry, const std::array<glm::vec3, 4>& corners, glm::vec3 facing) {
    std::array<glm::vec2, 4> uvs{};
    for (std::size_t i = 0; i < 4; ++i) {
        uvs[i] = planar_uv(corners[i], facing);
    }
    add_quad(geometry, corners, facing, uvs);
}

void add_box(Geometry& geometry, glm::vec3 low, glm::vec3 high, float bevel_m) {
    const glm::vec3 center = 0.5F * (low + high);
    const glm::vec3 half = 0.5F * (high - low);
    add_box_faces(geometry, center, half, bevel_m);
    if (bevel_m > 0.0F) {
        add_box_edges(geometry, center, half, bevel_m);
        add_box_corners(geometry, center, half, bevel_m);
    }
}

void add_bar(Geometry& geometry, glm::vec3 from, glm::vec3 to, float half_thickness_m) {
    const glm::vec3 along = glm::normalize(to - from);
    const glm::vec3 helper = std::abs(along.y) > 0.9F ? glm::vec3{1.0F, 0.0F, 0.0F} : glm::vec3{0.0F, 1.0F, 0.0F};
    const glm::vec3 side = glm::normalize(glm::cross(helper, along));
    const glm::vec3 up = glm::cross(along, side);
    Geometry bar;
    const float half_length = 0.5F * glm::distance(from, to);
    add_box(bar, {-half_thickness_m, -half_thickness_m, -half_length},
            {half_thickness_m, half_thickness_m, half_length});
    const glm::mat4 transform{glm::vec4{side, 0.0F}, glm::vec4{up, 0.0F}, glm::vec4{along, 0.0F},
                              glm::vec4{0.5F * (from + to), 1.0F}};
    append(geometry, bar, transform);
}

void add_lathe(Geometry& geometry, std::span<const glm::vec2> profile, const Lathe& lathe) {
    const std::vector<Ring> rings = lathe_rings(profile);
    const float step = two_pi / static_cast<float>(lathe.segments);
    const auto base = static_cast<std::uint32_t>(geometry.vertices.size());
    const auto columns = static_cast<std::uint32_t>(lathe.faceted ? 2 * lathe.segments : lathe.segments + 1);
    for (const Ring& ring : rings) {
        for (int segment = 0; segment < lathe.segments; ++segment) {
            const float angle = step * static_cast<float>(segment);
            if (lathe.faceted) {
                push_ring(geometry, ring, lathe, angle, angle + 0.5F * step);
                push_ring(geometry, ring, lathe, angle + step, angle + 0.5F * step);
            } else {
                push_ring(geometry, ring, lathe, angle, angle);
            }
        }
        if (!lathe.faceted) {
            push_ring(geometry, ring, lathe, two_pi, 0.0F);
        }
    }
    const std::uint32_t stride = lathe.faceted ? 2U : 1U;
    for (std::uint32_t row = 0; row + 1 < rings.size(); ++row) {
        if (!rings[row].joins_next) {
            continue;
        }
        for (std::uint32_t column = 0; column + 1 < columns; column += stride) {
            const std::uint32_t near = base + row * columns + column;
            join_quad(geometry, near, near + 1, near + columns + 1, near + columns);
        }
    }
}

void append(Geometry& target, const Geometry& source, const glm::mat4& transform) {
    const auto base = static_cast<std::uint32_t>(target.vertices.size());
    const glm::mat3 rotation{transform};
    for (Vertex vertex : source.vertices) {
        vertex.position = glm::vec3{transform * glm::vec4{vertex.position, 1.0F}};
        vertex.normal = glm::normalize(rotation * vertex.normal);
        target.vertices.push_back(vertex);
    }
    for (const std::uint32_t index : source.indices) {
        target.indices.push_back(base + index);
    }
}

void compute_tangents(Geometry& geometry) {
    std::vector<glm::vec3> along_u(geometry.vertices.size(), glm::vec3{0.0F});
    std::vector<glm::vec3> along_v(geometry.vertices.size(), glm::vec3{0.0F});
    for (std::size_t i = 0; i + 2 < geometry.indices.size(); i += 3) {
        const std::array<std::uint32_t, 3> ids{geometry.indices[i], geometry.indices[i + 1], geometry.indices[i + 2]};
        const Vertex& a = geometry.vertices[ids[0]];
        const glm::vec3 edge1 = geometry.vertices[ids[1]].position - a.position;
        const glm::vec3 edge2 = geometry.vertices[ids[2]].position - a.position;
        const glm::vec2 uv1 = geometry.vertices[ids[1]].uv - a.uv;
        const glm::vec2 uv2 = geometry.vertices[ids[2]].uv - a.uv;
        const float determinant = uv1.x * uv2.y - uv2.x * uv1.y;
        if (std::abs(determinant) < 1.0e-12F) {
            continue;
        }
        for (const std::uint32_t id : ids) {
            along_u[id] += (edge1 * uv2.y - edge2 * uv1.y) / determinant;
            along_v[id] += (edge2 * uv1.x - edge1 * uv2.x) / determinant;
        }
    }
    for (std::size_t i = 0; i < geometry.vertices.size(); ++i) {
        Vertex& vertex = geometry.vertices[i];
        glm::vec3 tangent = along_u[i] - vertex.normal * glm::dot(vertex.normal, along_u[i]);
        if (glm::length(tangent) < 1.0e-6F) { // no usable texture coordinates here: any direction in the plane will do
            const glm::vec3 helper =
                std::abs(vertex.normal.x) < 0.9F ? glm::vec3{1.0F, 0.0F, 0.0F} : glm::vec3{0.0F, 0.0F, 1.0F};
            tangent = helper - vertex.normal * glm::dot(vertex.normal, helper);
        }
        tangent = glm::normalize(tangent);
        const bool upright = glm::dot(glm::cross(vertex.normal, tangent), along_v[i]) <= 0.0F;
        vertex.tangent = glm::vec4{tangent, upright ? 1.0F : -1.0F};
    }
}

} // namespace tyndall::hall
