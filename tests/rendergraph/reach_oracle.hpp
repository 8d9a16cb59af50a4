// A second opinion on a plan, by another method than the checker's: each access alone is followed forward through all
// later commands of the frame. Slow and simple; it knows of order and memory, not of layouts, owners and content.
#pragma once

#include <cstdint>
#include <vector>

#include "rendergraph/plan.hpp"

namespace tyndall::rg::test {

/// What lets a later access rely on an earlier one.
enum class Means : std::uint8_t {
    nothing,      ///< it is a race
    wait,         ///< a semaphore between queues
    barrier,      ///< a barrier of the same bytes
    other_barrier ///< execution alone matters, and barriers of other bytes see to it
};
struct Reliance {
    std::uint32_t earlier = none; ///< pass; none: the host
    std::uint32_t later = none;
    std::uint32_t resource = none;
    Means means = Means::nothing;
    std::uint32_t by = none; ///< the first dependency or waiting batch that did it
    friend bool operator==(const Reliance&, const Reliance&) = default;
};

/// Every pair of an access or transition and a later one on common bytes of which one writes, up to the write that
/// comes between. O(accesses x stages x commands).
[[nodiscard]] std::vector<Reliance> reliances(const GraphDesc& graph, const Plan& plan);

/// The two accesses have bytes in common, of one resource or of two that share memory.
[[nodiscard]] bool have_common_bytes(const GraphDesc& graph, const Plan& plan, const AccessDesc& a,
                                     const AccessDesc& b);

} // namespace tyndall::rg::test
