#include "engine/textures_gpu.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

namespace tyndall::engine {
namespace {

VkSamplerAddressMode address_mode(Wrap wrap) {
    switch (wrap) {
    case Wrap::repeat: return VK_SAMPLER_ADDRESS_MODE_REPEAT;
    case Wrap::mirrored_repeat: return VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
    case Wrap::clamp_to_edge: break;
    }
    return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
}

VkFilter filter(Filter f) {
    return f == Filter::linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
}

VkSamplerCreateInfo sampler_info(const Sampler& sampler, float anisotropy) {
    const bool anisotropic = anisotropy > 1.0F && sampler.has_levels && sampler.minify == Filter::linear;
    return {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
            .magFilter = filter(sampler.magnify),
            .minFilter = filter(sampler.minify),
            .mipmapMode = sampler.between_levels == Filter::linear ? VK_SAMPLER_MIPMAP_MODE_LINEAR
                                                                   : VK_SAMPLER_MIPMAP_MODE_NEAREST,
            .addressModeU = address_mode(sampler.wrap_u),
            .addressModeV = address_mode(sampler.wrap_v),
            .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
            .anisotropyEnable = anisotropic ? VK_TRUE : VK_FALSE,
            .maxAnisotropy = anisotropy,
            .maxLod = sampler.has_levels ? VK_LOD_CLAMP_NONE : 0.0F};
}

/// An image read in one way.
struct Reading {
    std::uint32_t image;
    bool srgb;
    bool levels;
};

class TextureUpload {
public:
    TextureUpload(const Device& device, Uploader& uploader, const Scene& scene, float anisotropy)
        : device_(device), uploader_(uploader), scene_(scene), anisotropy_(anisotropy) {}

    tl::expected<TexturesGpu, Error> run() {
        for (const Texture& texture : scene_.textures) {
            note_reading(texture);
        }
        for (const Reading& reading : readings_) {
            if (auto made = upload(reading); !made) {
                return tl::unexpected(made.error());
            }
        }
        for (const Texture& texture : scene_.textures) {
            const auto sampler = sampler_of(texture.sampler);
            if (!sampler) {
                return tl::unexpected(sampler.error());
            }
            out_.textures.push_back(describe(*sampler, find(texture)));
        }
        if (auto made = add_white(); !made) {
            return tl::unexpected(made.error());
        }
        return std::move(out_);
    }

private:
    [[nodiscard]] std::size_t find(const Texture& texture) const {
        const auto same = [&](const Reading& r) { return r.image == texture.image && r.srgb == texture.srgb; };
        return static_cast<std::size_t>(std::find_if(readings_.begin(), readings_.end(), same) - readings_.begin());
    }

    void note_reading(const Texture& texture) {
        const std::size_t index = find(texture);
        if (index == readings_.size()) {
            readings_.push_back({texture.image, texture.srgb, false});
        }
        readings_[index].levels = readings_[index].levels || texture.sampler.has_levels;
    }

    tl::expected<void, Error> upload(const Reading& reading) {
        const Image& image = scene_.images[reading.image];
        const std::uint32_t largest = device_.properties().limits.maxImageDimension2D;
        if (image.width > largest || image.height > largest) {
            return tl::unexpected(Error{"Image '" + image.name + "' is " + std::to_string(image.width) + " x " +
                                        std::to_string(image.height) + " pixels; the device takes at most " +
                                        std::to_string(largest) + " a side."});
        }
        auto texture = uploader_.texture(std::as_bytes(std::span(image.rgba)),
                                         reading.srgb ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_R8G8B8A8_UNORM,
                                         {image.width, image.height}, reading.levels);
        if (!texture) {
            return tl::unexpected(texture.error());
        }
        out_.images.push_back(std::move(*texture));
        return {};
    }

    tl::expected<VkSampler, Error> sampler_of(const Sampler& sampler) {
        const auto found = std::find(known_.begin(), known_.end(), sampler);
        const auto index = static_cast<std::size_t>(found - known_.begin());
        if (found == known_.end()) {
            auto made = create_sampler(device_, sampler_info(sampler, anisotropy_));
            if (!made) {
                return tl::unexpected(made.error());
            }
            known_.push_back(sampler);
            out_.samplers.push_back(std::move(*made));
        }
        return out_.samplers[index].get();
    }

    tl::expected<void, Error> add_white() {
        const std::array<std::byte, 4> texel = {std::byte{255}, std::byte{255}, std::byte{255}, std::byte{255}};
        auto image = uploader_.texture(texel, VK_FORMAT_R8G8B8A8_UNORM, {1, 1}, false);
        if (!image) {
            return tl::unexpected(image.error());
        }
        out_.images.push_back(std::move(*image));
        const auto sampler = sampler_of(Sampler{});
        if (!sampler) {
            return tl::unexpected(sampler.error());
        }
        out_.white = describe(*sampler, out_.images.size() - 1);
        return {};
    }

    [[nodiscard]] VkDescriptorImageInfo describe(VkSampler sampler, std::size_t image) const {
        return {sampler, out_.images[image].view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    }

    const Device& device_;
    Uploader& uploader_;
    const Scene& scene_;
    float anisotropy_;
    std::vector<Reading> readings_; ///< by image of `out_`
    std::vector<Sampler> known_;    ///< by sampler of `out_`
    TexturesGpu out_;
};

} // namespace

tl::expected<TexturesGpu, Error> upload_textures(const Device& device, Uploader& uploader, const Scene& scene,
                                                 float anisotropy) {
    return TextureUpload(device, uploader, scene, anisotropy).run();
}

} // namespace tyndall::engine
