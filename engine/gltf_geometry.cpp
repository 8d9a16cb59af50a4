#include "engine/gltf_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/gltf_accessor.hpp"
#include "engine/tangent_space.hpp"

namespace tyndall::engine {
namespace {

/// Positions beyond it cannot be told from infinity after a few products in 32 bits.
constexpr float position_limit_m = 1e12F;

/// False for NaN too.
bool in_range(const glm::vec3& position) {
    const glm::vec3 size = glm::abs(position);
    return size.x <= position_limit_m && size.y <= position_limit_m && size.z <= position_limit_m;
}

template <typename Vector>
bool all_finite(const Vector& vector) {
    for (typename Vector::length_type i = 0; i < Vector::length(); ++i) {
        if (!std::isfinite(vector[i])) {
            return false;
        }
    }
    return true;
}

template <typename Vector>
std::vector<Vector> to_vectors(const FloatElements& elements) {
    const auto length = static_cast<std::size_t>(Vector::length());
    std::vector<Vector> vectors(elements.count);
    for (std::size_t i = 0; i < elements.count; ++i) {
        for (std::size_t c = 0; c < length; ++c) {
            vectors[i][static_cast<typename Vector::length_type>(c)] = elements.values[i * elements.components + c];
        }
    }
    return vectors;
}

/// glTF 2.0, section 3.7.2.1: triangle i of a strip is (i, i + 1 + i % 2, i + 2 - i % 2), of a fan (i + 1, i + 2, 0).
std::vector<std::uint32_t> to_triangle_list(const std::vector<std::uint32_t>& indices, int mode) {
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        return {indices.begin(), indices.end() - static_cast<std::ptrdiff_t>(indices.size() % 3)};
    }
    std::vector<std::uint32_t> list;
    for (std::size_t i = 0; i + 2 < indices.size(); ++i) {
        if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
            list.insert(list.end(), {indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]});
        } else {
            list.insert(list.end(), {indices[i + 1], indices[i + 2], indices[0]});
        }
    }
    return list;
}

/// Converts one primitive; an error ends it with the label in front.
class Builder {
public:
    Builder(const GltfDocument& document, const tinygltf::Primitive& source, std::string label,
            std::vector<std::string>& notes)
        : document_(document), source_(source), label_(std::move(label)), notes_(notes) {}

    tl::expected<std::optional<Primitive>, Error> build(std::uint32_t material, const Material& description) {
        const bool triangles = source_.mode == TINYGLTF_MODE_TRIANGLES ||
                               source_.mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
                               source_.mode == TINYGLTF_MODE_TRIANGLE_FAN;
        if (!triangles) {
            if (source_.mode < TINYGLTF_MODE_POINTS || source_.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
                return fail("has the mode " + std::to_string(source_.mode) + ", allowed are 0 to 6");
            }
            return skip("consists of points or lines");
        }
        if (!source_.attributes.contains("POSITION")) {
            return skip("has no positions");
        }
        primitive_.material = material;
        if (auto error = read_vertices()) {
            return fail(error->message);
        }
        if (auto error = read_triangles()) {
            return fail(error->message);
        }
        if (primitive_.indices.empty()) {
            return skip("has no triangle");
        }
        complete(description);
        return std::move(primitive_);
    }

private:
    template <typename Vector>
    std::optional<Error> read(const char* name, std::vector<Vector>& target) {
        const auto attribute = source_.attributes.find(name);
        if (attribute == source_.attributes.end()) {
            return std::nullopt;
        }
        auto elements = read_floats(document_, attribute->second);
        if (!elements) {
            return Error{"has a " + std::string(name) + " that cannot be read: " + elements.error().message};
        }
        if (elements->components != static_cast<std::size_t>(Vector::length())) {
            return Error{"has a " + std::string(name) + " of " + std::to_string(elements->components) +
                         " components, needed are " + std::to_string(Vector::length())};
        }
        if (!primitive_.positions.empty() && elements->count != primitive_.positions.size()) {
            return Error{"has " + std::to_string(primitive_.positions.size()) + " positions but " +
                         std::to_string(elements->count) + " elements of " + name};
        }
        target = to_vectors<Vector>(*elements);
        return std::nullopt;
    }

    std::optional<Error> read_colors() {
        const auto attribute = source_.attributes.find("COLOR_0");
        if (attribute == source_.attributes.end()) {
            return std::nullopt;
        }
        const bool there = gltf_index_ok(attribute->second, document_.model.accessors.size());
        const int type = there ? document_.model.accessors[static_cast<std::size_t>(attribute->second)].type : 0;
        if (type != TINYGLTF_TYPE_VEC3) {
            return read("COLOR_0", primitive_.colors);
        }
        std::vector<glm::vec3> opaque;
        auto error = read("COLOR_0", opaque);
        for (const glm::vec3& color : opaque) {
            primitive_.colors.emplace_back(color, 1.0F);
        }
        return error;
    }

