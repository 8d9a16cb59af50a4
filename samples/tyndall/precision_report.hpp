// What the precision study prints and writes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "samples/precision/metrics.hpp"
#include "samples/tyndall/arguments.hpp"

namespace tyndall::samples {

/// One picture against one truth.
struct PrecisionRow {
    std::string scene;
    PrecisionConfiguration configuration;
    std::uint32_t frame = 1;
    std::string physics; ///< of the truth
    ErrorMetrics error;
    double reference_error = 0.0; ///< the truth's own, relative L2
    double fog_ms = 0.0;          ///< of the passes that a frame has with fog only
    double frame_ms = 0.0;
    bool on_front = false; ///< of its scene, frame and truth: nothing is both faster and more exact
};

/// Sets `on_front`.
void mark_front(std::vector<PrecisionRow>& rows);

[[nodiscard]] std::string to_text(const PrecisionConfiguration& configuration);
[[nodiscard]] std::string to_csv(std::span<const PrecisionRow> rows, const std::string& device);
[[nodiscard]] std::string to_json(std::span<const PrecisionRow> rows, Size size, const std::string& device);
[[nodiscard]] std::string to_table(std::span<const PrecisionRow> rows, const std::string& device);

} // namespace tyndall::samples
