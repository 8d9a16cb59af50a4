// Collects the textures that materials use, and decodes their images at the end, each once.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "engine/gltf_document.hpp"
#include "engine/scene.hpp"

namespace tyndall::engine {

class GltfTextures {
public:
    /// Both outlive this object.
    GltfTextures(const GltfDocument& document, std::vector<std::string>& notes) : document_(document), notes_(notes) {}

    /// Scene index of texture `index` of the file read as colour (`srgb`) or data; made at its first use. Nothing, and
    /// a note, for a texture whose image is in a format of some unknown extension only.
    [[nodiscard]] tl::expected<std::optional<std::uint32_t>, Error> use(int index, bool srgb);

    /// 1 - `glossiness` * alpha of texture `index` of the file, in the green channel and white elsewhere: the texture
    /// of a specular-glossiness material as one of roughness. Nothing as with `use`.
    [[nodiscard]] tl::expected<std::optional<std::uint32_t>, Error> use_as_roughness(int index, double glossiness);

    /// Decodes what was used. Tells `image_done(done, count)` after each image.
    [[nodiscard]] tl::expected<std::vector<Image>, Error>
    decode(const std::function<void(std::size_t done, std::size_t count)>& image_done) const;

    [[nodiscard]] const std::vector<Texture>& textures() const { return textures_; }

private:
    struct Wanted {
        int source;
        std::optional<double> glossiness; ///< present: the image is turned from glossiness to roughness
        bool operator==(const Wanted&) const = default;
    };

    [[nodiscard]] tl::expected<std::optional<std::uint32_t>, Error> add(int index, bool srgb,
                                                                        std::optional<double> glossiness);

    const GltfDocument& document_;
    std::vector<std::string>& notes_;
    std::vector<Wanted> wanted_; ///< by scene image
    std::vector<Texture> textures_;
};

} // namespace tyndall::engine