    std::optional<Error> read_vertices() {
        if (auto error = read("POSITION", primitive_.positions)) {
            return error;
        }
        for (const glm::vec3& position : primitive_.positions) {
            if (!in_range(position)) {
                return Error{"has a position that is not finite or beyond 1e12 m"};
            }
        }
        for (const auto& error :
             {read("NORMAL", primitive_.normals), read("TANGENT", primitive_.tangents),
              read("TEXCOORD_0", primitive_.uv0), read("TEXCOORD_1", primitive_.uv1), read_colors()}) {
            if (error) {
                return error;
            }
        }
        fill(primitive_.uv0, glm::vec2(0.0F), "texture coordinates");
        fill(primitive_.uv1, glm::vec2(0.0F), "texture coordinates");
        fill(primitive_.colors, glm::vec4(1.0F), "colours");
        for (glm::vec4& color : primitive_.colors) {
            color = glm::clamp(color, 0.0F, 1.0F);
        }
        return std::nullopt;
    }

    /// Neutral values where the file has none, and for those that are not finite.
    template <typename Vector>
    void fill(std::vector<Vector>& values, const Vector& neutral, const char* what) {
        values.resize(primitive_.positions.size(), neutral);
        bool replaced = false;
        for (Vector& value : values) {
            if (!all_finite(value)) {
                value = neutral;
                replaced = true;
            }
        }
        if (replaced) {
            add_note(notes_, label_ + " has " + what + " that are not finite, which are replaced.");
        }
    }

    std::optional<Error> read_triangles() {
        std::vector<std::uint32_t> indices;
        if (source_.indices >= 0) {
            auto read = read_indices(document_, source_.indices);
            if (!read) {
                return Error{"has indices that cannot be read: " + read.error().message};
            }
            indices = std::move(*read);
        } else {
            indices.resize(primitive_.positions.size());
            std::iota(indices.begin(), indices.end(), 0U);
        }
        const std::uint32_t largest = *std::max_element(indices.begin(), indices.end());
        if (largest >= primitive_.positions.size()) {
            return Error{"has an index " + std::to_string(largest) + " but only " +
                         std::to_string(primitive_.positions.size()) + " vertices"};
        }
        if (source_.mode == TINYGLTF_MODE_TRIANGLES && indices.size() % 3 != 0) {
            add_note(notes_, label_ + " ends in an incomplete triangle, which is left out.");
        }
        primitive_.indices = to_triangle_list(indices, source_.mode);
        return std::nullopt;
    }

    void complete(const Material& material) {
        if (primitive_.normals.empty()) {
            primitive_.tangents.clear(); // given tangents go with given normals only
            make_flat_normals(primitive_);
        } else if (repair_normals(primitive_) > 0) {
            add_note(notes_, label_ + " has broken normals, which are replaced by those of its triangles.");
        }
        if (!primitive_.tangents.empty()) {
            repair_tangents(primitive_);
        } else if (material.normal) {
            make_tangents(primitive_, *material.normal);
        } else {
            make_any_tangents(primitive_);
        }
        if (!source_.targets.empty()) {
            add_note(notes_, "Morph targets are left out: every mesh has its base shape.");
        }
    }

    tl::expected<std::optional<Primitive>, Error> skip(const char* why) {
        add_note(notes_, label_ + " " + why + " and is left out.");
        return std::nullopt;
    }

    [[nodiscard]] tl::unexpected<Error> fail(const std::string& what) const {
        return tl::unexpected(Error{label_ + " " + what});
    }

    const GltfDocument& document_;
    const tinygltf::Primitive& source_;
    std::string label_;
    std::vector<std::string>& notes_;
    Primitive primitive_;
};

} // namespace

tl::expected<std::optional<Primitive>, Error> read_gltf_primitive(const GltfDocument& document, std::size_t mesh,
                                                                  std::size_t primitive,
                                                                  const std::vector<Material>& materials,
                                                                  std::vector<std::string>& notes) {
    const tinygltf::Mesh& owner = document.model.meshes[mesh];
    const tinygltf::Primitive& source = owner.primitives[primitive];
    std::string label = gltf_label("mesh", mesh, owner.name);
    if (owner.primitives.size() > 1) {
        label += ", primitive " + std::to_string(primitive) + ",";
    }
    if (source.material >= 0 && !gltf_index_ok(source.material, materials.size() - 1)) {
        return tl::unexpected(
            Error{label + " names material " + std::to_string(source.material) + ", which is not there"});
    }
    const std::size_t material = source.material < 0 ? materials.size() - 1 : static_cast<std::size_t>(source.material);
    auto built = Builder(document, source, std::move(label), notes)
                     .build(static_cast<std::uint32_t>(material), materials[material]);
    if (!built) {
        return built;
    }
    if (std::optional<Primitive>& found = *built) {
        found->name = owner.name.empty() ? "mesh " + std::to_string(mesh) : owner.name;
    }
    return built;
}

} // namespace tyndall::engine
