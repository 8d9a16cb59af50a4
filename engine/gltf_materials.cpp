#include "engine/gltf_materials.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/gltf_textures.hpp"
#include "engine/gltf_value.hpp"

namespace tyndall::engine {
namespace {

/// Reflectance at normal incidence that KHR_materials_specular scales: an index of refraction of 1.5.
constexpr double dielectric_f0 = 0.04;
/// Factors beyond it have no meaning and would leave the range of 32-bit floats after a few products.
constexpr double factor_limit = 1e9;

/// A texture reference as the file has it: `info` of tinygltf or of an extension, brought to one shape.
struct Reference {
    int index = -1;
    int uv_set = 0;
    const tinygltf::Value* transform = nullptr; ///< KHR_texture_transform
};

template <typename Info>
Reference reference(const Info& info) {
    return {info.index, info.texCoord, find_extension(info.extensions, "KHR_texture_transform")};
}

Reference reference(const tinygltf::Value* info) {
    return {integer_or(find_member(info, "index"), -1), integer_or(find_member(info, "texCoord"), 0),
            find_member(find_member(info, "extensions"), "KHR_texture_transform")};
}

/// Converts one material. The first error stays; what follows it does nothing.
class Converter {
public:
    Converter(GltfTextures& textures, std::vector<std::string>& notes, std::string label)
        : textures_(textures), notes_(notes), label_(std::move(label)) {}

    tl::expected<Material, Error> convert(const tinygltf::Material& source) {
        Material material;
        material.name = source.name;
        core(source, material);
        const auto& extensions = source.extensions;
        if (const auto* glossiness = find_extension(extensions, "KHR_materials_pbrSpecularGlossiness")) {
            specular_glossiness(*glossiness, material);
        }
        if (const auto* specular = find_extension(extensions, "KHR_materials_specular")) {
            material.specular_factor = factor(number_or(find_member(specular, "specularFactor"), 1.0), 1.0);
            material.specular = texture(reference(find_member(specular, "specularTexture")), false);
            material.specular_color_factor =
                factor(vec3_or(find_member(specular, "specularColorFactor"), glm::dvec3(1.0)), factor_limit);
            material.specular_color = texture(reference(find_member(specular, "specularColorTexture")), true);
        }
        double strength = 1.0;
        if (const auto* emissive = find_extension(extensions, "KHR_materials_emissive_strength")) {
            strength = factor(number_or(find_member(emissive, "emissiveStrength"), 1.0), factor_limit);
        }
        material.emissive = factor(vec3(source.emissiveFactor), 1.0) * static_cast<float>(strength);
        material.unlit = find_extension(extensions, "KHR_materials_unlit") != nullptr;
        if (const tinygltf::Value* blend = find_member(&source.extras, "blend")) {
            read_blend(*blend, material);
        }
        if (!error_.message.empty()) {
            return tl::unexpected(std::move(error_));
        }
        return material;
    }

private:
    void core(const tinygltf::Material& source, Material& material) {
        const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
        const auto& base = pbr.baseColorFactor;
        material.base_color_factor = glm::vec4(factor(vec3(base), 1.0), factor(base.size() == 4 ? base[3] : 1.0, 1.0));
        material.base_color = texture(reference(pbr.baseColorTexture), true);
        material.metallic_factor = factor(pbr.metallicFactor, 1.0);
        material.roughness_factor = factor(pbr.roughnessFactor, 1.0);
        material.metallic_roughness = texture(reference(pbr.metallicRoughnessTexture), false);
        const double scale = source.normalTexture.scale;
        material.normal_scale = std::copysign(factor(std::abs(scale), factor_limit), static_cast<float>(scale));
        material.normal = texture(reference(source.normalTexture), false);
        material.occlusion_strength = factor(source.occlusionTexture.strength, 1.0);
        material.occlusion = texture(reference(source.occlusionTexture), false);
        material.emission = texture(reference(source.emissiveTexture), true);
        material.double_sided = source.doubleSided;
        material.alpha_cutoff = factor(source.alphaCutoff, factor_limit);
        if (source.alphaMode == "MASK") {
            material.alpha_mode = AlphaMode::mask;
        } else if (source.alphaMode == "BLEND") {
            material.alpha_mode = AlphaMode::blend;
        } else if (source.alphaMode != "OPAQUE") {
            fail("has the alphaMode '" + source.alphaMode + "', allowed are OPAQUE, MASK and BLEND");
        }
    }

    void read_blend(const tinygltf::Value& extra, Material& material) {
        const auto blend = extra.IsString() ? to_blend(extra.Get<std::string>()) : std::nullopt;
        if (!blend) {
            add_note(notes_,
                     label_ + " has an extra 'blend' that is not " + std::string(blend_words) + ", which is left out.");
        } else if (material.alpha_mode != AlphaMode::blend) {
            add_note(notes_, label_ + " has an extra 'blend' without the alphaMode BLEND, which is left out.");
        } else {
            material.blend = *blend;
        }
    }

