// Queues, and the waits between them.
// In: kept passes in topological order. Out: a queue for each, a partial order (vector clocks) with the fewest waits.
// Invariant: every edge of the data flow is in the partial order. O((passes + edges) x queues).
//
// Where readers on several queues need one thing done once (a layout transition, or a host semaphore waited for) and no
// writer before them can do it, the first reader does, so the others are ordered after it.
#include <algorithm>

#include "rendergraph/stages.hpp"

namespace tyndall::rg::stages {
namespace {

struct QueueChoice {
    std::uint32_t queue = 0;
    QueueReason reason = QueueReason::default_graphics;
};

bool same_queues(const std::vector<QueueChoice>& a, const std::vector<QueueChoice>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const QueueChoice& x, const QueueChoice& y) { return x.queue == y.queue; });
}

QueueChoice choose_queue(const PassDesc& pass, const QueueTopology& topology, bool async) {
    if (pass.kind == PassKind::graphics) {
        return {0, QueueReason::only_queue_that_can};
    }
    const bool asks = pass.wish == QueueWish::async_compute || pass.wish == QueueWish::transfer;
    if (!asks) {
        return {0, pass.wish == QueueWish::graphics ? QueueReason::asked_for : QueueReason::default_graphics};
    }
    if (!async) {
        return {0, QueueReason::async_switched_off};
    }
    const QueueKind wanted = pass.wish == QueueWish::transfer ? QueueKind::transfer : QueueKind::compute;
    for (std::uint32_t q = 0; q < topology.queues.size(); ++q) {
        if (topology.queues[q].kind == wanted) {
            return {q, QueueReason::asked_for};
        }
    }
    return {0, QueueReason::asked_for_but_no_such_queue};
}

/// An import is EXCLUSIVE unless the host says that it shares it. Its passes then stay in one family: those that asked
/// for another queue go back to graphics if the import is used elsewhere too.
void keep_unshared_imports_together(const GraphDesc& graph, const QueueTopology& topology, const Kept& kept,
                                    std::vector<QueueChoice>& choices) {
    const auto family = [&](std::uint32_t pass) { return topology.queues[choices[pass].queue].family; };
    std::vector<std::uint32_t> family_of(graph.resources.size(), none);
    std::vector<bool> torn(graph.resources.size(), false);
    for (const AccessDesc& access : graph.accesses) {
        const ResourceDesc& resource = graph.resources[access.resource];
        if (kept.pass[access.pass] && resource.import != none && !resource.concurrent) {
            std::uint32_t& known = family_of[access.resource];
            torn[access.resource] = torn[access.resource] || (known != none && known != family(access.pass));
            known = family(access.pass);
        }
    }
    for (const AccessDesc& access : graph.accesses) {
        if (torn[access.resource] && choices[access.pass].queue != 0) {
            choices[access.pass] = {0, QueueReason::import_not_shared};
        }
    }
}

/// Merges accesses of one pass to the same cells of one resource into one use.
void collect_uses(const GraphDesc& graph, const Cells& cells, Schedule& schedule) {
    std::vector<std::vector<Use>> by_resource(graph.resources.size());
    for (std::uint32_t slot = 0; slot < schedule.order.size(); ++slot) {
        const PassDesc& pass = graph.passes[schedule.order[slot]];
        for (std::uint32_t i = pass.first_access; i < pass.first_access + pass.access_count; ++i) {
            const AccessDesc& access = graph.accesses[i];
            const ResourceDesc& resource = graph.resources[access.resource];
            const VkFormat format = resource.kind == ResourceKind::image ? resource.image.format : VK_FORMAT_UNDEFINED;
            Use use{slot,
                    schedule.order[slot],
                    access.resource,
                    schedule.queue[slot],
                    cells.of_access[i],
                    access_scope(access.access, access.direction, format),
                    is_read(access.direction),
                    is_write(access.direction)};
            std::vector<Use>& uses = by_resource[access.resource];
            const auto same = [&](const Use& other) {
                return other.slot == slot && other.cells.first_mip == use.cells.first_mip &&
                       other.cells.mip_count == use.cells.mip_count &&
                       other.cells.first_layer == use.cells.first_layer &&
                       other.cells.layer_count == use.cells.layer_count;
            };
            const auto found = std::find_if(uses.begin(), uses.end(), same);
            if (found == uses.end()) {
                uses.push_back(use);
            } else {
                found->scope.stages |= use.scope.stages;
                found->scope.access |= use.scope.access;
                found->reads = found->reads || use.reads;
                found->writes = found->writes || use.writes;
            }
        }
    }
    schedule.first_use.assign(1, 0);
    for (const std::vector<Use>& uses : by_resource) {
        schedule.uses.insert(schedule.uses.end(), uses.begin(), uses.end());
        schedule.first_use.push_back(static_cast<std::uint32_t>(schedule.uses.size()));
    }
}

