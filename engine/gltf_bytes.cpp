#include "engine/gltf_bytes.hpp"

#include <array>
#include <cstring>
#include <fstream>
#include <system_error>

namespace tyndall::engine {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::uint32_t little_endian_u32(const Bytes& bytes, std::size_t offset) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        value |= static_cast<std::uint32_t>(bytes[offset + i]) << (8 * i);
    }
    return value;
}

constexpr std::uint8_t not_base64 = 255;

constexpr std::array<std::uint8_t, 256> base64_values() {
    std::array<std::uint8_t, 256> values{};
    values.fill(not_base64);
    constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < alphabet.size(); ++i) {
        values[static_cast<unsigned char>(alphabet[i])] = static_cast<std::uint8_t>(i);
    }
    return values;
}

std::optional<Bytes> decode_base64(std::string_view text) {
    static constexpr auto values = base64_values();
    while (!text.empty() && text.back() == '=') {
        text.remove_suffix(1);
    }
    Bytes bytes;
    bytes.reserve(text.size() / 4 * 3 + 2);
    std::uint32_t pending = 0;
    unsigned pending_bits = 0;
    for (const char c : text) {
        const std::uint8_t value = values[static_cast<unsigned char>(c)];
        if (value == not_base64) {
            return std::nullopt;
        }
        pending = (pending << 6) | value;
        pending_bits += 6;
        if (pending_bits >= 8) {
            pending_bits -= 8;
            bytes.push_back(static_cast<std::uint8_t>(pending >> pending_bits));
            pending &= (1U << pending_bits) - 1U;
        }
    }
    return bytes;
}

int hex_digit(char c) {
    if (c >= '0' && c <= '9') {
        return c - '0';
    }
    if (c >= 'a' && c <= 'f') {
        return c - 'a' + 10;
    }
    if (c >= 'A' && c <= 'F') {
        return c - 'A' + 10;
    }
    return -1;
}

/// RFC 3986: %XX is a byte; anything else stands for itself.
std::string percent_decode(std::string_view text) {
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '%' && i + 2 < text.size()) {
            const int high = hex_digit(text[i + 1]);
            const int low = hex_digit(text[i + 2]);
            if (high >= 0 && low >= 0) {
                result.push_back(static_cast<char>(high * 16 + low));
                i += 2;
                continue;
            }
        }
        result.push_back(text[i]);
    }
    return result;
}

} // namespace

tl::expected<Bytes, Error> read_whole_file(const std::filesystem::path& path) {
    std::error_code code;
    const auto status = std::filesystem::status(path, code);
    if (!std::filesystem::exists(status)) {
        return tl::unexpected(Error{"there is no file '" + path.string() + "'"});
    }
    if (!std::filesystem::is_regular_file(status)) {
        return tl::unexpected(Error{"'" + path.string() + "' is not a regular file"});
    }
    const std::uintmax_t size = std::filesystem::file_size(path, code);
    std::ifstream stream(path, std::ios::binary);
    if (code || !stream) {
        return tl::unexpected(Error{"the file '" + path.string() + "' cannot be opened"});
    }
    Bytes bytes(size);
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (stream.gcount() != static_cast<std::streamsize>(size)) {
        return tl::unexpected(Error{"the file '" + path.string() + "' cannot be read to its end"});
    }
    return bytes;
}

tl::expected<GltfContainer, Error> split_gltf_container(Bytes bytes) {
    constexpr std::size_t header_size = 12;
    constexpr std::size_t chunk_header_size = 8;
    constexpr std::uint32_t json_chunk = 0x4E4F534AU;
    constexpr std::uint32_t binary_chunk = 0x004E4942U;

    if (bytes.size() < 4 || std::memcmp(bytes.data(), "glTF", 4) != 0) {
        return GltfContainer{std::string(bytes.begin(), bytes.end()), std::nullopt};
    }
    if (bytes.size() < header_size) {
        return tl::unexpected(Error{"the binary container ends within its header"});
    }
    if (const std::uint32_t version = little_endian_u32(bytes, 4); version != 2) {
        return tl::unexpected(
            Error{"the binary container has version " + std::to_string(version) + ", only glTF 2 is read"});
    }
    const std::uint64_t length = little_endian_u32(bytes, 8);
    if (length > bytes.size()) {
        return tl::unexpected(Error{"the binary container should have " + std::to_string(length) +
                                    " bytes but the file has " + std::to_string(bytes.size())});
    }

    GltfContainer container;
    bool json_found = false;
    for (std::uint64_t offset = header_size; offset + chunk_header_size <= length;) {
        const std::uint64_t chunk_size = little_endian_u32(bytes, offset);
        const std::uint32_t type = little_endian_u32(bytes, offset + 4);
        offset += chunk_header_size;
        if (chunk_size > length - offset) {
            return tl::unexpected(Error{"a chunk of the binary container reaches past its end"});
        }
        const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(offset);
        const auto last = first + static_cast<std::ptrdiff_t>(chunk_size);
        if (type == json_chunk && !json_found) {
            container.json.assign(first, last);
            json_found = true;
        } else if (type == binary_chunk && !container.binary) {
            container.binary.emplace(first, last);
        }
        offset += chunk_size;
    }
    if (!json_found) {
        return tl::unexpected(Error{"the binary container has no JSON chunk"});
    }
    return container;
}

tl::expected<Bytes, Error> read_gltf_uri(const std::filesystem::path& folder, std::string_view uri) {
    if (!uri.starts_with("data:")) {
        return read_whole_file(folder / std::filesystem::path(percent_decode(uri)));
    }
    const std::size_t comma = uri.find(',');
    if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(";base64")) {
        return tl::unexpected(Error{"its data URI is not base64"});
    }
    auto bytes = decode_base64(uri.substr(comma + 1));
    if (!bytes) {
        return tl::unexpected(Error{"its data URI holds a character that base64 does not have"});
    }
    return std::move(*bytes);
}

std::string uri_in_words(std::string_view uri) {
    return uri.starts_with("data:") ? std::string("a data URI") : "'" + percent_decode(uri) + "'";
}

} // namespace tyndall::engine
