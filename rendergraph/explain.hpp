// The plan as a table for people: what each pass is, where it was declared, where it runs, and why.
#pragma once

#include <span>
#include <string>

#include "rendergraph/plan.hpp"

namespace tyndall::rg {

/// Measured time of one pass.
struct PassDuration {
    std::uint32_t pass = none;
    double milliseconds = 0.0;
};

/// One row a pass, kept ones in submission order and then those left out: name, injection point at which it was
/// declared, queue and slot where it runs, milliseconds (blank without a measurement), why it is there or not, why that
/// queue; under each row the barriers before it. Then waits between queues and memory.
[[nodiscard]] std::string explain_table(const GraphDesc& graph, const Plan& plan,
                                        std::span<const PassDuration> durations = {});

} // namespace tyndall::rg
