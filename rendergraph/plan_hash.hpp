// A fingerprint of everything that decides a plan.
#pragma once

#include <cstdint>

#include "rendergraph/costs.hpp"
#include "rendergraph/plan.hpp"

namespace tyndall::rg {

/// 128 bits, so that inputs that differ by accident practically never share it and no comparison of the inputs stands
/// behind it; it does not resist inputs made to collide. It reaches no plan.
struct PlanHash {
    std::uint64_t low = 0;
    std::uint64_t high = 0;
    friend bool operator==(const PlanHash&, const PlanHash&) = default;
};

/// Of all that compile reads but the previous plan. Outside it are callbacks, places in source code and the mistakes of
/// the declaration, which reach no plan. Allocates nothing. O(passes + accesses + resources + bytes of names).
/// Source: two lanes of wyhash's multiply-and-fold (Wang Yi, https://github.com/wangyi-fudan/wyhash, public domain).
[[nodiscard]] PlanHash hash_of_inputs(const GraphDesc& graph, const QueueTopology& topology,
                                      const MemoryRequirements& memory, const CompileOptions& options,
                                      const Costs& costs);

} // namespace tyndall::rg
