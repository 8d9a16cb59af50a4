// Submissions.
// In: the schedule and its waits. Out: batches numbered so that all waits look backward. Invariant: a semaphore value
// is waited for exactly where the partial order needs it. O(passes + waits).
#include <algorithm>

#include "rendergraph/stages.hpp"

namespace tyndall::rg::stages {

Batches make_batches(const GraphDesc& graph, const Schedule& schedule) {
    const auto count = static_cast<std::uint32_t>(schedule.order.size());
    Scratch<bool> signals(count, false);
    Scratch<bool> waits(count, false);
    for (const QueueWait& wait : schedule.waits) {
        signals[wait.producer] = true;
        waits[wait.slot] = true;
    }
    // Open batches in the order of their first pass: a batch waits only for batches that ended before it began, so the
    // numbering looks backward.
    Batches out;
    out.batches.reserve(2 * schedule.waits.size() + schedule.queue_count); // at most
    out.batch_of.assign(count, 0);
    Scratch<std::uint32_t> open(schedule.queue_count, none);
    for (std::uint32_t slot = 0; slot < count; ++slot) {
        const std::uint32_t queue = schedule.queue[slot];
        if (open[queue] == none || waits[slot]) {
            open[queue] = static_cast<std::uint32_t>(out.batches.size());
            out.batches.push_back({.queue = queue});
        }
        out.batch_of[slot] = open[queue];
        ++out.batches[open[queue]].pass_count;
        if (signals[slot]) {
            out.batches[open[queue]].signals = true;
            open[queue] = none;
        }
    }
    Scratch<std::uint32_t> next; // place in `order` of each batch's next pass
    next.reserve(out.batches.size());
    std::uint32_t first_pass = 0;
    for (Batch& batch : out.batches) {
        batch.first_pass = first_pass;
        next.push_back(first_pass);
        first_pass += batch.pass_count;
    }
    out.order.resize(count);
    for (std::uint32_t slot = 0; slot < count; ++slot) {
        out.order[next[out.batch_of[slot]]++] = slot;
    }
    for (const QueueWait& wait : schedule.waits) {
        // The whole batch waits, with every stage: later passes of the queue rely on the same wait.
        out.batches[out.batch_of[wait.slot]].waits.push_back(
            {.batch = out.batch_of[wait.producer], .stages = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT});
    }
    // Host semaphores: the first use waits, the last one signals; the schedule ordered the others around them.
    for (std::uint32_t resource = 0; resource < graph.resources.size(); ++resource) {
        const std::uint32_t first = schedule.first_use[resource];
        const std::uint32_t end = schedule.first_use[resource + 1];
        const std::uint32_t import = graph.resources[resource].import;
        if (import == none || first == end) {
            continue;
        }
        if (graph.imports[import].waits_semaphore) {
            out.batches[out.batch_of[schedule.uses[first].slot]].waits_imports.push_back(resource);
        }
        if (graph.imports[import].signals_semaphore) {
            out.batches[out.batch_of[schedule.uses[end - 1].slot]].signals_imports.push_back(resource);
        }
    }
    return out;
}

} // namespace tyndall::rg::stages
