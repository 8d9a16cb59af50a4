#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <tl/expected.hpp>

namespace tyndall::hall {

/// An 8-bit image with 3 or 4 channels, rows from the top, as PNG stores it.
class Image {
public:
    Image(int width, int height, int channels);

    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    [[nodiscard]] int channels() const { return channels_; }

    /// Writes a pixel. `value` is in [0, 1] and stored linearly; `step` > 1 rounds to multiples of `step` out of 255,
    /// which costs nothing visible on stone and halves the size of a noisy PNG.
    void set(int x, int y, glm::vec4 value, int step = 1);

    /// Encodes to PNG and writes the file. The error is one sentence that names the path.
    [[nodiscard]] tl::expected<void, std::string> write_png(const std::filesystem::path& path) const;

private:
    int width_;
    int height_;
    int channels_;
    std::vector<std::uint8_t> texels_;
};

/// The sRGB transfer curve (IEC 61966-2-1), component by component: colours are computed linearly and stored encoded.
[[nodiscard]] glm::vec3 to_srgb(glm::vec3 linear);

} // namespace tyndall::hall
