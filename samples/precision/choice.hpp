// Choosing by error and time from what was measured.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

namespace tyndall::samples {

struct Measured {
    double error = 0.0; ///< relative L2
    double time_ms = 0.0;
};

/// Whether each is on the Pareto front: none other is better in one of the two and no worse in the other.
[[nodiscard]] std::vector<bool> pareto_front(std::span<const Measured> all);

/// The cheapest whose error is at most `error`; the more exact of equally cheap ones. None if all are worse.
[[nodiscard]] std::optional<std::size_t> cheapest_within(std::span<const Measured> all, double error);

/// The most exact that takes at most `budget_ms`; the cheaper of equally exact ones. None if all take longer.
[[nodiscard]] std::optional<std::size_t> most_exact_within(std::span<const Measured> all, double budget_ms);

/// "2%" or "0.02", above 0 and at most 100 %. The error is one sentence.
[[nodiscard]] tl::expected<double, std::string> parse_error_bound(std::string_view text);
/// "30ms" or "30", above 0 and at most 1e6. The error is one sentence.
[[nodiscard]] tl::expected<double, std::string> parse_budget_ms(std::string_view text);

} // namespace tyndall::samples
