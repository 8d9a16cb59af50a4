// A plan in time.
// In: the plan and the costs. Out: when each pass runs, what each queue waits for, which bytes are in use, and the
// chain of passes that the frame's length hangs on. Invariant: compile decides by the same queue model.
#include "rendergraph/simulate.hpp"

#include <algorithm>
#include <utility>

#include "rendergraph/queue_model.hpp"

namespace tyndall::rg {
namespace {

using namespace stages;

std::uint32_t last_of(const Batch& batch) {
    return batch.first_pass + batch.pass_count - 1;
}

/// Items are places in Plan::passes. A batch's waits hold up its first pass, and with it all of them.
QueueProgram program_of(const Plan& plan, const Costs& costs) {
    QueueProgram program;
    program.queue_count = static_cast<std::uint32_t>(plan.topology.queues.size());
    program.first_wait.push_back(0);
    for (const Batch& batch : plan.batches) {
        for (std::uint32_t i = batch.first_pass; i < batch.first_pass + batch.pass_count; ++i) {
            program.queue.push_back(batch.queue);
            program.duration_ns.push_back(duration_within_limits(costs, plan.passes[i].pass));
            if (i == batch.first_pass) {
                for (const BatchWait& wait : batch.waits) {
                    program.producers.push_back(last_of(plan.batches[wait.batch]));
                }
            }
            program.first_wait.push_back(static_cast<std::uint32_t>(program.producers.size()));
        }
    }
    return program;
}

/// By item, the item before it on its queue, `none` for the first.
std::vector<std::uint32_t> predecessors_on_queue(const QueueProgram& program) {
    std::vector<std::uint32_t> last(program.queue_count, none);
    std::vector<std::uint32_t> before;
    for (std::uint32_t item = 0; item < program.queue.size(); ++item) {
        before.push_back(std::exchange(last[program.queue[item]], item));
    }
    return before;
}

std::vector<TimelineWait> waits_of(const Plan& plan, const QueueProgram& program, const QueueRun& run,
                                   const std::vector<std::uint32_t>& before, std::int64_t cross_ns) {
    std::vector<TimelineWait> waits;
    for (std::uint32_t item = 0; item < program.queue.size(); ++item) {
        const std::int64_t free = before[item] == none ? 0 : run.end_ns[before[item]];
        for (std::uint32_t i = program.first_wait[item]; i < program.first_wait[item + 1]; ++i) {
            const std::uint32_t producer = program.producers[i];
            waits.push_back({.consumer = plan.passes[item].pass,
                             .producer = plan.passes[producer].pass,
                             .from_ns = free,
                             .to_ns = std::max(free, run.end_ns[producer] + cross_ns)});
        }
    }
    return waits;
}

/// From the last end backward: each pass hangs on the one whose end let it start.
std::vector<std::uint32_t> critical_path_of(const Plan& plan, const QueueProgram& program, const QueueRun& run,
                                            const std::vector<std::uint32_t>& before, std::int64_t cross_ns) {
    std::vector<std::uint32_t> path;
    const auto last = std::max_element(run.end_ns.begin(), run.end_ns.end());
    auto at = last == run.end_ns.end() ? none : static_cast<std::uint32_t>(last - run.end_ns.begin());
    while (at != none) {
        path.push_back(plan.passes[at].pass);
        std::uint32_t cause = none;
        if (before[at] != none && run.end_ns[before[at]] == run.start_ns[at]) {
            cause = before[at];
        }
        for (std::uint32_t i = program.first_wait[at]; i < program.first_wait[at + 1] && cause == none; ++i) {
            // Backward only, so that the path ends also where a faulty plan waits in a circle.
            if (program.producers[i] < at && run.end_ns[program.producers[i]] + cross_ns == run.start_ns[at]) {
                cause = program.producers[i];
            }
        }
        at = cause;
    }
    std::reverse(path.begin(), path.end());
    return path;
}

/// A transient is in use from the start of the first pass that touches it to the end of the last one.
std::vector<MemorySample> memory_of(const GraphDesc& graph, const Plan& plan, const QueueRun& run) {
    struct Span {
        std::int64_t from = 0;
        std::int64_t to = -1;
    };
    std::vector<Span> spans(graph.resources.size());
    for (std::uint32_t item = 0; item < plan.passes.size(); ++item) {
        const PassDesc& pass = graph.passes[plan.passes[item].pass];
        for (std::uint32_t i = pass.first_access; i < pass.first_access + pass.access_count; ++i) {
            Span& span = spans[graph.accesses[i].resource];
            span.from = span.to < 0 ? run.start_ns[item] : std::min(span.from, run.start_ns[item]);
            span.to = std::max(span.to, run.end_ns[item]);
        }
    }
    struct Change {
        std::int64_t time;
        VkDeviceSize more;
        VkDeviceSize less;
    };
    std::vector<Change> changes;
    for (std::uint32_t r = 0; r < spans.size(); ++r) {
        const Placement& placement = plan.placements[r];
        if (placement.kind == PlacementKind::heap && spans[r].to >= 0) {
            changes.push_back({spans[r].from, placement.size_bytes, 0});
            changes.push_back({spans[r].to, 0, placement.size_bytes});
        }
    }
    std::stable_sort(changes.begin(), changes.end(), [](const Change& a, const Change& b) { return a.time < b.time; });
    std::vector<MemorySample> samples;
    VkDeviceSize bytes = 0;
    for (std::size_t i = 0; i < changes.size();) {
        const std::int64_t time = changes[i].time;
        const VkDeviceSize earlier = bytes;
        for (; i < changes.size() && changes[i].time == time; ++i) {
            bytes += changes[i].more;
            bytes -= changes[i].less;
        }
        if (bytes != earlier) {
            samples.push_back({time, bytes});
        }
    }
    return samples;
}

} // namespace

Timeline simulate(const GraphDesc& graph, const Plan& plan, const Costs& costs) {
    const ScratchScope scope;
    const std::int64_t cross_ns = cross_queue_within_limits(costs);
    const QueueProgram program = program_of(plan, costs);
    const QueueRun run = run_queues(program, costs);
    const std::vector<std::uint32_t> before = predecessors_on_queue(program);
    Timeline timeline;
    for (std::uint32_t item = 0; item < program.queue.size(); ++item) {
        timeline.passes.push_back({plan.passes[item].pass, program.queue[item], run.start_ns[item], run.end_ns[item]});
    }
    timeline.waits = waits_of(plan, program, run, before, cross_ns);
    timeline.memory = memory_of(graph, plan, run);
    timeline.critical_path = critical_path_of(plan, program, run, before, cross_ns);
    timeline.makespan_ns = run.makespan_ns;
    return timeline;
}

} // namespace tyndall::rg
