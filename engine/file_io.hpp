// Whole files in and out. What is written is never seen half-written: it gets its name when it is complete.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include <tl/expected.hpp>

#include "engine/error.hpp"

namespace tyndall::engine {

/// The whole content. The error names the path and the system's reason.
[[nodiscard]] tl::expected<std::vector<std::byte>, Error> read_file(const std::filesystem::path& path);

/// Writes beside `path` under another name and renames; on failure nothing is left and an older file stays as it was.
[[nodiscard]] tl::expected<void, Error> replace_file(const std::filesystem::path& path,
                                                     std::span<const std::byte> content);

} // namespace tyndall::engine
