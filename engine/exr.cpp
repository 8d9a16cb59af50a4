#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <string>

#include <half.h>
#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>

#include "engine/file_io.hpp"
#include "engine/image_io.hpp"

namespace tyndall::engine {
namespace {

constexpr std::array<const char*, 4> channel_names = {"R", "G", "B", "A"};
/// Larger files are refused before memory is asked for: what a broken header claims may be anything.
constexpr std::int64_t largest_pixel_count = std::int64_t{1} << 30U;

Error cannot(const char* what, const std::filesystem::path& path, const std::string& why) {
    return {std::string("cannot ") + what + " '" + path.string() + "': " + why};
}

/// A file in memory that OpenEXR writes to; it goes back to fill in tables.
class MemoryOutput : public Imf::OStream {
public:
    MemoryOutput() : Imf::OStream("memory") {}
    void write(const char c[], int n) override {
        const std::size_t end = position_ + static_cast<std::size_t>(n);
        content_.resize(std::max(content_.size(), end));
        std::memcpy(content_.data() + position_, c, static_cast<std::size_t>(n));
        position_ = end;
    }
    std::uint64_t tellp() override { return position_; }
    void seekp(std::uint64_t position) override { position_ = position; }
    [[nodiscard]] const std::vector<std::byte>& content() const { return content_; }

private:
    std::vector<std::byte> content_;
    std::size_t position_ = 0;
};

class MemoryInput : public Imf::IStream {
public:
    explicit MemoryInput(const std::vector<std::byte>& content) : Imf::IStream("memory"), content_(content) {}
    bool read(char c[], int n) override {
        const auto count = static_cast<std::size_t>(n);
        if (position_ > content_.size() || content_.size() - position_ < count) {
            throw std::length_error("it ends too early");
        }
        std::memcpy(c, content_.data() + position_, count);
        position_ += count;
        return position_ < content_.size();
    }
    std::uint64_t tellg() override { return position_; }
    void seekg(std::uint64_t position) override { position_ = position; }

private:
    const std::vector<std::byte>& content_;
    std::size_t position_ = 0;
};

/// OpenEXR's exceptions tell of the stream "memory" in their first words and of the cause in the rest.
template <typename F>
auto guarded(const char* what, const std::filesystem::path& path, F&& function)
    -> tl::expected<decltype(function()), Error> {
    try {
        return function();
    } catch (const std::exception& error) {
        return tl::unexpected(cannot(what, path, error.what()));
    }
}

/// `values` channel by channel of each pixel, as OpenEXR's writer sees them; it does not change them, but its slices
/// are not const.
template <typename T>
std::vector<std::byte> encode(const Pixels<float>& image, Imf::PixelType type, std::vector<T> values) {
    Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height));
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::addChromaticities(header, Imf::Chromaticities()); // whose default is BT.709
    Imf::addWhiteLuminance(header, 1.0F);
    Imf::FrameBuffer frame;
    const std::size_t pixel = image.channels * sizeof(T);
    for (std::uint32_t c = 0; c < image.channels; ++c) {
        header.channels().insert(channel_names[c], Imf::Channel(type));
        frame.insert(channel_names[c],
                     Imf::Slice(type, reinterpret_cast<char*>(values.data() + c), pixel, pixel * image.width));
    }
    MemoryOutput output;
    {
        Imf::OutputFile file(output, header);
        file.setFrameBuffer(frame);
        file.writePixels(static_cast<int>(image.height));
    } // the table of lines is written here
    return output.content();
}

Pixels<float> decode(const std::vector<std::byte>& content) {
    MemoryInput input(content);
    Imf::InputFile file(input);
    const Imath::Box2i window = file.header().dataWindow();
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
    if (width < 1 || height < 1 || width > largest_pixel_count / height) {
        throw std::length_error("its size is not one of an image");
    }
    Pixels<float> image;
    image.width = static_cast<std::uint32_t>(width);
    image.height = static_cast<std::uint32_t>(height);
    image.channels = file.header().channels().findChannel("A") != nullptr ? 4 : 3;
    image.values.resize(std::size_t{image.width} * image.height * image.channels);
    const auto pixel = static_cast<std::ptrdiff_t>(image.channels * sizeof(float));
    const std::ptrdiff_t row = pixel * static_cast<std::ptrdiff_t>(width);
    Imf::FrameBuffer frame;
    for (std::uint32_t c = 0; c < image.channels; ++c) {
        // OpenEXR addresses pixels by their place in the display window.
        char* base = reinterpret_cast<char*>(image.values.data() + c) - window.min.x * pixel - window.min.y * row;
        frame.insert(channel_names[c],
                     Imf::Slice(Imf::FLOAT, base, static_cast<std::size_t>(pixel), static_cast<std::size_t>(row)));
    }
    file.setFrameBuffer(frame);
    file.readPixels(window.min.y, window.max.y);
    return image;
}

} // namespace

tl::expected<void, Error> write_exr(const std::filesystem::path& path, const Pixels<float>& image,
                                    ExrPrecision precision) {
    const std::size_t count = std::size_t{image.width} * image.height * image.channels;
    if (image.channels < 3 || image.channels > 4 || count == 0 || image.values.size() != count) {
        return tl::unexpected(cannot("write", path,
                                     "an EXR cannot hold " + std::to_string(image.width) + "x" +
                                         std::to_string(image.height) + " pixels of " + std::to_string(image.channels) +
                                         " channels made of " + std::to_string(image.values.size()) + " values"));
    }
    const tl::expected<std::vector<std::byte>, Error> content = guarded("write", path, [&] {
        return precision == ExrPrecision::half
                   ? encode<half>(image, Imf::HALF, {image.values.begin(), image.values.end()})
                   : encode<float>(image, Imf::FLOAT, image.values);
    });
    if (!content) {
        return tl::unexpected(content.error());
    }
    return replace_file(path, *content);
}

tl::expected<Pixels<float>, Error> read_exr(const std::filesystem::path& path) {
    const tl::expected<std::vector<std::byte>, Error> content = read_file(path);
    if (!content) {
        return tl::unexpected(content.error());
    }
    return guarded("read", path, [&] { return decode(*content); });
}

} // namespace tyndall::engine
