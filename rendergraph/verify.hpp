// The checker: an independent reading of graph + plan that proves the plan free of races, or says where it is not.
// It shares nothing with compile but GraphDesc, Plan and the access table.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rendergraph/plan.hpp"

namespace tyndall::rg {

enum class ViolationCode : std::uint8_t {
    malformed,         ///< indices outside their tables, passes missing, twice or in an impossible order
    race,              ///< two conflicting accesses without a happens-before path that covers their stages
    not_visible,       ///< ordered, but the write is not available and visible to the later access
    wrong_layout,      ///< an access, or a transition's old layout, differs from the layout at hand
    undefined_content, ///< content is read that nothing wrote, or that was discarded
    ownership,         ///< accessed by a family that does not own it, or half of a transfer is missing
    queue_cannot,      ///< a pass or a stage mask on a queue that cannot have it
    never_signalled,   ///< a wait for a batch that does not signal, or that comes later: a deadlock
    memory_overlap,    ///< a placement outside its heap or off its alignment
    exit_state,        ///< an import or a history is not left as was agreed
};

[[nodiscard]] std::string_view name_of(ViolationCode code);

struct Violation {
    ViolationCode code;
    std::uint32_t pass = none;       ///< at fault, or the later of two
    std::uint32_t other_pass = none; ///< the earlier of two
    std::uint32_t resource = none;
    std::string message = {};
};

/// Replays the plan in submission order, as a race detector would: every access is followed through barriers and
/// semaphores to the stages and queues that are ordered after it and see its memory. Whole frames are ordered by the
/// executor, so one frame is enough. Empty: the plan is proved. O(live accesses x barriers).
[[nodiscard]] std::vector<Violation> verify(const GraphDesc& graph, const Plan& plan);

} // namespace tyndall::rg
