#include "tests/engine/gltf_fixture.hpp"

#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

namespace tyndall::engine::test {
namespace {

void append_big_endian(std::vector<std::uint8_t>& bytes, std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) {
        bytes.push_back(static_cast<std::uint8_t>(value >> shift));
    }
}

/// ISO 3309, as PNG uses it.
std::uint32_t crc32(const std::vector<std::uint8_t>& bytes) {
    std::uint32_t crc = 0xFFFFFFFFU;
    for (const std::uint8_t byte : bytes) {
        crc ^= byte;
        for (int bit = 0; bit < 8; ++bit) {
            crc = (crc >> 1) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
        }
    }
    return ~crc;
}

std::uint32_t adler32(const std::vector<std::uint8_t>& bytes) {
    std::uint32_t a = 1;
    std::uint32_t b = 0;
    for (const std::uint8_t byte : bytes) {
        a = (a + byte) % 65521;
        b = (b + a) % 65521;
    }
    return (b << 16) | a;
}

void append_chunk(std::vector<std::uint8_t>& png, std::string_view type, const std::vector<std::uint8_t>& data) {
    append_big_endian(png, static_cast<std::uint32_t>(data.size()));
    std::vector<std::uint8_t> checked(type.begin(), type.end());
    checked.insert(checked.end(), data.begin(), data.end());
    png.insert(png.end(), checked.begin(), checked.end());
    append_big_endian(png, crc32(checked));
}

} // namespace

std::string base64(const std::vector<std::uint8_t>& bytes) {
    constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
        for (std::size_t j = 0; j < 3; ++j) {
            group = (group << 8) | (j < count ? bytes[i + j] : 0U);
        }
        for (std::size_t j = 0; j < 4; ++j) {
            text.push_back(j <= count ? alphabet[(group >> (18 - 6 * j)) & 63U] : '=');
        }
    }
    return text;
}

std::vector<std::uint8_t> one_pixel_png(std::uint8_t r, std::uint8_t g, std::uint8_t b, std::uint8_t a) {
    const std::vector<std::uint8_t> row = {0, r, g, b, a}; // filter none, one pixel
    std::vector<std::uint8_t> compressed = {0x78, 0x01, 0x01, 5, 0, 0xFA, 0xFF};
    compressed.insert(compressed.end(), row.begin(), row.end());
    append_big_endian(compressed, adler32(row));

    std::vector<std::uint8_t> png = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    append_chunk(png, "IHDR", {0, 0, 0, 1, 0, 0, 0, 1, 8, 6, 0, 0, 0});
    append_chunk(png, "IDAT", compressed);
    append_chunk(png, "IEND", {});
    return png;
}

TemporaryFolder::TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "tyndall-gltf-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) {
        ADD_FAILURE() << "no temporary folder " << pattern;
    }
    path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path TemporaryFolder::write(const std::string& name, std::string_view contents) const {
    std::filesystem::path file = path_ / name;
    std::ofstream(file, std::ios::binary) << contents;
    return file;
}

int GltfFile::add(const char* list, json element) {
    json& elements = root[list];
    elements.push_back(std::move(element));
    return static_cast<int>(elements.size()) - 1;
}

int GltfFile::add_shown_mesh(json primitive) {
    const int mesh = add("meshes", {{"primitives", json::array({std::move(primitive)})}});
    return add("nodes", {{"mesh", mesh}});
}

void GltfFile::add_triangle(json material) {
    const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    json primitive = {{"attributes", {{"POSITION", add_accessor(positions, "VEC3", type_float)}}}};
    if (!material.is_null()) {
        primitive["material"] = add("materials", std::move(material));
    }
    add_shown_mesh(std::move(primitive));
}

std::string GltfFile::text() const {
    json whole = root;
    if (!bytes.empty()) {
        whole["buffers"] = json::array(
            {{{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}});
    }
    return whole.dump();
}

tl::expected<Scene, Error> GltfFile::load() const {
    return load_text(text());
}

std::string GltfFile::error() const {
    const auto scene = load();
    if (scene) {
        return "loaded";
    }
    const std::string& message = scene.error().message;
    const std::size_t end_of_path = message.find("test.gltf: ");
    return end_of_path == std::string::npos ? "no file name in: " + message : message.substr(end_of_path + 11);
}

tl::expected<Scene, Error> load_text(std::string_view contents, const std::string& name) {
    const TemporaryFolder folder;
    return load_gltf(folder.write(name, contents));
}

bool has_note(const Scene& scene, std::string_view text) {
    return std::any_of(scene.notes.begin(), scene.notes.end(),
                       [text](const std::string& note) { return note.find(text) != std::string::npos; });
}

} // namespace tyndall::engine::test
