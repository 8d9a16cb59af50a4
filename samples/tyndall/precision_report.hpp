// What the precision study prints and writes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "samples/precision/metrics.hpp"
#include "samples/tyndall/arguments.hpp"

namespace tyndall::samples {

/// By the values of SunVisibility; those of the integrators are in samples/precision/orders.hpp.
inline constexpr std::array visibility_names{"one_tap", "n_taps", "prefiltered", "lit_fraction"};

/// One picture against one truth.
struct PrecisionRow {
    std::string scene;
    PrecisionConfiguration configuration;
    std::uint32_t frame = 1;
    std::string physics; ///< of the truth
    ErrorMetrics error;
    double reference_error = 0.0; ///< the truth's own, relative L2
    double clocked_ms = 0.0;      ///< of the passes that a frame has with fog only, median of the frames
    double relative_time = 1.0;   ///< of the same, by that of the scene's own configuration in the frame that followed
    double fog_ms = 0.0;          ///< relative_time in milliseconds; clocked_ms where nothing is compared
    double frame_ms = 0.0;
    bool is_own = false;   ///< the configuration is what the scene's fog asks for
    bool on_front = false; ///< of its scene, frame and truth: nothing is both faster and more exact
};

/// What is left of a picture's error without one of its causes, or against a truth that leaves something out.
struct CauseRow {
    std::string scene;
    std::string cause;
    std::string physics;
    ErrorMetrics first; ///< frame
    ErrorMetrics last;
    double fog_ms = 0.0;
    double frame_ms = 0.0;
};

/// Sets `on_front`.
void mark_front(std::vector<PrecisionRow>& rows);

/// "2.5 %", "1.2 ms", "exponential, one_tap, 160x90x64"; and of a row, all three.
[[nodiscard]] std::string percent(double value);
[[nodiscard]] std::string milliseconds(double value);
[[nodiscard]] std::string to_text(const PrecisionConfiguration& configuration);
[[nodiscard]] std::string to_text(const PrecisionRow& row);

[[nodiscard]] std::string to_csv(std::span<const PrecisionRow> rows, const std::string& device);
[[nodiscard]] std::string to_csv(std::span<const CauseRow> rows);
[[nodiscard]] std::string to_json(std::span<const PrecisionRow> rows, std::span<const CauseRow> causes, Size size,
                                  const std::string& device);
[[nodiscard]] std::string to_table(std::span<const PrecisionRow> rows, const std::string& device);
/// Of one scene or several.
[[nodiscard]] std::string to_table(std::span<const CauseRow> rows);

/// By how much each scene's smallest error exceeds the exact picture's own, and which do by less than 100 times.
[[nodiscard]] std::string reference_margins(std::span<const PrecisionRow> rows);

} // namespace tyndall::samples
