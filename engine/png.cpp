#include <climits>
#include <memory>
#include <string>

#include <stb/stb_image.h>
#include <stb/stb_image_write.h>

#include "engine/file_io.hpp"
#include "engine/image_io.hpp"

namespace tyndall::engine {
namespace {

Error cannot(const char* what, const std::filesystem::path& path, const std::string& why) {
    return {std::string("cannot ") + what + " '" + path.string() + "': " + why};
}

void append(void* context, void* data, int size_bytes) {
    auto& content = *static_cast<std::vector<std::byte>*>(context);
    const auto* bytes = static_cast<const std::byte*>(data);
    content.insert(content.end(), bytes, bytes + size_bytes);
}

} // namespace

tl::expected<void, Error> write_png(const std::filesystem::path& path, const Pixels<std::uint8_t>& image) {
    const std::size_t row_bytes = std::size_t{image.width} * image.channels;
    if (image.channels < 1 || image.channels > 4 || row_bytes == 0 || image.height == 0 ||
        image.values.size() != row_bytes * image.height || image.values.size() > INT_MAX) {
        return tl::unexpected(cannot("write", path,
                                     "a PNG cannot hold " + std::to_string(image.width) + "x" +
                                         std::to_string(image.height) + " pixels of " + std::to_string(image.channels) +
                                         " channels made of " + std::to_string(image.values.size()) + " values"));
    }
    std::vector<std::byte> content;
    if (stbi_write_png_to_func(append, &content, static_cast<int>(image.width), static_cast<int>(image.height),
                               static_cast<int>(image.channels), image.values.data(),
                               static_cast<int>(row_bytes)) == 0) {
        return tl::unexpected(cannot("write", path, "there is not enough memory to compress it"));
    }
    return replace_file(path, content);
}

tl::expected<Pixels<std::uint8_t>, Error> read_png(const std::filesystem::path& path) {
    const tl::expected<std::vector<std::byte>, Error> content = read_file(path);
    if (!content) {
        return tl::unexpected(content.error());
    }
    if (content->size() > INT_MAX) {
        return tl::unexpected(cannot("read", path, "it is larger than 2 GiB"));
    }
    int width = 0;
    int height = 0;
    int channels = 0;
    const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
        stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(content->data()), static_cast<int>(content->size()),
                              &width, &height, &channels, 0),
        &stbi_image_free);
    if (!pixels) {
        return tl::unexpected(cannot("read", path, stbi_failure_reason()));
    }
    Pixels<std::uint8_t> image{static_cast<std::uint32_t>(width),
                               static_cast<std::uint32_t>(height),
                               static_cast<std::uint32_t>(channels),
                               {}};
    image.values.assign(pixels.get(), pixels.get() + std::ptrdiff_t{width} * height * channels);
    return image;
}

} // namespace tyndall::engine
