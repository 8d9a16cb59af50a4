#include "engine/gltf_document.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/gltf_bytes.hpp"
#include "engine/gltf_json.hpp"

namespace tyndall::engine {
namespace {

using nlohmann::json;

/// Takes a list out of the root: tinygltf does not get to see it.
json take_list(json& root, const char* name) {
    json list = json::array();
    if (const auto found = root.find(name); found != root.end()) {
        list = std::move(*found);
        root.erase(found);
    }
    return list;
}

std::string text_or_empty(const json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

tl::expected<Bytes, Error> read_buffer(const json& description, std::size_t index, const std::filesystem::path& folder,
                                       std::optional<Bytes>& binary) {
    const std::string label = gltf_label("buffer", index, text_or_empty(description, "name"));
    const auto length = description.find("byteLength");
    if (length == description.end()) {
        return tl::unexpected(Error{label + " has no byteLength"});
    }
    const std::string uri = text_or_empty(description, "uri");
    Bytes bytes;
    if (!uri.empty()) {
        auto read = read_gltf_uri(folder, uri);
        if (!read) {
            return tl::unexpected(Error{label + " cannot be read: " + read.error().message});
        }
        bytes = std::move(*read);
    } else if (index == 0 && binary) {
        bytes = std::move(*binary);
    } else {
        return tl::unexpected(Error{label + " has neither a uri nor a binary chunk"});
    }
    const auto wanted = length->get<std::uint64_t>();
    if (bytes.size() < wanted) {
        const std::string where = uri.empty() ? std::string("the binary chunk") : uri_in_words(uri);
        return tl::unexpected(Error{label + " should have " + std::to_string(wanted) + " bytes but " + where + " has " +
                                    std::to_string(bytes.size())});
    }
    bytes.resize(wanted);
    return bytes;
}

GltfImageSource image_source(const json& description) {
    GltfImageSource source{text_or_empty(description, "name"), text_or_empty(description, "uri"), -1};
    if (const auto view = description.find("bufferView"); view != description.end()) {
        source.buffer_view = view->get<int>();
    }
    return source;
}

/// tinygltf collects several lines; the first one tells the cause.
std::string first_line(const std::string& text) {
    std::string line = text.substr(0, text.find('\n'));
    while (!line.empty() && (line.back() == '.' || line.back() == ' ')) {
        line.pop_back();
    }
    return line.empty() ? std::string("its contents are not valid glTF") : line;
}

} // namespace

std::string gltf_label(std::string_view kind, std::size_t index, const std::string& name) {
    std::string label = std::string(kind) + " " + std::to_string(index);
    return name.empty() ? label : label + " '" + name + "'";
}

void add_note(std::vector<std::string>& notes, std::string note) {
    if (!note.empty() && note.front() >= 'a' && note.front() <= 'z') {
        note.front() = static_cast<char>(note.front() - 'a' + 'A');
    }
    if (std::find(notes.begin(), notes.end(), note) == notes.end()) {
        notes.push_back(std::move(note));
    }
}

tl::expected<GltfDocument, Error> read_gltf_document(const std::filesystem::path& path,
                                                     std::vector<std::string>& notes) {
    auto bytes = read_whole_file(path);
    if (!bytes) {
        return tl::unexpected(std::move(bytes.error()));
    }
    auto container = split_gltf_container(std::move(*bytes));
    if (!container) {
        return tl::unexpected(std::move(container.error()));
    }
    auto root = parse_gltf_json(container->json, notes);
    if (!root) {
        return tl::unexpected(std::move(root.error()));
    }

    GltfDocument document;
    document.folder = path.parent_path();
    document.skin_count = take_list(*root, "skins").size();
    for (const json& description : take_list(*root, "images")) {
        document.images.push_back(image_source(description));
    }
    const json buffers = take_list(*root, "buffers");
    for (std::size_t i = 0; i < buffers.size(); ++i) {
        auto buffer = read_buffer(buffers[i], i, document.folder, container->binary);
        if (!buffer) {
            return tl::unexpected(std::move(buffer.error()));
        }
        document.buffers.push_back(std::move(*buffer));
    }

    const std::string text = root->dump();
    std::string errors;
    std::string warnings;
    const bool parsed = tinygltf::TinyGLTF().LoadASCIIFromString(
        &document.model, &errors, &warnings, text.data(), static_cast<unsigned>(text.size()), "", tinygltf::NO_REQUIRE);
    if (!parsed || !errors.empty()) {
        return tl::unexpected(Error{"it is not valid glTF: " + first_line(errors)});
    }
    return document;
}

tl::expected<std::span<const std::uint8_t>, Error> buffer_view_bytes(const GltfDocument& document, int view) {
    if (!gltf_index_ok(view, document.model.bufferViews.size())) {
        return tl::unexpected(Error{"there is no buffer view " + std::to_string(view)});
    }
    const tinygltf::BufferView& description = document.model.bufferViews[static_cast<std::size_t>(view)];
    const std::string label = gltf_label("buffer view", static_cast<std::size_t>(view), description.name);
    if (!gltf_index_ok(description.buffer, document.buffers.size())) {
        return tl::unexpected(
            Error{label + " names buffer " + std::to_string(description.buffer) + ", which is not there"});
    }
    const Bytes& buffer = document.buffers[static_cast<std::size_t>(description.buffer)];
    if (description.byteOffset > buffer.size() || description.byteLength > buffer.size() - description.byteOffset) {
        return tl::unexpected(Error{label + " reaches past the end of buffer " + std::to_string(description.buffer)});
    }
    return std::span(buffer).subspan(description.byteOffset, description.byteLength);
}

tl::expected<Bytes, Error> image_bytes(const GltfDocument& document, const GltfImageSource& source) {
    if (!source.uri.empty()) {
        return read_gltf_uri(document.folder, source.uri);
    }
    if (source.buffer_view < 0) {
        return tl::unexpected(Error{"it has neither a uri nor a bufferView"});
    }
    return buffer_view_bytes(document, source.buffer_view).map([](std::span<const std::uint8_t> bytes) {
        return Bytes(bytes.begin(), bytes.end());
    });
}

} // namespace tyndall::engine
