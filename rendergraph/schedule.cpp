// The waits between queues.
// In: kept passes in topological order, each with its queue. Out: a partial order (vector clocks) with the fewest
// waits. Invariant: every edge of the data flow is in the partial order. O((passes + edges) x queues).
//
// Where readers on several queues need one thing done once (a layout transition, or a host semaphore waited for) and no
// writer before them can do it, the first reader does, so the others are ordered after it.
#include <algorithm>
#include <numeric>

#include "rendergraph/stages.hpp"

namespace tyndall::rg::stages {
namespace {

/// Merges accesses of one pass to the same cells of one resource into one use, grouped by resource.
void collect_uses(const GraphDesc& graph, const Cells& cells, Schedule& schedule) {
    const auto resources = static_cast<std::uint32_t>(graph.resources.size());
    Scratch<std::uint32_t> first(resources + 1, 0);
    for (const AccessDesc& access : graph.accesses) {
        first[access.resource + 1] += schedule.slot_of[access.pass] != none ? 1 : 0;
    }
    for (std::uint32_t resource = 0; resource < resources; ++resource) {
        first[resource + 1] += first[resource];
    }
    schedule.uses.resize(first[resources]);
    Scratch<std::uint32_t> end(first.begin(), first.end() - 1);
    const auto same_cells = [](const CellRange& a, const CellRange& b) {
        return a.first_mip == b.first_mip && a.mip_count == b.mip_count && a.first_layer == b.first_layer &&
               a.layer_count == b.layer_count;
    };
    for (std::uint32_t slot = 0; slot < schedule.order.size(); ++slot) {
        const PassDesc& pass = graph.passes[schedule.order[slot]];
        for (std::uint32_t i = pass.first_access; i < pass.first_access + pass.access_count; ++i) {
            const AccessDesc& access = graph.accesses[i];
            const ResourceDesc& resource = graph.resources[access.resource];
            const VkFormat format = resource.kind == ResourceKind::image ? resource.image.format : VK_FORMAT_UNDEFINED;
            const AccessScope scope = access_scope(access.access, access.direction, format);
            const auto begin = schedule.uses.begin() + first[access.resource];
            auto use = schedule.uses.begin() + end[access.resource];
            while (use != begin && (use - 1)->slot == slot && !same_cells((use - 1)->cells, cells.of_access[i])) {
                --use;
            }
            if (use != begin && (use - 1)->slot == slot) {
                Use& merged = *(use - 1);
                merged.scope.stages |= scope.stages;
                merged.scope.access |= scope.access;
                merged.reads = merged.reads || is_read(access.direction);
                merged.writes = merged.writes || is_write(access.direction);
            } else {
                Use& fresh = schedule.uses[end[access.resource]++]; // filled where it lies
                fresh.slot = slot;
                fresh.pass = schedule.order[slot];
                fresh.resource = access.resource;
                fresh.queue = schedule.queue[slot];
                fresh.cells = cells.of_access[i];
                fresh.scope = scope;
                fresh.reads = is_read(access.direction);
                fresh.writes = is_write(access.direction);
            }
        }
    }
    // Merging left holes.
    schedule.first_use.reserve(resources + 1);
    schedule.first_use.assign(1, 0);
    auto to = schedule.uses.begin();
    for (std::uint32_t resource = 0; resource < resources; ++resource) {
        const auto from = schedule.uses.begin() + first[resource];
        const auto last = schedule.uses.begin() + end[resource];
        to = from == to ? last : std::copy(from, last, to);
        schedule.first_use.push_back(static_cast<std::uint32_t>(to - schedule.uses.begin()));
    }
    schedule.uses.erase(to, schedule.uses.end());
}

struct SlotEdge {
    std::uint32_t from;
    std::uint32_t to;
};

/// Decides sharing and adds the edges from first readers to the other queues' readers.
class GroupWalk {
public:
    GroupWalk(const GraphDesc& graph, const QueueTopology& topology, const Cells& cells, Schedule& schedule,
              Scratch<SlotEdge>& edges)
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
        order_around_host_semaphores(graph_.resources[resource].import, uses);
        const ResourceCells& of = cells_.of_resource[resource];
        cell_uses_.sort(of, uses);
        for (std::uint32_t cell = 0; cell < of.count(); ++cell) {
            visit_cell(resource, cell_uses_.of(cell), several_families);
        }
    }

    /// The first use waits for the host's semaphore and the last one signals it, for all parts of the import.
    void order_around_host_semaphores(std::uint32_t import, std::span<const Use> uses) {
        for (const Use& use : uses) {
            if (import != none && graph_.imports[import].waits_semaphore) {
                add(uses.front(), use);
            }
            if (import != none && graph_.imports[import].signals_semaphore) {
                add(use, uses.back());
            }
        }
    }

