// Normals and tangents for geometry that comes without.
#pragma once

#include "engine/scene.hpp"

namespace tyndall::engine {

/// One vertex a triangle corner, each with its triangle's normal (glTF 2.0, section 3.7.2.1: flat when absent).
/// Triangles without area get the normal +Y.
void make_flat_normals(Primitive& primitive);

/// Replaces each normal that is not finite or has no length by the area-weighted mean of the triangles around its
/// vertex, and makes all of unit length. Returns how many were replaced.
std::size_t repair_normals(Primitive& primitive);

/// Tangents along growing u of `use`'s coordinates, orthogonal to the normal, from the triangles around each vertex
/// weighted by their corner angle. A vertex that serves triangles of both orientations in uv (mirrored charts) is
/// doubled, so that each has its own sign.
void make_tangents(Primitive& primitive, const TextureUse& use);

/// Some unit vector across each normal: for primitives whose material reads no tangent.
void make_any_tangents(Primitive& primitive);

/// Makes given tangents unit length with a sign of +1 or -1; replaces broken ones by any.
void repair_tangents(Primitive& primitive);

/// Some unit vector orthogonal to the unit vector `normal` (Duff et al., Building an Orthonormal Basis, Revisited, JCGT
/// 2017).
[[nodiscard]] glm::vec3 any_orthogonal(const glm::vec3& normal);

} // namespace tyndall::engine
