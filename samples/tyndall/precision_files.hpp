// What the precision study leaves in a folder besides its tables: pictures and plots.
#pragma once

#include <filesystem>
#include <string>

#include <tl/expected.hpp>

#include "samples/tyndall/precision_bench.hpp"

namespace tyndall::samples {

/// `<scene>_picture.pfm`, `picture` itself, and `<scene>_exact.pfm`, the bench's exact picture with all of physics, NaN
/// where it was not computed. Portable float maps: 32 bits, little endian, rows from the bottom.
[[nodiscard]] tl::expected<void, std::string> write_pictures(const std::filesystem::path& folder, const Bench& bench,
                                                             const engine::Pixels<float>& picture);

/// Draws the plots of a folder that holds precision.csv, and their page, or stability.csv (samples/precision/plot.py,
/// which the program carries; needs Debian's python3-matplotlib, without which a sentence says so and nothing is
/// drawn).
[[nodiscard]] tl::expected<void, std::string> draw_plots(const std::filesystem::path& folder);

} // namespace tyndall::samples