    void visit_cell(std::uint32_t resource, Uses uses, bool several_families) {
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
                if (spans_queues && !(begin == 0 && ready_for_all(resource))) {
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

    /// A buffer that the host leaves finished: its first readers need nothing done, so none of them goes first.
    [[nodiscard]] bool ready_for_all(std::uint32_t resource) const {
        const ResourceDesc& desc = graph_.resources[resource];
        if (desc.kind != ResourceKind::buffer || desc.import == none) {
            return false;
        }
        const ImportDesc& import = graph_.imports[desc.import];
        return !import.waits_semaphore && import.initial_stages == 0 &&
               import.initial_family == VK_QUEUE_FAMILY_IGNORED;
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
    Scratch<SlotEdge>& edges_;
    CellUses cell_uses_; ///< of the resource at hand
};

/// Edges grouped by the slot that they lead to; `first` has slots + 1 entries. O(edges + slots).
Scratch<std::uint32_t> group_by_target(const Scratch<SlotEdge>& edges, std::size_t slots,
                                       Scratch<std::uint32_t>& first) {
    first.assign(slots + 1, 0);
    for (const SlotEdge& edge : edges) {
        ++first[edge.to + 1];
    }
    for (std::size_t slot = 0; slot < slots; ++slot) {
        first[slot + 1] += first[slot];
    }
    Scratch<std::uint32_t> from(edges.size());
    Scratch<std::uint32_t> fill(first.begin(), first.end() - 1);
    for (const SlotEdge& edge : edges) {
        from[fill[edge.to]++] = edge.from;
    }
    return from;
}

/// Vector clocks in schedule order; a wait is dropped when another wait, or an earlier one of the queue, implies it.
void derive_waits(const Scratch<SlotEdge>& edges, Schedule& schedule) {
    Scratch<std::uint32_t> first_edge;
    const Scratch<std::uint32_t> from_slot = group_by_target(edges, schedule.order.size(), first_edge);
    const std::uint32_t queues = schedule.queue_count;
    const auto count = static_cast<std::uint32_t>(schedule.order.size());
    schedule.clocks.assign(std::size_t{count} * queues, 0);
    schedule.returns.resize(count);
    Scratch<std::uint32_t> last_on_queue(queues, none);
    Scratch<std::uint32_t> latest(queues);
    for (std::uint32_t slot = 0; slot < count; ++slot) {
        const std::uint32_t own = schedule.queue[slot];
        std::uint32_t* clock = schedule.clocks.data() + std::size_t{slot} * queues;
        if (last_on_queue[own] != none) {
            std::copy_n(schedule.clocks.data() + std::size_t{last_on_queue[own]} * queues, queues, clock);
            schedule.returns[slot] = schedule.returns[last_on_queue[own]];
        }
        // The latest producer of each other queue that is not already in the past.
        latest.assign(queues, none);
        for (std::uint32_t edge = first_edge[slot]; edge < first_edge[slot + 1]; ++edge) {
            const std::uint32_t from = from_slot[edge];
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
                if (other[own] > schedule.returns[slot].passes) {
                    schedule.returns[slot] = {other[own], q};
                }
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

void CellUses::sort(const ResourceCells& cells, std::span<const Use> uses) {
    if (cells.whole) {
        first_.assign(2, 0);
        first_[1] = static_cast<std::uint32_t>(uses.size());
        uses_.resize(uses.size());
        std::transform(uses.begin(), uses.end(), uses_.begin(), [](const Use& use) { return &use; });
        return;
    }
    first_.assign(cells.count() + 1, 0);
    for (const Use& use : uses) {
        for_each_cell(cells, use.cells, [&](std::uint32_t cell) { ++first_[cell + 1]; });
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    uses_.resize(first_.back());
    next_.assign(first_.begin(), first_.end() - 1);
    for (const Use& use : uses) {
        for_each_cell(cells, use.cells, [&](std::uint32_t cell) { uses_[next_[cell]++] = &use; });
    }
}

Schedule schedule(const GraphDesc& graph, const QueueTopology& topology, const Cells& cells, const Flow& flow,
                  const Assignment& assignment) {
    Schedule schedule;
    schedule.queue_count = static_cast<std::uint32_t>(topology.queues.size());
    schedule.order = assignment.order;
    schedule.queue = assignment.queue;
    schedule.queue_reason = assignment.reason;
    schedule.slot_of.assign(graph.passes.size(), none);
    schedule.position.reserve(schedule.order.size());
    Scratch<std::uint32_t> next_position(topology.queues.size(), 0);
    for (std::uint32_t slot = 0; slot < schedule.order.size(); ++slot) {
        schedule.slot_of[schedule.order[slot]] = slot;
        schedule.position.push_back(next_position[schedule.queue[slot]]++);
    }
    collect_uses(graph, cells, schedule);

    Scratch<SlotEdge> edges;
    edges.reserve(flow.edges.size());
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
