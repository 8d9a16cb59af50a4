// Pictures go out and come back as they were, and a failed write leaves nothing behind.
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "engine/file_io.hpp"
#include "engine/image_io.hpp"

namespace tyndall::engine {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ImageIo : public testing::Test {
protected:
    void SetUp() override {
        std::string name = (std::filesystem::temp_directory_path() / "tyndall-image-io-XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    [[nodiscard]] std::filesystem::path in(const char* name) const { return folder_ / name; }
    [[nodiscard]] std::size_t files() const {
        return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_), {}));
    }
    void spoil(const char* name, const std::string& content) const {
        std::ofstream(in(name), std::ios::binary) << content;
    }

private:
    std::filesystem::path folder_;
};

Pixels<std::uint8_t> ramp(std::uint32_t width, std::uint32_t height, std::uint32_t channels) {
    Pixels<std::uint8_t> image{width, height, channels, {}};
    for (std::uint32_t i = 0; i < width * height * channels; ++i) {
        image.values.push_back(static_cast<std::uint8_t>(i * 37U + i / 11U));
    }
    return image;
}

TEST_F(ImageIo, PngKeepsEveryByte) {
    for (const std::uint32_t channels : {1U, 3U, 4U}) {
        const Pixels<std::uint8_t> image = ramp(61, 17, channels);
        ASSERT_TRUE(write_png(in("a.png"), image).has_value());
        const auto back = read_png(in("a.png"));
        ASSERT_TRUE(back.has_value()) << back.error().message;
        EXPECT_EQ(back->width, 61U);
        EXPECT_EQ(back->height, 17U);
        EXPECT_EQ(back->channels, channels);
        EXPECT_EQ(back->values, image.values);
    }
    EXPECT_EQ(files(), 1U) << "the unfinished file is still there";
}

Pixels<float> radiance(std::uint32_t channels) {
    Pixels<float> image{13, 7, channels, {}};
    const std::array<float, 8> special = {0.0F,   1.0F,    -2.5F, 65504.0F,
                                          1.0e5F, 1.0e-7F, 0.1F,  std::numeric_limits<float>::denorm_min()};
    for (std::uint32_t i = 0; i < 13 * 7 * channels; ++i) {
        image.values.push_back(i < special.size()
                                   ? special[i]
                                   : std::ldexp(1.0F + 1.0e-3F * static_cast<float>(i), static_cast<int>(i % 40) - 20));
    }
    return image;
}

TEST_F(ImageIo, ExrKeepsEveryBitOfAFloat) {
    for (const std::uint32_t channels : {3U, 4U}) {
        const Pixels<float> image = radiance(channels);
        ASSERT_TRUE(write_exr(in("a.exr"), image).has_value());
        const auto back = read_exr(in("a.exr"));
        ASSERT_TRUE(back.has_value()) << back.error().message;
        ASSERT_EQ(back->width, 13U);
        ASSERT_EQ(back->height, 7U);
        ASSERT_EQ(back->channels, channels);
        EXPECT_EQ(std::memcmp(back->values.data(), image.values.data(), image.values.size() * sizeof(float)), 0);
    }
    EXPECT_EQ(files(), 1U);
}

TEST_F(ImageIo, ExrHalfRoundsToNearest) {
    Pixels<float> image{2, 1, 3, {1.0F, 0.1F, 2049.0F, 65504.0F, 1.0e5F, 3.0e-5F}};
    ASSERT_TRUE(write_exr(in("h.exr"), image, ExrPrecision::half).has_value());
    const auto back = read_exr(in("h.exr"));
    ASSERT_TRUE(back.has_value()) << back.error().message;
    EXPECT_EQ(back->values[0], 1.0F);
    EXPECT_EQ(back->values[1], 0.0999755859375F); // 11 bits: 1638 / 16384
    EXPECT_EQ(back->values[2], 2048.0F);          // halfway, to even
    EXPECT_EQ(back->values[3], 65504.0F);
    EXPECT_TRUE(std::isinf(back->values[4]));
    EXPECT_NEAR(back->values[5], 3.0e-5F, 3.0e-8F); // subnormal: steps of 2^-24
}

TEST_F(ImageIo, ErrorsNameTheFile) {
    const std::filesystem::path nowhere = in("no such folder") / "a.png";
    for (const auto& done : {write_png(nowhere, ramp(2, 2, 3)), write_exr(nowhere, radiance(3))}) {
        ASSERT_FALSE(done.has_value());
        EXPECT_THAT(done.error().message,
                    AllOf(HasSubstr(nowhere.string()), HasSubstr("cannot write"), HasSubstr("No such file")));
    }
    EXPECT_THAT(read_png(in("absent.png")).error().message, AllOf(HasSubstr("absent.png"), HasSubstr("No such file")));
    EXPECT_THAT(read_exr(in("absent.exr")).error().message, AllOf(HasSubstr("absent.exr"), HasSubstr("No such file")));
    spoil("bad.png", "this is no picture");
    spoil("bad.exr", "this is no picture");
    spoil("empty.exr", "");
    EXPECT_THAT(read_png(in("bad.png")).error().message, HasSubstr("bad.png"));
    EXPECT_THAT(read_exr(in("bad.exr")).error().message, HasSubstr("bad.exr"));
    EXPECT_THAT(read_exr(in("empty.exr")).error().message, HasSubstr("empty.exr"));
    EXPECT_THAT(read_png(in("")).error().message, HasSubstr("directory"));
}

TEST_F(ImageIo, ExrCutShortIsAnError) {
    ASSERT_TRUE(write_exr(in("a.exr"), radiance(3)).has_value());
    const std::vector<std::byte> whole = read_file(in("a.exr")).value();
    for (std::size_t size = 0; size < whole.size(); size += 7) {
        ASSERT_TRUE(replace_file(in("cut.exr"), std::span(whole).first(size)).has_value());
        EXPECT_FALSE(read_exr(in("cut.exr")).has_value()) << size << " of " << whole.size() << " bytes";
    }
}

TEST_F(ImageIo, WhatIsNoImageIsRefusedAndNothingIsWritten) {
    EXPECT_FALSE(write_png(in("a.png"), {2, 2, 3, std::vector<std::uint8_t>(11)}).has_value());
    EXPECT_FALSE(write_png(in("a.png"), {0, 2, 3, {}}).has_value());
    EXPECT_FALSE(write_png(in("a.png"), {1, 1, 5, std::vector<std::uint8_t>(5)}).has_value());
    EXPECT_FALSE(write_exr(in("a.exr"), {2, 2, 3, std::vector<float>(13)}).has_value());
    EXPECT_FALSE(write_exr(in("a.exr"), {2, 0, 3, {}}).has_value());
    EXPECT_FALSE(write_exr(in("a.exr"), {1, 1, 2, std::vector<float>(2)}).has_value());
    EXPECT_EQ(files(), 0U);
}

TEST_F(ImageIo, AFailedWriteKeepsWhatWasThere) {
    // The name is a folder's: the file is written beside it and cannot be renamed over it.
    std::filesystem::create_directory(in("taken.png"));
    spoil("taken.png/inside", "x");
    const auto done = write_png(in("taken.png"), ramp(2, 2, 3));
    ASSERT_FALSE(done.has_value());
    EXPECT_THAT(done.error().message, HasSubstr("taken.png"));
    EXPECT_TRUE(std::filesystem::exists(in("taken.png/inside")));
    EXPECT_EQ(files(), 1U);
}

} // namespace
} // namespace tyndall::engine
