// What the precision study chooses from what it measured, and how the scene's own configuration stands in it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "samples/tyndall/arguments.hpp"
#include "samples/tyndall/precision_bench.hpp"
#include "samples/tyndall/precision_report.hpp"

namespace tyndall::samples {

/// What bounds of error and time choose in the bench's scene, each run once more, and why. What does not keep its word
/// when it is run again is struck out, and the next is chosen; where nothing reaches a bound, by how much the nearest
/// misses it. Sentences, a line each; empty without bounds.
[[nodiscard]] tl::expected<std::string, std::string> choose_and_run(const PrecisionArguments& arguments, Bench& bench,
                                                                    std::span<const PrecisionRow> rows);

/// Whether the scene's own configuration is on the front, or what beats it and by how much; empty if it has no rival.
[[nodiscard]] std::string own_against_front(const Bench& bench, std::span<const PrecisionRow> rows);

/// The same of all scenes together, by the root mean square of their errors and the sum of their times, of those
/// configurations that every scene was measured in (visibilities where there is a sun); empty of a single scene.
[[nodiscard]] std::string own_against_front_of_all(std::uint32_t last_frame, std::span<const PrecisionRow> rows);

} // namespace tyndall::samples