struct SlotEdge {
    std::uint32_t from;
    std::uint32_t to;
};

/// Decides sharing and adds the edges from first readers to the other queues' readers.
class GroupWalk {
public:
    GroupWalk(const GraphDesc& graph, const QueueTopology& topology, const Cells& cells, Schedule& schedule,
              std::vector<SlotEdge>& edges)
        : graph_(graph), topology_(topology), cells_(cells), schedule_(schedule), edges_(edges) {}

    void run() {
        schedule_.concurrent.assign(graph_.resources.size(), false);
        for (std::uint32_t resource = 0; resource < graph_.resources.size(); ++resource) {
            visit(resource);
        }
    }

private:
    void visit(std::uint32_t resource) {
        const std::span<const Use> uses(schedule_.uses.data() + schedule_.first_use[resource],
                                        schedule_.first_use[resource + 1] - schedule_.first_use[resource]);
        bool several_queues = false;
        bool several_families = false;
        for (const Use& use : uses) {
            several_queues = several_queues || use.queue != uses[0].queue;
            several_families = several_families || family(use) != family(uses[0]);
        }
        schedule_.concurrent[resource] = graph_.resources[resource].concurrent && several_families;
        if (!several_queues) {
            return;
        }
        const ResourceCells& of = cells_.of_resource[resource];
        std::vector<std::vector<const Use*>> cell_uses(of.count());
        for (const Use& use : uses) {
            for_each_cell(of, use.cells, [&](std::uint32_t cell) { cell_uses[cell].push_back(&use); });
        }
        for (const std::vector<const Use*>& of_cell : cell_uses) {
            visit_cell(resource, of_cell, several_families);
        }
    }

    void visit_cell(std::uint32_t resource, const std::vector<const Use*>& uses, bool several_families) {
        std::size_t begin = 0;
        std::size_t previous_begin = 0;
        bool previous_is_write = false;
        while (begin < uses.size()) {
            std::size_t end = begin + 1;
            while (!uses[begin]->writes && end < uses.size() && !uses[end]->writes &&
                   uses[end]->scope.layout == uses[begin]->scope.layout) {
                ++end;
            }
            bool spans_queues = false;
            for (std::size_t i = begin; i < end; ++i) {
                spans_queues = spans_queues || uses[i]->queue != uses[begin]->queue;
            }
            if (several_families && spans_queues) {
                schedule_.concurrent[resource] =
                    true; // ownership is with one family, and released by one queue, at a time
            }
            if (!previous_is_write) {
                if (spans_queues) {
                    for (std::size_t i = begin + 1; i < end; ++i) {
                        add(*uses[begin], *uses[i]);
                    }
                }
                if (begin > 0 &&
                    !uses[begin]->writes) { // another layout: the transition waits for all who read the old
                    for (std::size_t i = previous_begin; i < begin; ++i) {
                        add(*uses[i], *uses[begin]);
                    }
                }
            }
            previous_is_write = uses[begin]->writes;
            previous_begin = begin;
            begin = end;
        }
        // The host's final state, or the layout between frames, is set after the last use: the others come before it.
        const ResourceDesc& desc = graph_.resources[resource];
        const bool leaves = desc.has_history || (desc.import != none && graph_.imports[desc.import].has_final);
        if (leaves) {
            for (std::size_t i = previous_begin; i + 1 < uses.size(); ++i) {
                add(*uses[i], *uses.back());
            }
        }
    }

    void add(const Use& from, const Use& to) {
        if (from.queue != to.queue && from.slot != to.slot) {
            edges_.push_back({from.slot, to.slot});
        }
    }
    [[nodiscard]] std::uint32_t family(const Use& use) const { return topology_.queues[use.queue].family; }

    const GraphDesc& graph_;
    const QueueTopology& topology_;
    const Cells& cells_;
    Schedule& schedule_;
    std::vector<SlotEdge>& edges_;
};

