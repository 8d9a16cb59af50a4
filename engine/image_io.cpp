#include "engine/image_io.hpp"

#include <cstring>
#include <exception>
#include <fstream>
#include <string>
#include <system_error>

#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <unistd.h>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#include <stb_image.h>
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb_image_write.h>
#pragma GCC diagnostic pop

namespace tyndall::engine {
namespace {

constexpr const char* channel_names[] = {"R", "G", "B", "A"};

Error cannot(const char* what, const std::filesystem::path& path, const std::string& why) {
    return {std::string("Cannot ") + what + " '" + path.string() + "'" + (why.empty() ? "" : ": " + why)};
}

std::filesystem::path beside(const std::filesystem::path& path) { return path.string() + "." + std::to_string(getpid()); }

tl::expected<void, Error> into_place(const std::filesystem::path& from, const std::filesystem::path& to) {
    std::error_code error;
    std::filesystem::rename(from, to, error);
    if (error) {
        std::error_code ignored;
        std::filesystem::remove(from, ignored);
        return tl::unexpected(cannot("write", to, error.message()));
    }
    return {};
}

} // namespace

tl::expected<void, Error> write_png(const std::filesystem::path& path, const Pixels<std::uint8_t>& image) {
    const std::filesystem::path temporary = beside(path);
    const int written = stbi_write_png(temporary.c_str(), static_cast<int>(image.width), static_cast<int>(image.height),
                                       static_cast<int>(image.channels), image.values.data(),
                                       static_cast<int>(image.width * image.channels));
    if (written == 0) {
        std::error_code ignored;
        std::filesystem::remove(temporary, ignored);
        return tl::unexpected(cannot("write", path, "is the folder there, and may it be written to?"));
    }
    return into_place(temporary, path);
}

tl::expected<Pixels<std::uint8_t>, Error> read_png(const std::filesystem::path& path) {
    int width = 0;
    int height = 0;
    int channels = 0;
    std::uint8_t* data = stbi_load(path.c_str(), &width, &height, &channels, 0);
    if (data == nullptr) {
        return tl::unexpected(cannot("read", path, stbi_failure_reason()));
    }
    Pixels<std::uint8_t> image{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height),
                               static_cast<std::uint32_t>(channels), {}};
    image.values.assign(data, data + static_cast<std::ptrdiff_t>(width) * height * channels);
    stbi_image_free(data);
    return image;
}

tl::expected<void, Error> write_exr(const std::filesystem::path& path, const Pixels<float>& image) {
    const std::filesystem::path temporary = beside(path);
    try {
        Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height));
        Imf::FrameBuffer frame;
        const std::size_t pixel = image.channels * sizeof(float);
        std::vector<float> values = image.values; // OpenEXR's slices are not const
        for (std::uint32_t c = 0; c < image.channels; ++c) {
            header.channels().insert(channel_names[c], Imf::Channel(Imf::FLOAT));
            frame.insert(channel_names[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data() + c), pixel, pixel * image.width));
        }
        Imf::OutputFile file(temporary.c_str(), header);
        file.setFrameBuffer(frame);
        file.writePixels(static_cast<int>(image.height));
    } catch (const std::exception& error) {
        std::error_code ignored;
        std::filesystem::remove(temporary, ignored);
        return tl::unexpected(cannot("write", path, "is the folder there, and may it be written to?"));
    }
    return into_place(temporary, path);
}

tl::expected<Pixels<float>, Error> read_exr(const std::filesystem::path& path) {
    try {
        Imf::InputFile file(path.c_str());
        const Imath::Box2i window = file.header().dataWindow();
        Pixels<float> image;
        image.width = static_cast<std::uint32_t>(window.max.x - window.min.x + 1);
        image.height = static_cast<std::uint32_t>(window.max.y - window.min.y + 1);
        image.channels = file.header().channels().findChannel("A") != nullptr ? 4 : 3;
        image.values.resize(std::size_t{image.width} * image.height * image.channels);
        const std::size_t pixel = image.channels * sizeof(float);
        const std::size_t row = pixel * image.width;
        Imf::FrameBuffer frame;
        for (std::uint32_t c = 0; c < image.channels; ++c) {
            // OpenEXR addresses by absolute pixel position.
            char* base = reinterpret_cast<char*>(image.values.data() + c) - window.min.x * static_cast<std::ptrdiff_t>(pixel) -
                         window.min.y * static_cast<std::ptrdiff_t>(row);
            frame.insert(channel_names[c], Imf::Slice(Imf::FLOAT, base, pixel, row));
        }
        file.setFrameBuffer(frame);
        file.readPixels(window.min.y, window.max.y);
        return image;
    } catch (const std::exception& error) {
        return tl::unexpected(cannot("read", path, error.what()));
    }
}

} // namespace tyndall::engine
