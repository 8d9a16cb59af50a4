#include "engine/tangent_space.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace tyndall::engine {
namespace {

constexpr std::uint32_t none = 0xFFFFFFFFU;

glm::dvec3 position(const Primitive& primitive, std::uint32_t index) {
    return glm::dvec3(primitive.positions[index]);
}

/// Normal times twice the area. In double: the product of two edges may leave the range of float.
glm::dvec3 area_normal(const Primitive& primitive, std::size_t triangle) {
    const std::uint32_t* corner = &primitive.indices[3 * triangle];
    const glm::dvec3 origin = position(primitive, corner[0]);
    return glm::cross(position(primitive, corner[1]) - origin, position(primitive, corner[2]) - origin);
}

/// `fallback` for a vector without length.
glm::vec3 unit_or(const glm::dvec3& vector, const glm::vec3& fallback) {
    const double length = glm::length(vector);
    return length > 0.0 && std::isfinite(length) ? glm::vec3(vector / length) : fallback;
}

template <typename T>
void gather(std::vector<T>& values, const std::vector<std::uint32_t>& indices) {
    std::vector<T> gathered;
    gathered.reserve(indices.size());
    for (const std::uint32_t index : indices) {
        gathered.push_back(values[index]);
    }
    values = std::move(gathered);
}

/// How positions move with a triangle's texture coordinates.
struct Gradient {
    glm::dvec3 along_u{0.0};
    int sign = 0; ///< of the area in uv; 0: no gradient
};

Gradient uv_gradient(const Primitive& primitive, std::size_t triangle, const TextureUse& use) {
    const std::vector<glm::vec2>& uv = use.uv_set == 0 ? primitive.uv0 : primitive.uv1;
    const std::uint32_t* corner = &primitive.indices[3 * triangle];
    const glm::dvec3 origin = position(primitive, corner[0]);
    const glm::dvec3 edge1 = position(primitive, corner[1]) - origin;
    const glm::dvec3 edge2 = position(primitive, corner[2]) - origin;
    const glm::dvec2 uv_origin(use.apply(uv[corner[0]]));
    const glm::dvec2 uv1 = glm::dvec2(use.apply(uv[corner[1]])) - uv_origin;
    const glm::dvec2 uv2 = glm::dvec2(use.apply(uv[corner[2]])) - uv_origin;
    const double area = uv1.x * uv2.y - uv1.y * uv2.x;
    if (area == 0.0 || !std::isfinite(area)) {
        return {};
    }
    const int sign = area > 0.0 ? 1 : -1;
    return {static_cast<double>(sign) * (uv2.y * edge1 - uv1.y * edge2), sign};
}

double corner_angle(const Primitive& primitive, std::size_t triangle, std::size_t corner) {
    const std::uint32_t* indices = &primitive.indices[3 * triangle];
    const glm::dvec3 apex = position(primitive, indices[corner]);
    const glm::dvec3 a = position(primitive, indices[(corner + 1) % 3]) - apex;
    const glm::dvec3 b = position(primitive, indices[(corner + 2) % 3]) - apex;
    const double lengths = glm::length(a) * glm::length(b);
    return lengths > 0.0 ? std::acos(std::clamp(glm::dot(a, b) / lengths, -1.0, 1.0)) : 0.0;
}

std::uint32_t duplicate_vertex(Primitive& primitive, std::uint32_t index) {
    const auto copy = static_cast<std::uint32_t>(primitive.positions.size());
    const auto append = [index](auto& values) {
        const auto value = values[index];
        values.push_back(value);
    };
    append(primitive.positions);
    append(primitive.normals);
    append(primitive.uv0);
    append(primitive.uv1);
    append(primitive.colors);
    return copy;
}

/// Gives every vertex triangles of one uv orientation only. Triangles without a gradient join whichever is there.
void split_mirrored_vertices(Primitive& primitive, const std::vector<Gradient>& gradients) {
    std::vector<int> sign(primitive.positions.size(), 0);
    std::vector<std::uint32_t> mirrored(primitive.positions.size(), none);
    for (std::size_t i = 0; i < primitive.indices.size(); ++i) {
        const int wanted = gradients[i / 3].sign;
        const std::uint32_t vertex = primitive.indices[i];
        if (wanted == 0 || sign[vertex] == wanted) {
            continue;
        }
        if (sign[vertex] == 0) {
            sign[vertex] = wanted;
            continue;
        }
        if (mirrored[vertex] == none) {
            mirrored[vertex] = duplicate_vertex(primitive, vertex);
        }
        primitive.indices[i] = mirrored[vertex];
    }
}

} // namespace

