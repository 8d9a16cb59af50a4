// What is uploaded is there, and the levels of a texture are averages of light, not of codes.
#include <array>
#include <cstring>

#include <gmock/gmock.h>

#include "engine/read_back.hpp"
#include "engine/upload.hpp"
#include "tests/engine/device_fixture.hpp"

namespace tyndall::engine {
namespace {

using testing::HasSubstr;

std::vector<std::uint8_t> level(const Device& device, const DeviceImage& image, std::uint32_t mip) {
    const VkExtent3D whole = image.info().extent;
    const auto bytes = read_image(device, image.handle(),
                                  {.format = image.info().format,
                                   .extent = {std::max(whole.width >> mip, 1U), std::max(whole.height >> mip, 1U), 1},
                                   .mip = mip})
                           .value();
    std::vector<std::uint8_t> values(bytes.size());
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

/// Black and white texels alternate, opaque.
std::vector<std::uint8_t> checkers(std::uint32_t width, std::uint32_t height) {
    std::vector<std::uint8_t> texels;
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            const auto value = static_cast<std::uint8_t>((x + y) % 2 == 0 ? 0 : 255);
            texels.insert(texels.end(), {value, value, value, 255});
        }
    }
    return texels;
}

TEST_F(DeviceTest, UploadedBuffersHoldTheirContent) {
    auto uploader = Uploader::create(device()).value();
    std::vector<Buffer> buffers;
    std::vector<std::vector<std::uint32_t>> contents;
    for (std::uint32_t b = 0; b < 5; ++b) {
        std::vector<std::uint32_t>& content = contents.emplace_back(1 + b * 1000);
        for (std::uint32_t i = 0; i < content.size(); ++i) {
            content[i] = i * 2654435761U + b;
        }
        buffers.push_back(uploader.buffer(std::as_bytes(std::span(content)), VK_BUFFER_USAGE_TRANSFER_SRC_BIT).value());
    }
    ASSERT_TRUE(uploader.finish().has_value());
    for (std::size_t b = 0; b < buffers.size(); ++b) {
        const auto bytes = read_buffer(device(), buffers[b]).value();
        ASSERT_EQ(bytes.size(), contents[b].size() * 4);
        EXPECT_EQ(std::memcmp(bytes.data(), contents[b].data(), bytes.size()), 0) << b;
    }
    EXPECT_TRUE(uploader.finish().has_value()) << "with nothing gathered";
}

TEST_F(DeviceTest, LevelsOfSrgbTexturesAverageLight) {
    auto uploader = Uploader::create(device()).value();
    const auto texels = checkers(8, 4);
    const auto bytes = std::as_bytes(std::span(texels));
    const DeviceImage coded = uploader.texture(bytes, VK_FORMAT_R8G8B8A8_SRGB, {8, 4}, true).value();
    const DeviceImage plain = uploader.texture(bytes, VK_FORMAT_R8G8B8A8_UNORM, {8, 4}, true).value();
    ASSERT_TRUE(uploader.finish().has_value());
    ASSERT_EQ(coded.info().mips, 4U);
    EXPECT_EQ(level(device(), coded, 0), texels);
    for (std::uint32_t mip = 1; mip < 4; ++mip) {
        const auto values = level(device(), coded, mip);
        EXPECT_EQ(values.size(), (8U >> mip) * std::max(4U >> mip, 1U) * 4);
        for (std::size_t i = 0; i < values.size(); ++i) {
            // Half the light is code 188 (IEC 61966-2-1: 1.055 * 0.5^(1/2.4) - 0.055 = 0.7354); of codes it were 128.
            EXPECT_NEAR(values[i], i % 4 == 3 ? 255 : 188, 1) << "level " << mip;
            EXPECT_NEAR(level(device(), plain, mip)[i], i % 4 == 3 ? 255 : 128, 1) << "level " << mip;
        }
    }
}

TEST_F(DeviceTest, TexturesOfOddSizeHaveAllTheirLevels) {
    auto uploader = Uploader::create(device()).value();
    std::vector<std::uint8_t> texels(7 * 3 * 4, 200);
    const DeviceImage image =
        uploader.texture(std::as_bytes(std::span(texels)), VK_FORMAT_R8G8B8A8_UNORM, {7, 3}, true).value();
    ASSERT_TRUE(uploader.finish().has_value());
    ASSERT_EQ(image.info().mips, 3U);
    for (std::uint32_t mip = 0; mip < 3; ++mip) {
        EXPECT_THAT(level(device(), image, mip), testing::Each(200)) << "level " << mip;
    }
}

TEST_F(DeviceTest, TexturesThatCannotBeAreErrors) {
    auto uploader = Uploader::create(device()).value();
    const std::vector<std::byte> texels(16);
    const auto short_of = uploader.texture(texels, VK_FORMAT_R8G8B8A8_UNORM, {2, 3}, false);
    ASSERT_FALSE(short_of.has_value());
    EXPECT_THAT(short_of.error().message, testing::AllOf(HasSubstr("2x3"), HasSubstr("24 bytes"), HasSubstr("16")));
    EXPECT_FALSE(uploader.texture({}, VK_FORMAT_R8G8B8A8_UNORM, {0, 4}, true).has_value());
    const std::uint32_t beyond = device().properties().limits.maxImageDimension2D + 1;
    const auto large = uploader.texture({}, VK_FORMAT_R8G8B8A8_UNORM, {beyond, 1}, true);
    ASSERT_FALSE(large.has_value());
    EXPECT_THAT(large.error().message, HasSubstr(std::to_string(beyond - 1)));
}

TEST_F(DeviceTest, MemoryThatIsNotThereIsAnErrorThatTellsHowMuch) {
    const auto buffer =
        Buffer::create(device(), VkDeviceSize{1} << 50U, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, MemoryUse::device);
    ASSERT_FALSE(buffer.has_value());
    EXPECT_THAT(buffer.error().message, HasSubstr("MiB"));
    (void)take_errors(); // the layer has its own opinion of such a size
}

} // namespace
} // namespace tyndall::engine
