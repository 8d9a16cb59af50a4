// Small glTF files made in the test that reads them.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/gltf.hpp"

namespace tyndall::engine::test {

using nlohmann::json;

inline constexpr int type_byte = 5120;
inline constexpr int type_unsigned_byte = 5121;
inline constexpr int type_short = 5122;
inline constexpr int type_unsigned_short = 5123;
inline constexpr int type_unsigned_int = 5125;
inline constexpr int type_float = 5126;

[[nodiscard]] std::string base64(const std::vector<std::uint8_t>& bytes);

/// A PNG of one pixel, uncompressed.
[[nodiscard]] std::vector<std::uint8_t> one_pixel_png(std::uint8_t r, std::uint8_t g, std::uint8_t b, std::uint8_t a);

/// A folder of its own that is removed at the end.
class TemporaryFolder {
public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    std::filesystem::path write(const std::string& name, std::string_view contents) const;

private:
    std::filesystem::path path_;
};

/// A glTF file under construction. `root` is free to edit; `bytes` becomes buffer 0 as a data URI.
struct GltfFile {
    json root = {{"asset", {{"version", "2.0"}}}};
    std::vector<std::uint8_t> bytes;

    /// Appends a buffer view of the values; returns its index.
    template <typename T>
    int add_view(const std::vector<T>& values, int stride = 0) {
        while (bytes.size() % 4 != 0) {
            bytes.push_back(0);
        }
        const std::size_t offset = bytes.size();
        const std::size_t size = values.size() * sizeof(T);
        bytes.resize(offset + size);
        std::memcpy(bytes.data() + offset, values.data(), size);
        json view = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}};
        if (stride > 0) {
            view["byteStride"] = stride;
        }
        return add("bufferViews", std::move(view));
    }

    /// Appends an accessor with a tight buffer view of its own; returns its index.
    template <typename T>
    int add_accessor(const std::vector<T>& values, const char* type, int component_type, bool normalized = false) {
        const std::string_view name = type;
        const std::size_t components = name == "SCALAR" ? 1 : static_cast<std::size_t>(name.back() - '0');
        json accessor = {{"bufferView", add_view(values)},
                         {"componentType", component_type},
                         {"count", values.size() / components},
                         {"type", type}};
        if (normalized) {
            accessor["normalized"] = true;
        }
        return add("accessors", std::move(accessor));
    }

    /// Appends to a list of the root; returns the new element's index.
    int add(const char* list, json element);

    /// Appends a mesh of one primitive and a root node that shows it; returns the node's index.
    int add_shown_mesh(json primitive);

    /// The triangle (0,0,0), (1,0,0), (0,1,0) without anything else, shown by a root node.
    void add_triangle(json material = nullptr);

    [[nodiscard]] std::string text() const;
    [[nodiscard]] tl::expected<Scene, Error> load() const;
    /// The message of the error that loading must end with, without the file's name; "loaded" if it does not.
    [[nodiscard]] std::string error() const;
};

/// Loads `contents` from a file of that name.
[[nodiscard]] tl::expected<Scene, Error> load_text(std::string_view contents, const std::string& name = "test.gltf");

/// True if one of the scene's notes contains `text`.
[[nodiscard]] bool has_note(const Scene& scene, std::string_view text);

} // namespace tyndall::engine::test
