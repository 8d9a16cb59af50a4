// What passes and waits cost: the input by which compile decides queues and variants.
#pragma once

#include <cstdint>
#include <vector>

namespace tyndall::rg {

/// How long a pass lasts when it has the device to itself, in nanoseconds.
struct PassCost {
    std::int64_t mean_ns = 0;      ///< 0: not known, Costs::unknown_pass_ns is used
    std::int64_t deviation_ns = 0; ///< standard deviation
    friend bool operator==(const PassCost&, const PassCost&) = default;
};

/// Integers throughout, so that the same costs give the same plan everywhere.
struct Costs {
    std::vector<PassCost> of_pass = {};     ///< by pass index; shorter or empty: not known
    std::int64_t unknown_pass_ns = 100'000; ///< what a pass without a measurement is taken to last
    std::int64_t cross_queue_ns = 20'000;   ///< one wait between queues: submission and semaphore
    std::int64_t slowdown_permille = 1'500; ///< of a pass while passes run on other queues too; at least 1000
    std::int64_t threshold_ns = 100'000;    ///< overlap must gain at least this ...
    std::int64_t threshold_permille = 20;   ///< ... and this share of the serial frame (the larger counts)

    /// Solo duration of a pass, at least 1.
    [[nodiscard]] std::int64_t duration_ns(std::uint32_t pass) const {
        const std::int64_t mean = pass < of_pass.size() ? of_pass[pass].mean_ns : 0;
        const std::int64_t known = mean > 0 ? mean : unknown_pass_ns;
        return known > 0 ? known : 1;
    }
    friend bool operator==(const Costs&, const Costs&) = default;
};

} // namespace tyndall::rg
