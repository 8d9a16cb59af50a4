// The rows of tyndall stability as table, CSV and JSON.
#pragma once

#include <optional>
#include <span>
#include <string>

namespace tyndall::samples {

struct StabilityRow {
    std::string name;
    std::string parameter;
    std::string measure; ///< what `worst` is
    std::optional<double> worst;
    std::optional<double> bound; ///< of it
    std::string broken;          ///< what else is out of bounds, or what went wrong; empty: nothing

    [[nodiscard]] bool passed() const { return broken.empty() && (!bound || !worst || *worst <= *bound); }
};

[[nodiscard]] std::string to_table(std::span<const StabilityRow> rows, const std::string& device);
[[nodiscard]] std::string to_csv(std::span<const StabilityRow> rows, const std::string& device);
[[nodiscard]] std::string to_json(std::span<const StabilityRow> rows, const std::string& device);

} // namespace tyndall::samples
