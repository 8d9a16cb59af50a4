// Accessors of a glTF file, read with every range checked.
#pragma once

#include <cstdint>
#include <vector>

#include <tl/expected.hpp>

#include "engine/gltf_document.hpp"

namespace tyndall::engine {

/// Elements of a SCALAR or VECn accessor as floats, one after the other.
struct FloatElements {
    std::size_t count = 0;
    std::size_t components = 0;
    std::vector<float> values; ///< count * components
};

/// Any component type of glTF 2.0, sparse or not, interleaved or not, zeros without a buffer view. Normalised integers
/// map as glTF 2.0 section 3.6.2.2 says; others keep their value. Errors name the accessor.
[[nodiscard]] tl::expected<FloatElements, Error> read_floats(const GltfDocument& document, int accessor);

/// A SCALAR accessor of unsigned integers.
[[nodiscard]] tl::expected<std::vector<std::uint32_t>, Error> read_indices(const GltfDocument& document, int accessor);

} // namespace tyndall::engine
