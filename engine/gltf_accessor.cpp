#include "engine/gltf_accessor.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <span>
#include <string>

namespace tyndall::engine {
namespace {

/// An accessor without a buffer view has its size on its own word alone.
constexpr std::size_t zeros_limit = std::size_t{1} << 24;

std::size_t component_size(int type) {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT: return 4;
    default: return 0;
    }
}

std::size_t component_count(int type) {
    switch (type) {
    case TINYGLTF_TYPE_SCALAR: return 1;
    case TINYGLTF_TYPE_VEC2: return 2;
    case TINYGLTF_TYPE_VEC3: return 3;
    case TINYGLTF_TYPE_VEC4: return 4;
    default: return 0;
    }
}

template <typename T>
T load(const std::uint8_t* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
}

/// glTF 2.0, section 3.6.2.2: f = c / max for unsigned, f = max(c / max, -1) for signed integers.
template <typename T>
float integer_to_float(const std::uint8_t* bytes, bool normalized) {
    const auto value = static_cast<double>(load<T>(bytes));
    const double scale = normalized ? static_cast<double>(std::numeric_limits<T>::max()) : 1.0;
    return static_cast<float>(normalized ? std::max(value / scale, -1.0) : value);
}

float component_to_float(const std::uint8_t* bytes, int type, bool normalized) {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: return integer_to_float<std::int8_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return integer_to_float<std::uint8_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT: return integer_to_float<std::int16_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return integer_to_float<std::uint16_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return integer_to_float<std::uint32_t>(bytes, normalized);
    default: return load<float>(bytes);
    }
}

std::uint32_t component_to_index(const std::uint8_t* bytes, int type) {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return *bytes;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return load<std::uint16_t>(bytes);
    default: return load<std::uint32_t>(bytes);
    }
}

bool is_index_type(int type) {
    return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

/// `count` elements of `size` bytes, `stride` apart, from `offset` of a buffer view on.
struct Strided {
    const std::uint8_t* first = nullptr;
    std::size_t stride = 0;
};

tl::expected<Strided, Error> strided(const GltfDocument& document, const std::string& label, int view,
                                     std::size_t offset, std::size_t count, std::size_t size) {
    const auto bytes = buffer_view_bytes(document, view);
    if (!bytes) {
        return tl::unexpected(Error{label + " cannot be read: " + bytes.error().message});
    }
    const std::size_t declared = document.model.bufferViews[static_cast<std::size_t>(view)].byteStride;
    const std::size_t stride = declared == 0 ? size : declared;
    if (stride < size) {
        return tl::unexpected(Error{label + " has elements of " + std::to_string(size) + " bytes, but buffer view " +
                                    std::to_string(view) + " steps by " + std::to_string(stride)});
    }
    const bool fits = offset <= bytes->size() && size <= bytes->size() - offset &&
                      count - 1 <= (bytes->size() - offset - size) / stride;
    if (!fits) {
        return tl::unexpected(Error{label + " reads past the end of buffer view " + std::to_string(view)});
    }
    return Strided{bytes->data() + offset, stride};
}

/// Overwrites the elements that the sparse part lists (glTF 2.0, section 3.6.2.3).
tl::expected<void, Error> apply_sparse(const GltfDocument& document, const tinygltf::Accessor& accessor,
                                       const std::string& label, std::size_t size, Bytes& packed) {
    const auto& sparse = accessor.sparse;
    if (sparse.count < 1 || static_cast<std::size_t>(sparse.count) > accessor.count || sparse.indices.byteOffset < 0 ||
        sparse.values.byteOffset < 0 || !is_index_type(sparse.indices.componentType)) {
        return tl::unexpected(Error{label + " has a sparse part with an impossible count, offset or index type"});
    }
    const auto count = static_cast<std::size_t>(sparse.count);
    const int index_type = sparse.indices.componentType;
    const auto indices =
        strided(document, label + " (sparse indices)", sparse.indices.bufferView,
                static_cast<std::size_t>(sparse.indices.byteOffset), count, component_size(index_type));
    if (!indices) {
        return tl::unexpected(indices.error());
    }
    const auto values = strided(document, label + " (sparse values)", sparse.values.bufferView,
                                static_cast<std::size_t>(sparse.values.byteOffset), count, size);
    if (!values) {
        return tl::unexpected(values.error());
    }
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t target = component_to_index(indices->first + i * indices->stride, index_type);
        if (target >= accessor.count) {
            return tl::unexpected(Error{label + " has a sparse index " + std::to_string(target) + " but only " +
                                        std::to_string(accessor.count) + " elements"});
        }
        std::memcpy(packed.data() + target * size, values->first + i * values->stride, size);
    }
    return {};
}

