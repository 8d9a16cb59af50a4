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
/// queue; under each row the barriers before it. Then waits, releases and the host's semaphores; where each resource's
/// bytes are and why; which form of each variant is kept; last the decision to overlap or not in one line. Everything
/// in the plan is listed with its reason. O(plan + passes^2 / 64 + resources^2).
[[nodiscard]] std::string explain_table(const GraphDesc& graph, const Plan& plan,
                                        std::span<const PassDuration> durations = {});

} // namespace tyndall::rg
