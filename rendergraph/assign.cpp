// The kept passes as items for the queue model, and schedules of them.
// In: flow, order, choices, costs. Out: items with durations and edges; schedules in one form. O(passes + edges).
#include "rendergraph/assign.hpp"

#include <algorithm>
#include <cstring>

namespace tyndall::rg::stages {

Work collect_work(const Flow& flow, const Order& order, const Kept& kept, const QueueChoices& choices,
                  const QueueTopology& topology, const Costs& costs) {
    Work work;
    work.queue_count = static_cast<std::uint32_t>(topology.queues.size());
    work.item_of.assign(kept.pass.size(), none);
    work.pass.reserve(order.passes.size());
    work.allowed.reserve(order.passes.size());
    work.home.reserve(order.passes.size());
    work.duration_ns.reserve(order.passes.size());
    for (const std::uint32_t pass : order.passes) {
        if (kept.pass[pass]) {
            work.item_of[pass] = static_cast<std::uint32_t>(work.pass.size());
            work.pass.push_back(pass);
            work.allowed.push_back(choices.allowed[pass]);
            work.home.push_back(choices.home[pass]);
            work.duration_ns.push_back(duration_within_limits(costs, pass));
        }
    }
    work.first_in.assign(work.pass.size() + 1, 0);
    for (const Edge& edge : flow.edges) {
        if (work.item_of[edge.from] != none && work.item_of[edge.to] != none) {
            ++work.first_in[work.item_of[edge.to] + 1];
        }
    }
    for (std::size_t i = 0; i < work.pass.size(); ++i) {
        work.first_in[i + 1] += work.first_in[i];
    }
    work.in.resize(work.first_in.back());
    Scratch<std::uint32_t> fill(work.first_in.begin(), work.first_in.end() - 1);
    for (const Edge& edge : flow.edges) {
        const std::uint32_t from = work.item_of[edge.from];
        const std::uint32_t to = work.item_of[edge.to];
        if (from != none && to != none) {
            work.in[fill[to]++] = from;
        }
    }
    return work;
}

ItemSchedule at_home(const Work& work) {
    ItemSchedule schedule;
    schedule.items.resize(work.pass.size());
    for (std::uint32_t item = 0; item < schedule.items.size(); ++item) {
        schedule.items[item] = item;
    }
    schedule.queue = work.home;
    return schedule;
}

ItemSchedule merged(const Work& work, const ItemSchedule& schedule) {
    const auto count = static_cast<std::uint32_t>(schedule.items.size());
    struct Head {
        std::uint32_t next = 0; ///< into `by_queue`
        std::uint32_t end = 0;
        std::uint32_t edge = 0; ///< into Work::in: those before it come from items that are placed
    };
    Scratch<Head> heads(work.queue_count);
    for (const std::uint32_t queue : schedule.queue) {
        ++heads[queue].end;
    }
    for (std::uint32_t q = 1; q < heads.size(); ++q) {
        heads[q].next = heads[q - 1].end;
        heads[q].end += heads[q].next;
    }
    Scratch<std::uint32_t> by_queue(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        by_queue[heads[schedule.queue[i]].next++] = schedule.items[i];
    }
    for (std::uint32_t q = 0; q < heads.size(); ++q) {
        heads[q].next = q == 0 ? 0 : heads[q - 1].end;
        heads[q].edge = heads[q].next < heads[q].end ? work.first_in[by_queue[heads[q].next]] : 0;
    }
    Scratch<std::uint8_t> placed(count, 0);
    ItemSchedule out;
    out.items.reserve(count);
    out.queue.reserve(count);
    while (out.items.size() < count) {
        std::uint32_t best = none;
        for (std::uint32_t q = 0; q < heads.size(); ++q) {
            Head& head = heads[q];
            if (head.next == head.end) {
                continue;
            }
            const std::uint32_t item = by_queue[head.next];
            while (head.edge < work.first_in[item + 1] && placed[work.in[head.edge]] != 0) {
                ++head.edge;
            }
            if (head.edge == work.first_in[item + 1] && (best == none || item < by_queue[heads[best].next])) {
                best = q;
            }
        }
        Head& head = heads[best];
        placed[by_queue[head.next]] = 1;
        out.items.push_back(by_queue[head.next]);
        out.queue.push_back(best);
        ++head.next;
        head.edge = head.next < head.end ? work.first_in[by_queue[head.next]] : 0;
    }
    return out;
}

std::int64_t makespan_ns(const Work& work, const ItemSchedule& schedule, const Costs& costs) {
    const auto count = static_cast<std::uint32_t>(schedule.items.size());
    QueueProgram program;
    program.queue_count = work.queue_count;
    program.queue = schedule.queue;
    program.duration_ns.resize(count);
    program.first_wait.reserve(count + 1);
    program.first_wait.push_back(0);
    program.producers.reserve(work.in.size());
    Scratch<std::uint32_t> position(count, none);
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t item = schedule.items[i];
        position[item] = i;
        program.duration_ns[i] = work.duration_ns[item];
        for (std::uint32_t edge = work.first_in[item]; edge < work.first_in[item + 1]; ++edge) {
            const std::uint32_t producer = position[work.in[edge]];
            if (schedule.queue[producer] != schedule.queue[i]) {
                program.producers.push_back(producer);
            }
        }
        program.first_wait.push_back(static_cast<std::uint32_t>(program.producers.size()));
    }
    return run_queues(program, costs).makespan_ns;
}

