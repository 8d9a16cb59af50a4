// A fog file with the pictures that it names.
#pragma once

#include <filesystem>
#include <string>

#include <tl/expected.hpp>

#include "features/volumetrics/fog_json.hpp"

namespace tyndall::samples {

/// One sentence that names the file where it, or a picture of its, cannot be read or used.
[[nodiscard]] tl::expected<volumetrics::Fog, std::string> load_fog_file(const std::filesystem::path& path);

} // namespace tyndall::samples
