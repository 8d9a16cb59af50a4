// The checker: an independent reading of graph + plan that proves the plan free of races, or says where it is not.
// It shares nothing with compile but GraphDesc, Plan and the access table.
#pragma once

#include <cstdint>
#include <span>
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
    wrong_version,     ///< content of another version is read than the access names
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

/// One frame of a sequence.
struct PlannedFrame {
    const GraphDesc* graph = nullptr;
    const Plan* plan = nullptr;
};
/// What orders a frame after the one before it.
enum class BetweenFrames : std::uint8_t {
    executor, ///< as the executor does: each queue's first work of a frame comes after all of the frame before
    nothing,  ///< frames overlap as their own barriers let them
};

/// Replays the plans in submission order, as a race detector would: every access is followed through barriers and
/// semaphores to the stages and queues that are ordered after it and see its memory. Bytes of heaps (the n-th heap of
/// each plan is the same memory), imports (of the same name) and histories (of the same name; their copies swap roles)
/// carry over from frame to frame. Topologies must have equally many queues. Stops after the first frame with a
/// violation. Empty: proved. O(frames x (accesses + barriers)), if each part of a resource has few readers at a time.
[[nodiscard]] std::vector<Violation> verify_sequence(std::span<const PlannedFrame> frames,
                                                     BetweenFrames between = BetweenFrames::executor);

/// The plan, frame after frame, over the frames in flight and one more, so that both copies of a history have had each
/// role.
[[nodiscard]] std::vector<Violation> verify(const GraphDesc& graph, const Plan& plan);

} // namespace tyndall::rg
