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

// Files are written beside their place and renamed into it, so that nothing half-written is left. Errors name the file.

/// 8 bits a channel as they are, 3 or 4 channels.
[[nodiscard]] tl::expected<void, Error> write_png(const std::filesystem::path& path, const Pixels<std::uint8_t>& image);
[[nodiscard]] tl::expected<Pixels<std::uint8_t>, Error> read_png(const std::filesystem::path& path);

/// 32-bit floats as they are, 3 or 4 channels named R, G, B, A, lossless compression.
[[nodiscard]] tl::expected<void, Error> write_exr(const std::filesystem::path& path, const Pixels<float>& image);
[[nodiscard]] tl::expected<Pixels<float>, Error> read_exr(const std::filesystem::path& path);

} // namespace tyndall::engine
