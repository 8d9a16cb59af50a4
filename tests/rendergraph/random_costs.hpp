// Seeded durations for random frames.
#pragma once

#include <random>

#include "rendergraph/costs.hpp"

namespace tyndall::rg::test {

/// Durations of 10 us to 2 ms, a few long and many short. With `any_gain` there is no threshold and no hysteresis.
inline Costs random_costs(std::uint32_t seed, std::size_t passes, bool any_gain) {
    std::mt19937 bits(seed ^ 0x9e3779b9U);
    const auto below = [&bits](std::uint32_t limit) { return static_cast<std::int64_t>(bits() % limit); };
    Costs costs;
    for (std::size_t i = 0; i < passes; ++i) {
        const std::int64_t length = 1 + below(4);
        costs.of_pass.push_back({.mean_ns = 10'000 + below(125'000) * length * length});
    }
    costs.cross_queue_ns = below(3) * 10'000;
    costs.slowdown_permille = 1'000 + 250 * below(4);
    if (any_gain) {
        costs.threshold_ns = 0;
        costs.threshold_permille = 0;
    }
    return costs;
}

} // namespace tyndall::rg::test
