// Fog described by a JSON file beside a scene; the schema is in docs/fog.md.
#pragma once

#include <string_view>

#include <tl/expected.hpp>

#include "features/volumetrics/settings.hpp"

namespace tyndall::volumetrics {

struct Fog {
    Medium medium;
    Settings settings;
};

/// Parses and validates. Every section and key is optional. Refused, with the key's path: unknown or repeated keys,
/// values of the wrong type, values outside their domain (see settings.hpp), text that is not JSON.
[[nodiscard]] tl::expected<Fog, Error> parse_fog_json(std::string_view text);

} // namespace tyndall::volumetrics