/// Vector clocks in schedule order; a wait is dropped when another wait, or an earlier one of the queue, implies it.
void derive_waits(std::vector<SlotEdge>& edges, Schedule& schedule) {
    std::sort(edges.begin(), edges.end(),
              [](const SlotEdge& a, const SlotEdge& b) { return a.to != b.to ? a.to < b.to : a.from < b.from; });
    const std::uint32_t queues = schedule.queue_count;
    const auto count = static_cast<std::uint32_t>(schedule.order.size());
    schedule.clocks.assign(std::size_t{count} * queues, 0);
    std::vector<std::uint32_t> last_on_queue(queues, none);
    std::vector<std::uint32_t> latest(queues);
    std::size_t edge = 0;
    for (std::uint32_t slot = 0; slot < count; ++slot) {
        const std::uint32_t own = schedule.queue[slot];
        std::uint32_t* clock = schedule.clocks.data() + std::size_t{slot} * queues;
        if (last_on_queue[own] != none) {
            std::copy_n(schedule.clocks.data() + std::size_t{last_on_queue[own]} * queues, queues, clock);
        }
        // The latest producer of each other queue that is not already in the past.
        latest.assign(queues, none);
        for (; edge < edges.size() && edges[edge].to == slot; ++edge) {
            const std::uint32_t from = edges[edge].from;
            const std::uint32_t q = schedule.queue[from];
            if (q != own && clock[q] <= schedule.position[from] &&
                (latest[q] == none || schedule.position[latest[q]] < schedule.position[from])) {
                latest[q] = from;
            }
        }
        for (std::uint32_t q = 0; q < queues; ++q) {
            bool needed = latest[q] != none;
            for (std::uint32_t other = 0; other < queues && needed; ++other) {
                needed = other == q || latest[other] == none || !schedule.happens_before(latest[q], latest[other]);
            }
            if (needed) {
                schedule.waits.push_back({slot, latest[q]});
            }
        }
        for (std::uint32_t q = 0; q < queues; ++q) {
            if (latest[q] != none) {
                const std::uint32_t* other = schedule.clocks.data() + std::size_t{latest[q]} * queues;
                for (std::uint32_t k = 0; k < queues; ++k) {
                    clock[k] = std::max(clock[k], other[k]);
                }
            }
        }
        clock[own] = schedule.position[slot] + 1;
        last_on_queue[own] = slot;
    }
}

} // namespace

Schedule schedule(const GraphDesc& graph, const QueueTopology& topology, const Cells& cells, const Flow& flow,
                  const Order& order, const Kept& kept, bool async) {
    Schedule schedule;
    schedule.queue_count = static_cast<std::uint32_t>(topology.queues.size());
    schedule.slot_of.assign(graph.passes.size(), none);
    std::vector<QueueChoice> choices;
    for (const PassDesc& pass : graph.passes) {
        choices.push_back(choose_queue(pass, topology, async));
    }
    // Moving a pass may tear another import that it shares with a pass still elsewhere: again, until nothing moves.
    // Each round moves at least one pass to graphics, so it ends.
    for (std::vector<QueueChoice> before; before.size() != choices.size() || !same_queues(before, choices);) {
        before = choices;
        keep_unshared_imports_together(graph, topology, kept, choices);
    }
    std::vector<std::uint32_t> next_position(topology.queues.size(), 0);
    for (const std::uint32_t pass : order.passes) {
        if (!kept.pass[pass]) {
            continue;
        }
        const QueueChoice choice = choices[pass];
        schedule.slot_of[pass] = static_cast<std::uint32_t>(schedule.order.size());
        schedule.order.push_back(pass);
        schedule.queue.push_back(choice.queue);
        schedule.queue_reason.push_back(choice.reason);
        schedule.position.push_back(next_position[choice.queue]++);
    }
    collect_uses(graph, cells, schedule);

    std::vector<SlotEdge> edges;
    for (const Edge& edge : flow.edges) {
        const std::uint32_t from = schedule.slot_of[edge.from];
        const std::uint32_t to = schedule.slot_of[edge.to];
        if (from != none && to != none && schedule.queue[from] != schedule.queue[to]) {
            edges.push_back({from, to});
        }
    }
    GroupWalk(graph, topology, cells, schedule, edges).run();
    derive_waits(edges, schedule);
    return schedule;
}

} // namespace tyndall::rg::stages
