// Plans broken on purpose: each kind of fault, at each place where a plan can have it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "rendergraph/plan.hpp"

namespace tyndall::rg::test {

enum class Fault : std::uint8_t {
    drop_barrier,
    narrow_source_stages,
    narrow_destination_stages,
    narrow_source_access,
    narrow_destination_access,
    drop_wait,
    renumber_wait,
    wrong_old_layout,
    wrong_new_layout,
    drop_release,
    drop_acquire,
    overlap_bytes,
    swap_passes,
    retarget_queue,
};
inline constexpr std::size_t fault_count = 14;
[[nodiscard]] std::string_view name_of(Fault fault);

struct Mutant {
    Fault fault;
    std::uint32_t place = 0;                         ///< the n-th of its kind in this plan
    std::uint32_t dependency = none;                 ///< what was broken
    std::uint32_t batch = none;                      ///< likewise
    std::array<std::uint32_t, 2> two = {none, none}; ///< resources that overlap, or passes that were swapped
    Plan plan;
};

/// Every mutant of the kind; narrowed masks lose one bit each.
[[nodiscard]] std::vector<Mutant> mutants(const Plan& plan, Fault fault);

/// Why a mutant that the checker accepts is harmless.
enum class Harmless : std::uint8_t {
    never_recorded,         ///< a semaphore does all of it, and the dependency only explains the wait
    nothing_relied_on_it,   ///< no access needed what was taken away
    a_wait_covers,          ///< a semaphore between queues gives the same order and sight
    another_barrier_covers, ///< another barrier of the same bytes does
    a_chain_orders,         ///< order alone matters, and barriers of other bytes see to it
    unordered_passes,       ///< the swapped passes have no bytes and no transition in common
    dead_content,           ///< the swapped passes overwrite one another, still in order, with what nobody reads
    apart_in_time,          ///< all accesses of one of the overlapping resources come before those of the other
    same_work_elsewhere,    ///< the other queue can do it, and all it touches is still ordered and of that family
};
inline constexpr std::size_t harmless_count = 9;
[[nodiscard]] std::string_view name_of(Harmless reason);

/// Found without the checker: by following each access through the mutant (reach_oracle.hpp). Nothing: not harmless, as
/// far as that can tell.
[[nodiscard]] std::optional<Harmless> why_harmless(const GraphDesc& graph, const Plan& plan, const Mutant& mutant);

} // namespace tyndall::rg::test