glm::vec3 any_orthogonal(const glm::vec3& normal) {
    const float sign = std::copysign(1.0F, normal.z);
    const float a = -1.0F / (sign + normal.z);
    return {1.0F + sign * normal.x * normal.x * a, sign * normal.x * normal.y * a, -sign * normal.x};
}

void make_flat_normals(Primitive& primitive) {
    gather(primitive.positions, primitive.indices);
    gather(primitive.uv0, primitive.indices);
    gather(primitive.uv1, primitive.indices);
    gather(primitive.colors, primitive.indices);
    for (std::size_t i = 0; i < primitive.indices.size(); ++i) {
        primitive.indices[i] = static_cast<std::uint32_t>(i);
    }
    primitive.normals.resize(primitive.positions.size());
    for (std::size_t triangle = 0; triangle < primitive.indices.size() / 3; ++triangle) {
        const glm::vec3 normal = unit_or(area_normal(primitive, triangle), glm::vec3(0.0F, 1.0F, 0.0F));
        std::fill_n(primitive.normals.begin() + static_cast<std::ptrdiff_t>(3 * triangle), 3, normal);
    }
}

std::size_t repair_normals(Primitive& primitive) {
    const auto broken = [](const glm::vec3& normal) {
        const double squared = glm::dot(glm::dvec3(normal), glm::dvec3(normal));
        return !(squared > 1e-12) || !std::isfinite(squared);
    };
    const auto count =
        static_cast<std::size_t>(std::count_if(primitive.normals.begin(), primitive.normals.end(), broken));
    std::vector<glm::dvec3> sums;
    if (count > 0) {
        sums.resize(primitive.positions.size(), glm::dvec3(0.0));
        for (std::size_t i = 0; i < primitive.indices.size(); ++i) {
            sums[primitive.indices[i]] += area_normal(primitive, i / 3);
        }
    }
    for (std::size_t i = 0; i < primitive.normals.size(); ++i) {
        const bool replace = count > 0 && broken(primitive.normals[i]);
        const glm::dvec3 normal = replace ? sums[i] : glm::dvec3(primitive.normals[i]);
        primitive.normals[i] = unit_or(normal, glm::vec3(0.0F, 1.0F, 0.0F));
    }
    return count;
}

void make_tangents(Primitive& primitive, const TextureUse& use) {
    std::vector<Gradient> gradients(primitive.indices.size() / 3);
    for (std::size_t triangle = 0; triangle < gradients.size(); ++triangle) {
        gradients[triangle] = uv_gradient(primitive, triangle, use);
    }
    split_mirrored_vertices(primitive, gradients);

    std::vector<glm::dvec3> sums(primitive.positions.size(), glm::dvec3(0.0));
    std::vector<float> signs(primitive.positions.size(), 1.0F);
    for (std::size_t i = 0; i < primitive.indices.size(); ++i) {
        const Gradient& gradient = gradients[i / 3];
        if (gradient.sign == 0) {
            continue;
        }
        const std::uint32_t vertex = primitive.indices[i];
        const glm::dvec3 normal(primitive.normals[vertex]);
        const glm::dvec3 across = gradient.along_u - normal * glm::dot(normal, gradient.along_u);
        sums[vertex] += glm::dvec3(unit_or(across, glm::vec3(0.0F))) * corner_angle(primitive, i / 3, i % 3);
        // v points down the image: a chart that is counter-clockwise with v down reads mirrored with v up, hence the
        // minus.
        signs[vertex] = gradient.sign > 0 ? -1.0F : 1.0F;
    }
    primitive.tangents.resize(primitive.positions.size());
    for (std::size_t i = 0; i < sums.size(); ++i) {
        primitive.tangents[i] = glm::vec4(unit_or(sums[i], any_orthogonal(primitive.normals[i])), signs[i]);
    }
}

void make_any_tangents(Primitive& primitive) {
    primitive.tangents.resize(primitive.positions.size());
    for (std::size_t i = 0; i < primitive.tangents.size(); ++i) {
        primitive.tangents[i] = glm::vec4(any_orthogonal(primitive.normals[i]), 1.0F);
    }
}

void repair_tangents(Primitive& primitive) {
    for (std::size_t i = 0; i < primitive.tangents.size(); ++i) {
        const glm::vec4 given = primitive.tangents[i];
        const glm::vec3 tangent = unit_or(glm::dvec3(given), any_orthogonal(primitive.normals[i]));
        primitive.tangents[i] = glm::vec4(tangent, given.w < 0.0F ? -1.0F : 1.0F);
    }
}

} // namespace tyndall::engine
