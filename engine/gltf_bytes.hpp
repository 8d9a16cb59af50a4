// Bytes that a glTF file refers to: files, data URIs, and the binary container.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "engine/error.hpp"

namespace tyndall::engine {

/// The JSON text and the binary chunk, if any, of a .gltf or .glb file (told apart by content).
struct GltfContainer {
    std::string json;
    std::optional<std::vector<std::uint8_t>> binary;
};

/// The whole of a regular file. The error names it.
[[nodiscard]] tl::expected<std::vector<std::uint8_t>, Error> read_whole_file(const std::filesystem::path& path);

/// glTF 2.0, section 4.4 (GLB: 12-byte header, then chunks of length, type, data; little-endian).
[[nodiscard]] tl::expected<GltfContainer, Error> split_gltf_container(std::vector<std::uint8_t> bytes);

/// Resolves a URI of the file: "data:...;base64,..." of any media type, or a percent-encoded path relative to `folder`.
[[nodiscard]] tl::expected<std::vector<std::uint8_t>, Error> read_gltf_uri(const std::filesystem::path& folder,
                                                                           std::string_view uri);

/// How a URI appears in a message: data URIs are not spelled out.
[[nodiscard]] std::string uri_in_words(std::string_view uri);

} // namespace tyndall::engine
