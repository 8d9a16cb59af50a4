#include "engine/gltf_textures.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <stb/stb_image.h>

#include "engine/gltf_bytes.hpp"

namespace tyndall::engine {
namespace {

/// What every Vulkan device of today takes; also keeps a small file from asking for all memory.
constexpr int image_side_limit = 16384;

Wrap to_wrap(int value) {
    switch (value) {
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE: return Wrap::clamp_to_edge;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT: return Wrap::mirrored_repeat;
    default: return Wrap::repeat;
    }
}

/// glTF 2.0, section 5.26; what a sampler leaves open becomes trilinear.
Sampler to_sampler(const tinygltf::Sampler& source) {
    Sampler sampler;
    sampler.wrap_u = to_wrap(source.wrapS);
    sampler.wrap_v = to_wrap(source.wrapT);
    sampler.magnify = source.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST ? Filter::nearest : Filter::linear;
    switch (source.minFilter) {
    case TINYGLTF_TEXTURE_FILTER_NEAREST:
        sampler.minify = Filter::nearest;
        sampler.has_levels = false;
        break;
    case TINYGLTF_TEXTURE_FILTER_LINEAR: sampler.has_levels = false; break;
    case TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_NEAREST:
        sampler.minify = Filter::nearest;
        sampler.between_levels = Filter::nearest;
        break;
    case TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_NEAREST: sampler.between_levels = Filter::nearest; break;
    case TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_LINEAR: sampler.minify = Filter::nearest; break;
    default: break;
    }
    return sampler;
}

tl::expected<Image, Error> decode_image(const GltfDocument& document, std::size_t index) {
    const GltfImageSource& source = document.images[index];
    std::string label = gltf_label("image", index, source.name);
    if (!source.uri.empty()) {
        label += " (" + uri_in_words(source.uri) + ")";
    }
    const auto bytes = image_bytes(document, source);
    if (!bytes) {
        return tl::unexpected(Error{label + " cannot be read: " + bytes.error().message});
    }
    const int size = static_cast<int>(std::min<std::size_t>(bytes->size(), INT32_MAX));
    int width = 0;
    int height = 0;
    int channels = 0;
    if (stbi_info_from_memory(bytes->data(), size, &width, &height, &channels) == 0) {
        return tl::unexpected(Error{label + " is not an image in a format that is read (PNG or JPEG)"});
    }
    if (width < 1 || height < 1 || width > image_side_limit || height > image_side_limit) {
        return tl::unexpected(Error{label + " is " + std::to_string(width) + "x" + std::to_string(height) +
                                    " pixels, allowed are 1 to " + std::to_string(image_side_limit) + " a side"});
    }
    const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
        stbi_load_from_memory(bytes->data(), size, &width, &height, &channels, 4), &stbi_image_free);
    if (!pixels) {
        return tl::unexpected(Error{label + " is a broken image file"});
    }
    Image image;
    image.name = source.name.empty() ? uri_in_words(source.uri) : source.name;
    image.width = static_cast<std::uint32_t>(width);
    image.height = static_cast<std::uint32_t>(height);
    image.rgba.assign(pixels.get(), pixels.get() + std::size_t{4} * image.width * image.height);
    return image;
}

void to_roughness(Image& image, double glossiness) {
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        const double roughness = 255.0 - glossiness * image.rgba[i + 3];
        image.rgba[i] = image.rgba[i + 2] = image.rgba[i + 3] = 255;
        image.rgba[i + 1] = static_cast<std::uint8_t>(std::lround(roughness));
    }
}

} // namespace

tl::expected<std::optional<std::uint32_t>, Error> GltfTextures::use(int index, bool srgb) {
    return add(index, srgb, std::nullopt);
}

tl::expected<std::optional<std::uint32_t>, Error> GltfTextures::use_as_roughness(int index, double glossiness) {
    return add(index, false, glossiness);
}

tl::expected<std::optional<std::uint32_t>, Error> GltfTextures::add(int index, bool srgb,
                                                                    std::optional<double> glossiness) {
    const tinygltf::Model& model = document_.model;
    if (!gltf_index_ok(index, model.textures.size())) {
        return tl::unexpected(Error{"there is no texture " + std::to_string(index)});
    }
    const tinygltf::Texture& source = model.textures[static_cast<std::size_t>(index)];
    const std::string label = gltf_label("texture", static_cast<std::size_t>(index), source.name);
    if (source.source < 0) {
        add_note(notes_, label + " has no image in a format that is read and is left out.");
        return std::nullopt;
    }
    if (!gltf_index_ok(source.source, document_.images.size())) {
        return tl::unexpected(Error{label + " names image " + std::to_string(source.source) + ", which is not there"});
    }
    if (source.sampler >= 0 && !gltf_index_ok(source.sampler, model.samplers.size())) {
        return tl::unexpected(
            Error{label + " names sampler " + std::to_string(source.sampler) + ", which is not there"});
    }

    const auto index_of = [](auto& list, const auto& item) {
        const auto found = std::find(list.begin(), list.end(), item);
        const auto position = static_cast<std::uint32_t>(found - list.begin());
        if (found == list.end()) {
            list.push_back(item);
        }
        return position;
    };
    Texture texture;
    texture.image = index_of(wanted_, Wanted{source.source, glossiness});
    texture.srgb = srgb;
    if (source.sampler >= 0) {
        texture.sampler = to_sampler(model.samplers[static_cast<std::size_t>(source.sampler)]);
    }
    return index_of(textures_, texture);
}

tl::expected<std::vector<Image>, Error>
GltfTextures::decode(const std::function<void(std::size_t done, std::size_t count)>& image_done) const {
    std::vector<Image> images;
    for (const Wanted& wanted : wanted_) {
        auto image = decode_image(document_, static_cast<std::size_t>(wanted.source));
        if (!image) {
            return tl::unexpected(std::move(image.error()));
        }
        if (wanted.glossiness) {
            to_roughness(*image, *wanted.glossiness);
        }
        images.push_back(std::move(*image));
        image_done(images.size(), wanted_.size());
    }
    return images;
}

} // namespace tyndall::engine