    /// Diffuse colour becomes base colour, no metal; the specular colour is the dielectric's reflectance, which
    /// KHR_materials_specular gives as a multiple of 0.04; roughness is 1 - glossiness.
    void specular_glossiness(const tinygltf::Value& source, Material& material) {
        add_note(notes_, "KHR_materials_pbrSpecularGlossiness is converted to metallic-roughness.");
        const glm::dvec4 diffuse = vec4_or(find_member(&source, "diffuseFactor"), glm::dvec4(1.0));
        material.base_color_factor = glm::vec4(factor(glm::dvec3(diffuse), 1.0), factor(diffuse.a, 1.0));
        material.base_color = texture(reference(find_member(&source, "diffuseTexture")), true);
        material.metallic_factor = 0.0F;
        material.metallic_roughness.reset();
        const glm::dvec3 specular = vec3_or(find_member(&source, "specularFactor"), glm::dvec3(1.0));
        material.specular_color_factor = factor(specular / dielectric_f0, 1.0 / dielectric_f0);
        const double glossiness = factor(number_or(find_member(&source, "glossinessFactor"), 1.0), 1.0);
        const Reference both = reference(find_member(&source, "specularGlossinessTexture"));
        material.specular_color = texture(both, true);
        if (both.index < 0) {
            material.roughness_factor = static_cast<float>(1.0 - glossiness);
            return;
        }
        material.roughness_factor = 1.0F;
        material.metallic_roughness = placed(both, textures_.use_as_roughness(both.index, glossiness));
    }

    std::optional<TextureUse> texture(const Reference& from, bool srgb) {
        return from.index < 0 ? std::nullopt : placed(from, textures_.use(from.index, srgb));
    }

    std::optional<TextureUse> placed(const Reference& from,
                                     const tl::expected<std::optional<std::uint32_t>, Error>& made) {
        if (!made) {
            fail("cannot be read: " + made.error().message);
            return std::nullopt;
        }
        const std::optional<std::uint32_t>& texture_index = *made;
        if (!texture_index) {
            return std::nullopt;
        }
        TextureUse use;
        use.texture = *texture_index;
        int uv_set = from.uv_set;
        if (from.transform != nullptr) {
            uv_set = integer_or(find_member(from.transform, "texCoord"), uv_set);
            transform(*from.transform, use);
        }
        if (uv_set < 0 || uv_set > 1) {
            add_note(notes_,
                     "Texture coordinates of set " + std::to_string(uv_set) + " are not supported, set 0 is used.");
            uv_set = 0;
        }
        use.uv_set = static_cast<std::uint32_t>(uv_set);
        return use;
    }

    /// KHR_texture_transform: uv' = translation * rotation * scale * uv, rotation counter-clockwise in the plane where
    /// v points down, so u' = cos s_u u + sin s_v v + t_u and v' = -sin s_u u + cos s_v v + t_v.
    void transform(const tinygltf::Value& source, TextureUse& use) {
        const glm::dvec2 offset = vec2_or(find_member(&source, "offset"), glm::dvec2(0.0));
        const glm::dvec2 scale = vec2_or(find_member(&source, "scale"), glm::dvec2(1.0));
        const double angle = number_or(find_member(&source, "rotation"), 0.0);
        const double c = std::cos(angle);
        const double s = std::sin(angle);
        use.uv_row_u = limited(glm::dvec3(c * scale.x, s * scale.y, offset.x));
        use.uv_row_v = limited(glm::dvec3(-s * scale.x, c * scale.y, offset.y));
    }

    static glm::vec3 limited(const glm::dvec3& value) {
        return glm::vec3(glm::clamp(value, glm::dvec3(-factor_limit), glm::dvec3(factor_limit)));
    }

    static glm::dvec3 vec3(const std::vector<double>& values) {
        return values.size() >= 3 ? glm::dvec3(values[0], values[1], values[2]) : glm::dvec3(0.0);
    }

    float factor(double value, double limit) {
        const double clamped = std::clamp(value, 0.0, limit);
        if (clamped != value) {
            add_note(notes_, label_ + " has a factor outside of its range, which is clamped.");
        }
        return static_cast<float>(clamped);
    }

    glm::vec3 factor(const glm::dvec3& value, double limit) {
        return {factor(value.x, limit), factor(value.y, limit), factor(value.z, limit)};
    }

    void fail(const std::string& what) {
        if (error_.message.empty()) {
            error_.message = label_ + " " + what;
        }
    }

    GltfTextures& textures_;
    std::vector<std::string>& notes_;
    std::string label_;
    Error error_;
};

} // namespace

tl::expected<GltfMaterials, Error>
read_gltf_materials(const GltfDocument& document, std::vector<std::string>& notes,
                    const std::function<void(std::size_t done, std::size_t count)>& image_done) {
    GltfTextures textures(document, notes);
    GltfMaterials result;
    const auto& sources = document.model.materials;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        auto material = Converter(textures, notes, gltf_label("material", i, sources[i].name)).convert(sources[i]);
        if (!material) {
            return tl::unexpected(std::move(material.error()));
        }
        result.materials.push_back(std::move(*material));
    }
    result.materials.push_back(Material{.name = "default"});

    auto images = textures.decode(image_done);
    if (!images) {
        return tl::unexpected(std::move(images.error()));
    }
    result.textures = textures.textures();
    result.images = std::move(*images);
    return result;
}

} // namespace tyndall::engine
