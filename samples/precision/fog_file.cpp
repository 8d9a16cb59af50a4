#include "samples/precision/fog_file.hpp"

#include <map>

#include "engine/file_io.hpp"
#include "engine/image_io.hpp"

namespace tyndall::samples {
namespace {

std::vector<std::uint8_t> first_channel(const engine::Pixels<std::uint8_t>& image) {
    std::vector<std::uint8_t> values;
    for (std::size_t i = 0; i < image.values.size(); i += image.channels) {
        values.push_back(image.values[i]);
    }
    return values;
}

} // namespace

tl::expected<volumetrics::Fog, std::string> load_fog_file(const std::filesystem::path& path) {
    const auto text = engine::read_file(path);
    if (!text) {
        return tl::unexpected(text.error().message);
    }
    auto fog = volumetrics::parse_fog_json({reinterpret_cast<const char*>(text->data()), text->size()});
    if (!fog) {
        return tl::unexpected(path.string() + ": " + fog.error().message);
    }
    // Volumes that name the same picture alike share its texels.
    std::map<std::pair<std::string, std::uint32_t>, std::shared_ptr<const volumetrics::DensityTexels>> known;
    for (const volumetrics::DensityPicture& picture : fog->pictures) {
        auto& texels = known[{picture.path, picture.slices}];
        if (texels && picture.volume) {
            fog->medium.volumes[*picture.volume].density = texels;
            continue;
        }
        const auto image = engine::read_png(path.parent_path() / picture.path);
        if (!image) {
            return tl::unexpected(path.string() + ": " + picture.key + ": " + image.error().message);
        }
        const auto set = volumetrics::set_density(*fog, picture, image->width, image->height, first_channel(*image));
        if (!set) {
            return tl::unexpected(path.string() + ": " + set.error().message);
        }
        texels = picture.volume ? fog->medium.volumes[*picture.volume].density : fog->medium.map.texels;
    }
    if (const auto valid = volumetrics::validate(fog->medium); !valid) {
        return tl::unexpected(path.string() + ": " + valid.error().message);
    }
    return std::move(*fog);
}

} // namespace tyndall::samples
