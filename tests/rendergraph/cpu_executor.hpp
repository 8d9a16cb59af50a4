// Runs a plan on the CPU: one thread issues a queue's commands, and each access of a pass, each transition and each
// semaphore signal is a thread of its own, which comes after another only where the plan says so. Bytes are touched by
// plain loads and stores. Execution dependencies alone are waited for without memory order; a write is acquired only
// through barriers (or semaphores) that make it available and visible. So the thread sanitiser sees a missing barrier,
// stage or access mask as the data race that it is.
//
// It stays with the tests: an embedder executes on a device.
#pragma once

#include <cstdint>
#include <string>

#include "rendergraph/plan.hpp"

namespace tyndall::rg::test {

/// What a write is a function of, beside its own access and the content that it modifies.
enum class Values : std::uint8_t {
    own,       ///< nothing: accesses of one pass do not wait for each other
    from_reads ///< all that its pass reads
};

struct CpuRun {
    bool started = false;         ///< false: a batch waits for one that never signals before it
    std::uint32_t reads = 0;      ///< cells read
    std::uint32_t mismatches = 0; ///< of them, and of what is left for the host and the next frame, those that differ
    std::string first_mismatch = {}; ///< from a serial reading of the graph by its versions, which knows no plan
};

/// O(accesses x cells), a cell being 64 bytes. Blocks until the frame is done.
[[nodiscard]] CpuRun run_on_cpu(const GraphDesc& graph, const Plan& plan, Values values);

} // namespace tyndall::rg::test
