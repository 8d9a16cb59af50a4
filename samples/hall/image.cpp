#include "samples/hall/image.hpp"

#include <algorithm>
#include <cmath>

#include <stb/stb_image_write.h>

namespace tyndall::hall {

Image::Image(int width, int height, int channels)
    : width_(width), height_(height), channels_(channels),
      texels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(channels)) {
}

void Image::set(int x, int y, glm::vec4 value, int step) {
    const std::size_t base =
        (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)) *
        static_cast<std::size_t>(channels_);
    for (int channel = 0; channel < channels_; ++channel) {
        const float scaled = std::clamp(value[channel], 0.0F, 1.0F) * 255.0F / static_cast<float>(step);
        const int rounded = std::min(255, static_cast<int>(std::lround(scaled)) * step);
        texels_[base + static_cast<std::size_t>(channel)] = static_cast<std::uint8_t>(rounded);
    }
}

tl::expected<void, std::string> Image::write_png(const std::filesystem::path& path) const {
    const int row_bytes = width_ * channels_;
    if (stbi_write_png(path.c_str(), width_, height_, channels_, texels_.data(), row_bytes) == 0) {
        return tl::unexpected("cannot write the image " + path.string());
    }
    return {};
}

glm::vec3 to_srgb(glm::vec3 linear) {
    glm::vec3 encoded{0.0F};
    for (int i = 0; i < 3; ++i) {
        const float c = std::clamp(linear[i], 0.0F, 1.0F);
        encoded[i] = c <= 0.0031308F ? 12.92F * c : 1.055F * std::pow(c, 1.0F / 2.4F) - 0.055F;
    }
    return encoded;
}

} // namespace tyndall::hall
