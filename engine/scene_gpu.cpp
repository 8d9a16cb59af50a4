#include "engine/scene_gpu.hpp"

#include <utility>

namespace tyndall::engine {

tl::expected<SceneGpu, Error> upload_scene(const Device& device, const Scene& scene, float anisotropy) {
    auto uploader = Uploader::create(device);
    if (!uploader) {
        return tl::unexpected(uploader.error());
    }
    SceneGpu out;
    auto geometry = upload_geometry(*uploader, scene.primitives);
    if (!geometry) {
        return tl::unexpected(geometry.error());
    }
    out.geometry = std::move(*geometry);
    auto textures = upload_textures(device, *uploader, scene, anisotropy);
    if (!textures) {
        return tl::unexpected(textures.error());
    }
    out.textures = std::move(*textures);
    auto materials = upload_materials(device, *uploader, scene, out.textures);
    if (!materials) {
        return tl::unexpected(materials.error());
    }
    out.materials = std::move(*materials);
    if (auto finished = uploader->finish(); !finished) {
        return tl::unexpected(finished.error());
    }
    for (std::size_t i = 0; i < scene.primitives.size(); ++i) {
        out.features.push_back(out.materials.features[scene.primitives[i].material] |
                               (out.geometry.ranges[i].has_colors ? feature_vertex_color : 0U));
    }
    return out;
}

} // namespace tyndall::engine
