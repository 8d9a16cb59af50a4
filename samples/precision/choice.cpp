#include "samples/precision/choice.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

namespace tyndall::samples {
namespace {

/// Index of the first in the order of `key` among those for which `allowed` holds.
template <class Allowed, class Key>
std::optional<std::size_t> first_by(std::span<const Measured> all, const Allowed& allowed, const Key& key) {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (allowed(all[i]) && (!best || key(all[i]) < key(all[*best]))) {
            best = i;
        }
    }
    return best;
}

/// A positive number with `unit` behind it or nothing.
std::optional<std::pair<double, bool>> number_with_unit(std::string_view text, std::string_view unit) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const std::string_view rest(end, static_cast<std::size_t>(text.data() + text.size() - end));
    if (error != std::errc{} || !(value > 0.0) || (!rest.empty() && rest != unit)) {
        return std::nullopt;
    }
    return std::pair{value, !rest.empty()};
}

} // namespace

std::vector<bool> pareto_front(std::span<const Measured> all) {
    std::vector<bool> front;
    for (const Measured& one : all) {
        front.push_back(std::none_of(all.begin(), all.end(), [&](const Measured& other) {
            return other.error <= one.error && other.time_ms <= one.time_ms &&
                   (other.error < one.error || other.time_ms < one.time_ms);
        }));
    }
    return front;
}

std::optional<std::size_t> cheapest_within(std::span<const Measured> all, double error) {
    return first_by(
        all, [&](const Measured& m) { return m.error <= error; },
        [](const Measured& m) {
            return std::pair{m.time_ms, m.error};
        });
}

std::optional<std::size_t> most_exact_within(std::span<const Measured> all, double budget_ms) {
    return first_by(
        all, [&](const Measured& m) { return m.time_ms <= budget_ms; },
        [](const Measured& m) {
            return std::pair{m.error, m.time_ms};
        });
}

tl::expected<double, std::string> parse_error_bound(std::string_view text) {
    const auto number = number_with_unit(text, "%");
    const double bound = number ? number->first * (number->second ? 0.01 : 1.0) : 0.0;
    if (!(bound > 0.0 && bound <= 1.0)) {
        return tl::unexpected("--error must be above 0 and at most 100%, as in 2% or 0.02, not '" + std::string(text) +
                              "'");
    }
    return bound;
}

tl::expected<double, std::string> parse_budget_ms(std::string_view text) {
    const auto number = number_with_unit(text, "ms");
    if (!number || !(number->first <= 1e6)) {
        return tl::unexpected("--budget must be above 0 and at most 1e6 milliseconds, as in 30ms, not '" +
                              std::string(text) + "'");
    }
    return number->first;
}

} // namespace tyndall::samples