QueueProgram program_of(const Schedule& schedule, const Costs& costs) {
    QueueProgram program;
    program.queue_count = schedule.queue_count;
    program.queue = schedule.queue;
    program.duration_ns.reserve(schedule.order.size());
    program.first_wait.reserve(schedule.order.size() + 1);
    program.first_wait.push_back(0);
    program.producers.reserve(schedule.waits.size());
    std::size_t wait = 0;
    for (std::uint32_t slot = 0; slot < schedule.order.size(); ++slot) {
        program.duration_ns.push_back(duration_within_limits(costs, schedule.order[slot]));
        for (; wait < schedule.waits.size() && schedule.waits[wait].slot == slot; ++wait) {
            program.producers.push_back(schedule.waits[wait].producer);
        }
        program.first_wait.push_back(static_cast<std::uint32_t>(program.producers.size()));
    }
    return program;
}

ItemSchedule previous_schedule(const Work& work, const QueueTopology& topology, std::uint64_t passes_hash,
                               const Plan& previous) {
    const auto same_queue = [](const QueueInfo& a, const QueueInfo& b) {
        return a.kind == b.kind && a.family == b.family && a.capabilities == b.capabilities;
    };
    const bool same_queues = std::equal(topology.queues.begin(), topology.queues.end(),
                                        previous.topology.queues.begin(), previous.topology.queues.end(), same_queue);
    if (!same_queues || passes_hash != previous.passes_hash || previous.passes.size() != work.pass.size()) {
        return {};
    }
    ItemSchedule schedule;
    Scratch<std::uint8_t> placed(work.pass.size(), 0);
    for (const PlannedPass& planned : previous.passes) {
        const std::uint32_t item = planned.pass < work.item_of.size() ? work.item_of[planned.pass] : none;
        if (item == none || placed[item] != 0 || planned.queue >= most_queues ||
            (work.allowed[item] >> planned.queue & 1U) == 0) {
            return {};
        }
        for (std::uint32_t edge = work.first_in[item]; edge < work.first_in[item + 1]; ++edge) {
            if (placed[work.in[edge]] == 0) {
                return {};
            }
        }
        placed[item] = 1;
        schedule.items.push_back(item);
        schedule.queue.push_back(planned.queue);
    }
    return merged(work, schedule);
}

std::uint64_t hash_of_passes(const GraphDesc& graph) {
    // FNV-1a over words of eight bytes, each name's length first.
    constexpr std::uint64_t prime = 0x100000001b3;
    std::uint64_t hash = 0xcbf29ce484222325;
    const auto add = [&](std::uint64_t word) {
        hash = (hash ^ word) * prime;
        hash ^= hash >> 32U;
    };
    for (const PassDesc& pass : graph.passes) {
        add(pass.name.size());
        for (std::size_t at = 0; at < pass.name.size(); at += sizeof(std::uint64_t)) {
            std::uint64_t word = 0;
            std::memcpy(&word, pass.name.data() + at, std::min(sizeof(word), pass.name.size() - at));
            add(word);
        }
    }
    return hash;
}

Assignment assignment_of(const Work& work, const ItemSchedule& schedule, const QueueChoices& choices) {
    const auto away = [&](std::uint32_t i) { return schedule.queue[i] != work.home[schedule.items[i]]; };
    bool overlaps = false;
    for (std::uint32_t i = 0; i < schedule.items.size(); ++i) {
        overlaps = overlaps || away(i);
    }
    Assignment assignment;
    assignment.order.reserve(schedule.items.size());
    assignment.queue = schedule.queue;
    assignment.reason.reserve(schedule.items.size());
    for (std::uint32_t i = 0; i < schedule.items.size(); ++i) {
        const std::uint32_t pass = work.pass[schedule.items[i]];
        const QueueMask allowed = choices.allowed[pass];
        const bool free = (allowed & (allowed - 1)) != 0;
        assignment.order.push_back(pass);
        assignment.reason.push_back(away(i)            ? QueueReason::overlap_pays
                                    : free && overlaps ? QueueReason::earliest_here
                                                       : choices.reason[pass]);
    }
    return assignment;
}

} // namespace tyndall::rg::stages
