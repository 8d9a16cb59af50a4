// Materials, textures and images of a glTF file.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "engine/gltf_document.hpp"
#include "engine/scene.hpp"

namespace tyndall::engine {

struct GltfMaterials {
    std::vector<Material> materials; ///< the file's, in its order, then the default material
    std::vector<Texture> textures;   ///< those that a material uses, once for each way of use
    std::vector<Image> images;       ///< those that a texture uses, decoded
};

/// Converts all materials and decodes the images they use. `image_done(done, count)` is told after each image.
/// Errors name the material, texture or image file. Of a material's "extras" is read "blend", how what is blended is
/// laid over what lies behind it: a word of to_blend.
[[nodiscard]] tl::expected<GltfMaterials, Error>
read_gltf_materials(const GltfDocument& document, std::vector<std::string>& notes,
                    const std::function<void(std::size_t done, std::size_t count)>& image_done);

} // namespace tyndall::engine
