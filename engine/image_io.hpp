// Images in files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include <tl/expected.hpp>

#include "engine/error.hpp"

namespace tyndall::engine {

/// Rows from the top; `channels` values a pixel.
template <typename T>
struct Pixels {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t channels = 0;
    std::vector<T> values;
};

// Files appear only when they are complete (see file_io.hpp). Errors name the file.

/// 8 bits a channel as they are, 1 to 4 channels.
[[nodiscard]] tl::expected<void, Error> write_png(const std::filesystem::path& path, const Pixels<std::uint8_t>& image);
/// With the file's own number of channels; 16-bit files are reduced to 8.
[[nodiscard]] tl::expected<Pixels<std::uint8_t>, Error> read_png(const std::filesystem::path& path);

enum class ExrPrecision : std::uint8_t {
    single, ///< the very bits
    half,   ///< rounded to nearest; beyond 65504 infinite
};

/// Linear radiance with the primaries of ITU-R BT.709, 1.0 being one candela per square metre (attribute
/// `whiteLuminance`); 3 or 4 channels named R, G, B, A; lossless compression.
[[nodiscard]] tl::expected<void, Error> write_exr(const std::filesystem::path& path, const Pixels<float>& image,
                                                  ExrPrecision precision = ExrPrecision::single);
/// R, G, B and, where the file has it, A; a channel that is missing is 0.
[[nodiscard]] tl::expected<Pixels<float>, Error> read_exr(const std::filesystem::path& path);

} // namespace tyndall::engine