struct Packed {
    const tinygltf::Accessor* accessor = nullptr;
    std::string label;
    std::size_t components = 0;
    std::size_t component_size = 0;
    Bytes bytes; ///< elements without gaps
};

tl::expected<Packed, Error> pack(const GltfDocument& document, int index) {
    if (!gltf_index_ok(index, document.model.accessors.size())) {
        return tl::unexpected(Error{"there is no accessor " + std::to_string(index)});
    }
    const tinygltf::Accessor& accessor = document.model.accessors[static_cast<std::size_t>(index)];
    Packed packed{&accessor,
                  gltf_label("accessor", static_cast<std::size_t>(index), accessor.name),
                  component_count(accessor.type),
                  component_size(accessor.componentType),
                  {}};
    if (packed.component_size == 0) {
        return tl::unexpected(Error{packed.label + " has the component type " + std::to_string(accessor.componentType) +
                                    ", which glTF does not have"});
    }
    if (packed.components == 0) {
        return tl::unexpected(Error{packed.label + " holds matrices where numbers or vectors are needed"});
    }
    if (accessor.count == 0) {
        return tl::unexpected(Error{packed.label + " has no elements"});
    }
    const std::size_t size = packed.components * packed.component_size;
    if (accessor.bufferView >= 0) {
        const auto source =
            strided(document, packed.label, accessor.bufferView, accessor.byteOffset, accessor.count, size);
        if (!source) {
            return tl::unexpected(source.error());
        }
        packed.bytes.resize(accessor.count * size);
        for (std::size_t i = 0; i < accessor.count; ++i) {
            std::memcpy(packed.bytes.data() + i * size, source->first + i * source->stride, size);
        }
    } else if (accessor.count <= zeros_limit) {
        packed.bytes.resize(accessor.count * size);
    } else {
        return tl::unexpected(Error{packed.label + " has " + std::to_string(accessor.count) +
                                    " elements but no buffer view that holds them"});
    }
    if (accessor.sparse.isSparse) {
        if (auto applied = apply_sparse(document, accessor, packed.label, size, packed.bytes); !applied) {
            return tl::unexpected(applied.error());
        }
    }
    return packed;
}

} // namespace

tl::expected<FloatElements, Error> read_floats(const GltfDocument& document, int accessor) {
    const auto packed = pack(document, accessor);
    if (!packed) {
        return tl::unexpected(packed.error());
    }
    FloatElements elements{packed->accessor->count, packed->components, {}};
    elements.values.resize(elements.count * elements.components);
    for (std::size_t i = 0; i < elements.values.size(); ++i) {
        elements.values[i] = component_to_float(packed->bytes.data() + i * packed->component_size,
                                                packed->accessor->componentType, packed->accessor->normalized);
    }
    return elements;
}

tl::expected<std::vector<std::uint32_t>, Error> read_indices(const GltfDocument& document, int accessor) {
    const auto packed = pack(document, accessor);
    if (!packed) {
        return tl::unexpected(packed.error());
    }
    const int type = packed->accessor->componentType;
    if (packed->components != 1 || !is_index_type(type)) {
        return tl::unexpected(Error{packed->label + " holds indices, so it should be SCALAR of unsigned integers"});
    }
    std::vector<std::uint32_t> indices(packed->accessor->count);
    for (std::size_t i = 0; i < indices.size(); ++i) {
        indices[i] = component_to_index(packed->bytes.data() + i * packed->component_size, type);
    }
    return indices;
}

} // namespace tyndall::engine
