// Fog described by a JSON file beside a scene; the schema is in docs/fog.md.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "features/volumetrics/settings.hpp"

namespace tyndall::volumetrics {

/// A picture of densities that the file names and the program reads: the first channel of each pixel.
struct DensityPicture {
    std::string path;                       ///< as it is written: relative to the fog file
    std::string key;                        ///< "medium.map.image"
    std::optional<std::size_t> volume = {}; ///< index into medium.volumes; none: the map
    std::uint32_t slices = 1;               ///< that the picture holds one below the other
};

struct Fog {
    Medium medium;
    Settings settings;
    std::vector<DensityPicture> pictures; ///< that `set_density` has not yet been given
};

/// Gives the medium what a picture of `pictures` holds, rows from the top, a byte a pixel. Refused, with the key, where
/// the height is not a multiple of the slices or the picture is too large.
[[nodiscard]] tl::expected<void, Error> set_density(Fog& fog, const DensityPicture& picture, std::uint32_t width,
                                                    std::uint32_t height, std::vector<std::uint8_t> values);

/// Parses and validates. Every section and key is optional. Refused, with the key's path: unknown or repeated keys,
/// values of the wrong type, values outside their domain (see settings.hpp), text that is not JSON.
[[nodiscard]] tl::expected<Fog, Error> parse_fog_json(std::string_view text);

} // namespace tyndall::volumetrics
