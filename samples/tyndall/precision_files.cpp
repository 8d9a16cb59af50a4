#include "samples/tyndall/precision_files.hpp"

#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <vector>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/file_io.hpp"
#include "samples/precision/plot_script.hpp"

namespace tyndall::samples {
namespace {

template <typename T>
using Expected = tl::expected<T, std::string>;

static_assert(std::endian::native == std::endian::little);

Expected<void> write_pfm(const std::filesystem::path& path, const engine::Pixels<float>& image) {
    const std::string header = "PF\n" + std::to_string(image.width) + " " + std::to_string(image.height) + "\n-1.0\n";
    const std::size_t row_bytes = 3 * sizeof(float) * image.width;
    std::vector<std::byte> file(header.size() + row_bytes * image.height);
    std::memcpy(file.data(), header.data(), header.size());
    for (std::size_t y = 0; y < image.height; ++y) {
        std::memcpy(file.data() + header.size() + row_bytes * (image.height - 1 - y),
                    image.values.data() + std::size_t{3} * image.width * y, row_bytes);
    }
    if (const auto written = engine::replace_file(path, file); !written) {
        return tl::unexpected(written.error().message);
    }
    return {};
}

} // namespace

Expected<void> write_pictures(const std::filesystem::path& folder, const Bench& bench,
                              const engine::Pixels<float>& picture) {
    engine::Pixels<float> exact{bench.size.width, bench.size.height, 3, {}};
    exact.values.assign(std::size_t{3} * exact.width * exact.height, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = 0; i < bench.pixels.size(); ++i) {
        const std::size_t first = 3 * (std::size_t{bench.pixels[i].y} * exact.width + bench.pixels[i].x);
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const auto at = static_cast<glm::dvec3::length_type>(channel);
            exact.values[first + channel] = static_cast<float>(bench.truths.front().values[i][at]);
        }
    }
    if (auto written = write_pfm(folder / (bench.scene.name + "_exact.pfm"), exact); !written) {
        return written;
    }
    return write_pfm(folder / (bench.scene.name + "_picture.pfm"), picture);
}

Expected<void> draw_plots(const std::filesystem::path& folder) {
    constexpr int no_matplotlib = 3; // what the script then returns, having said so
    std::string python = "/usr/bin/python3";
    std::string option = "-c";
    std::string script = plot_script;
    std::string where = folder.string();
    const std::array<char*, 5> arguments{python.data(), option.data(), script.data(), where.data(), nullptr};
    pid_t process = 0;
    int status = 0;
    if (const int error = posix_spawn(&process, python.c_str(), nullptr, nullptr, arguments.data(), environ);
        error != 0) {
        return tl::unexpected("Cannot run " + python + " to draw the plots: " + std::strerror(error));
    }
    if (waitpid(process, &status, 0) != process || !WIFEXITED(status) ||
        (WEXITSTATUS(status) != 0 && WEXITSTATUS(status) != no_matplotlib)) {
        return tl::unexpected("The plots of '" + where + "' could not be drawn");
    }
    return {};
}

} // namespace tyndall::samples
