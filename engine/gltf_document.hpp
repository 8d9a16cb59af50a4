// A glTF file taken apart and checked as far as its JSON and its bytes go: the first half of load_gltf.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tiny_gltf.h>
#include <tl/expected.hpp>

#include "engine/error.hpp"

namespace tyndall::engine {

using Bytes = std::vector<std::uint8_t>;

/// Where an image's encoded bytes are: a URI (data or file), else a buffer view.
struct GltfImageSource {
    std::string name;
    std::string uri;
    int buffer_view = -1;
};

/// The parts of the file. tinygltf fills `model` with everything but buffers, images, animations and skins: the first
/// two are read here, so that a missing or short file is told by name, and images that nothing uses are never opened.
struct GltfDocument {
    std::filesystem::path folder;
    tinygltf::Model model;
    std::vector<Bytes> buffers;
    std::vector<GltfImageSource> images;
    std::size_t skin_count = 0;
};

/// Reads and checks the container, the JSON, the required extensions and all buffers. Appends notes on optional
/// extensions.
[[nodiscard]] tl::expected<GltfDocument, Error> read_gltf_document(const std::filesystem::path& path,
                                                                   std::vector<std::string>& notes);

/// The bytes of a buffer view, checked against its buffer. The view lives as long as the document.
[[nodiscard]] tl::expected<std::span<const std::uint8_t>, Error> buffer_view_bytes(const GltfDocument& document,
                                                                                   int view);

/// The encoded bytes of an image, from wherever they are.
[[nodiscard]] tl::expected<Bytes, Error> image_bytes(const GltfDocument& document, const GltfImageSource& source);

/// How messages name an element of the file: "material 3 'Glass'", or "material 3" without a name.
[[nodiscard]] std::string gltf_label(std::string_view kind, std::size_t index, const std::string& name);

/// True for an index into a list of `size`.
[[nodiscard]] inline bool gltf_index_ok(int index, std::size_t size) {
    return index >= 0 && static_cast<std::size_t>(index) < size;
}

/// Appends `note`, a sentence, with a capital at its start unless it is there already.
void add_note(std::vector<std::string>& notes, std::string note);

} // namespace tyndall::engine
