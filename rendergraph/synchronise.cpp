// Barriers, transitions and ownership transfers.
// In: each resource's uses in schedule order, and the waits already decided. Out: dependencies by consumer. Invariant:
// every hazard between two uses of a cell has a path of dependencies and waits with availability and visibility.
// O(uses x cells of each).
//
// Uses of a cell fall into groups: one write, or reads in one layout. Between two groups there is one dependency a
// queue, before the first use there, with the masks of all the group's uses on that queue: reads are merged.
#include <algorithm>

#include "rendergraph/synchronise_types.hpp"

namespace tyndall::rg::stages {
namespace {
class Synchroniser {
public:
    Synchroniser(const GraphDesc& graph, const QueueTopology& topology, const Cells& cells, const Schedule& schedule,
                 const Memory& memory, const Batches& batches, bool full_barriers)
        : graph_(graph), topology_(topology), cells_(cells), schedule_(schedule), memory_(memory), batches_(batches),
          full_barriers_(full_barriers), exit_slot_(static_cast<std::uint32_t>(schedule.order.size())) {}

    Synchronised run() {
        out_.resting_layout.assign(graph_.resources.size(), VK_IMAGE_LAYOUT_UNDEFINED);
        out_.releases.resize(batches_.batches.size());
        decide_resting_layouts();
        all_.reserve(schedule_.uses.size());
        for (std::uint32_t resource = 0; resource < graph_.resources.size(); ++resource) {
            visit(resource);
        }
        collect(all_, schedule_, out_);
        return std::move(out_);
    }

private:
    /// A dependency of some cells of a resource.
    struct OfCells {
        FoundDependency made;
        Scratch<std::uint32_t> cells;
    };

    std::span<const Use> uses_of(std::uint32_t resource) const {
        return {schedule_.uses.data() + schedule_.first_use[resource],
                schedule_.first_use[resource + 1] - schedule_.first_use[resource]};
    }

    /// Between frames both copies of a history rest in the layout of its first reader, so that steady frames need no
    /// transition before they read it.
    void decide_resting_layouts() {
        for (std::uint32_t resource = 0; resource < graph_.resources.size(); ++resource) {
            const std::uint32_t current = graph_.resources[resource].history_of;
            if (current == none || graph_.resources[resource].kind != ResourceKind::image) {
                continue;
            }
            const std::span<const Use> readers = uses_of(resource);
            const std::span<const Use> writers = uses_of(current);
            const VkImageLayout layout = !readers.empty()   ? readers.front().scope.layout
                                         : !writers.empty() ? writers.back().scope.layout
                                                            : VK_IMAGE_LAYOUT_GENERAL;
            out_.resting_layout[resource] = layout;
            out_.resting_layout[current] = layout;
        }
    }

    /// Good until the next resource: alias uses lie in a buffer of their own.
    Before state_on_the_way_in(std::uint32_t resource) {
        const ResourceDesc& desc = graph_.resources[resource];
        Before before;
        if (desc.lifetime == ResourceLifetime::imported) {
            const ImportDesc& import = graph_.imports[desc.import];
            before.entry = Hazard::import_entry;
            before.layout = import.initial_layout;
            before.host_stages = import.initial_stages;
            before.host_access = import.initial_access;
            before.host_family = import.initial_family;
            before.content = desc.kind == ResourceKind::buffer || import.initial_layout != VK_IMAGE_LAYOUT_UNDEFINED;
        } else if (desc.lifetime == ResourceLifetime::history) {
            before.layout = out_.resting_layout[resource];
        } else {
            before.content = false;
            entry_uses_.clear();
            for (const std::uint32_t other : memory_.taken_over_by(resource)) {
                before.entry = Hazard::aliased_memory;
                before.alias_of = before.alias_of == none ? other : before.alias_of;
                // All of them, though the last ones come after the others: validation follows images and buffers in the
                // same bytes apart, and sees no way through the former from one of the latter to the next.
                for (const Use& use : uses_of(other)) {
                    entry_uses_.push_back(&use);
                }
            }
            before.uses = entry_uses_;
        }
        return before;
    }

    void visit(std::uint32_t resource) {
        const std::span<const Use> uses = uses_of(resource);
        if (uses.empty()) {
            return;
        }
        of_cells_.clear();
        const Before entry = state_on_the_way_in(resource);
        const ResourceCells& of = cells_.of_resource[resource];
        cell_uses_.sort(of, uses);
        for (std::uint32_t cell = 0; cell < of.count(); ++cell) {
            visit_cell(resource, cell, cell_uses_.of(cell), entry);
        }
        for (OfCells& found : of_cells_) {
            add_ranges(resource, found);
        }
    }

    void visit_cell(std::uint32_t resource, std::uint32_t cell, Uses uses, const Before& entry) {
        Before before = entry;
        const bool untouched = uses.empty();
        before.written = (entry.host_access & any_write) != 0;
        while (!uses.empty()) {
            const Group group = first_group(uses);
            Before after = state_after(group);
            const bool keeps = keeps_state(resource, before, group);
            after.written = before.written || !keeps;
            if (keeps && reads_like_the_host(before, group)) {
                after.host_stages = before.host_stages; // whoever writes next comes after both
            } else {
                connect(resource, cell, before, group);
            }
            before = after;
            uses = uses.subspan(group.uses.size());
        }
        if (!untouched) {
            leave(resource, cell, before);
        } else if (changes_untouched_parts(graph_, resource, is_shared(resource))) {
            const Use* last = &uses_of(resource).back(); // it takes the part along
            const Group along{{&last, 1}, false, false, graph_.imports[graph_.resources[resource].import].final_layout};
            connect(resource, cell, before, along);
            Before after = state_after(along);
            after.written = before.written || !keeps_state(resource, before, along);
            leave(resource, cell, after);
        }
    }

    /// No family owns it.
    [[nodiscard]] bool is_shared(std::uint32_t resource) const {
        return graph_.resources[resource].concurrent || schedule_.concurrent[resource] ||
               memory_.placements[resource].concurrent;
    }

    /// What is left as it is: no write, no other layout, no other owner.
    [[nodiscard]] bool keeps_state(std::uint32_t resource, const Before& before, const Group& group) const {
        const auto family = [&](const Use* use) { return topology_.queues[use->queue].family; };
        const std::uint32_t owner = before.uses.empty() ? before.host_family : family(before.uses.back());
        const bool same_owner =
            is_shared(resource) || owner == VK_QUEUE_FAMILY_IGNORED ||
            std::all_of(group.uses.begin(), group.uses.end(), [&](const Use* use) { return family(use) == owner; });
        return !group.writes && before.layout == group.layout && same_owner;
    }
    /// The host read last, on the group's own queue, and the group reads what is as it wants it: nothing to do.
    [[nodiscard]] bool reads_like_the_host(const Before& before, const Group& group) const {
        const bool host_read = before.uses.empty() && before.host_stages != 0 && (before.host_access & any_write) == 0;
        return host_read && !full_barriers_ &&
               std::all_of(group.uses.begin(), group.uses.end(), [](const Use* use) { return use->queue == 0; });
    }

    /// All dependencies between `before` and `group`, one for each queue of the group.
    void connect(std::uint32_t resource, std::uint32_t cell, const Before& before, const Group& group) {
        const bool is_image = graph_.resources[resource].kind == ResourceKind::image;
        const bool transition = is_image && before.layout != group.layout;
        const bool spans = std::any_of(group.uses.begin(), group.uses.end(),
                                       [&](const Use* use) { return use->queue != group.uses.front()->queue; });
        if (spans && before.in_frame && before.uses.front()->writes) {
            connect_readers_of_writer(resource, cell, before, group, transition);
            return;
        }
        const Use& leader = *group.uses.front();
        emit(resource, cell, before, group, leader, transition);
        if (spans) {
            // The leader made the transition, or waited for the host; the others are ordered after it.
            Before after_leader;
            after_leader.uses = group.uses.first(1);
            after_leader.layout = group.layout;
            after_leader.in_frame = true;
            after_leader.written = true; // the transition
            for_first_on_other_queues(group, leader.queue, [&](const Use& use) {
                if (transition) {
                    emit(resource, cell, after_leader, group, use, false);
                }
            });
        }
    }

    /// A writer before readers on several queues. Without a transition each queue has a dependency of its own. With
    /// one, the writer's queue does it: before its own first reader if that shares the writer's batch, else at the
    /// batch's end.
    void connect_readers_of_writer(std::uint32_t resource, std::uint32_t cell, const Before& before, const Group& group,
                                   bool transition) {
        const Use& writer = *before.uses.front();
        if (!transition) {
            for_first_on_other_queues(group, none,
                                      [&](const Use& use) { emit(resource, cell, before, group, use, false); });
            return;
        }
        const auto local = std::find_if(group.uses.begin(), group.uses.end(),
                                        [&](const Use* use) { return use->queue == writer.queue; });
        const bool same_batch =
            local != group.uses.end() && batches_.batch_of[(*local)->slot] == batches_.batch_of[writer.slot];
        Before after = before;
        if (same_batch) {
            emit(resource, cell, before, group, **local, true);
            after.uses = {&*local, 1};
        } else {
            FoundDependency made = build(resource, before, group, *group.uses.front(), true);
            Dependency& d = made.dependency;
            d.dst_queue = d.src_queue = writer.queue;
            d.local_stages = d.src_stages;
            d.local_access = d.src_access;
            d.dst_stages = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
            d.dst_access = VK_ACCESS_2_MEMORY_READ_BIT;
            made.release_batch = batches_.batch_of[writer.slot];
            made.only_at_release = true;
            record(made, cell);
            return;
        }
        for_first_on_other_queues(group, writer.queue,
                                  [&](const Use& use) { emit(resource, cell, after, group, use, false); });
    }

    template <typename F>
    void for_first_on_other_queues(const Group& group, std::uint32_t except, F&& f) const {
        for (std::uint32_t queue = 0; queue < schedule_.queue_count; ++queue) {
            const auto first =
                std::find_if(group.uses.begin(), group.uses.end(), [&](const Use* use) { return use->queue == queue; });
            if (queue != except && first != group.uses.end()) {
                f(**first);
            }
        }
    }

    FoundDependency build(std::uint32_t resource, const Before& before, const Group& group, const Use& consumer,
                          bool transition) const {
        FoundDependency made = found_before(consumer.slot);
        Dependency& d = made.dependency;
        d.resource = resource;
        d.consumer = consumer.pass;
        d.src_queue = d.dst_queue = consumer.queue;
        for (const Use* use : group.uses) {
            if (use->queue == consumer.queue) {
                d.dst_stages |= use->scope.stages;
                d.dst_access |= use->scope.access;
            }
        }
        // A transition wants its sources named; everything else that came back with a wait is in the past already.
        add_sources(made, before, consumer.queue,
                    transition || full_barriers_ ? Return{} : schedule_.returns[consumer.slot]);
        d.new_layout = group.layout;
        d.old_layout = !transition                         ? group.layout
                       : group.discards || !before.content ? VK_IMAGE_LAYOUT_UNDEFINED
                                                           : before.layout;
        d.discards = group.discards || !before.content;
        d.alias_of = before.alias_of;
        d.hazard = hazard_of(before, group);
        set_ownership(d, made, resource, before, topology_.queues[consumer.queue].family);
        if (before.uses.empty() && d.src_stages == 0) {
            // Whole frames are ordered by the executor, hosts' uses by a semaphore or by submission: what remains is a
            // transition, chained to that by its own stages.
            d.src_stages = d.local_stages = d.dst_stages & (~d.dst_stages + 1); // any one of them
        } else if (!transition && !d.transfers_ownership && d.src_access == 0 && !before.written) {
            d.dst_access = 0; // order alone matters: there is nothing new to see
        }
        return made;
    }

    void add_sources(FoundDependency& made, const Before& before, std::uint32_t consumer_queue,
                     const Return& returned) const {
        Dependency& d = made.dependency;
        d.src_stages = nameable(topology_.queues[consumer_queue].capabilities, before.host_stages);
        d.src_access = before.host_access & any_write;
        if (returned.passes == 0) {
            d.local_stages = d.src_stages;
            d.local_access = d.src_access;
        } else if (d.src_stages != 0) {
            d.src_queue = returned.from; // the host's work came back with the queue's own
        }
        std::uint32_t last_slot = 0;
        for (const Use* use : before.uses) {
            const VkAccessFlags2 written = use->writes ? use->scope.access & any_write : VkAccessFlags2{0};
            d.src_stages |= use->scope.stages;
            d.src_access |= written;
            const bool own = use->queue == consumer_queue;
            if (own && schedule_.position[use->slot] >= returned.passes) {
                d.local_stages |= use->scope.stages;
                d.local_access |= written;
                const bool has_stages = use->scope.stages != 0;
                made.after_passes =
                    std::max(made.after_passes, has_stages ? schedule_.position[use->slot] + 1 : std::uint32_t{0});
            } else {
                d.src_queue = own ? returned.from : use->queue;
            }
            if (d.producer == none || use->slot >= last_slot) {
                last_slot = use->slot;
                d.producer = use->pass;
            }
        }
    }

    /// EXCLUSIVE resources whose content crosses families are released by the last use and acquired by the next.
    void set_ownership(Dependency& d, FoundDependency& made, std::uint32_t resource, const Before& before,
                       std::uint32_t family) const {
        if (is_shared(resource) || d.discards) {
            return;
        }
        std::uint32_t owner = before.host_family;
        if (before.in_frame) {
            owner = topology_.queues[before.uses.back()->queue].family;
            made.release_batch = batches_.batch_of[before.uses.back()->slot];
        }
        if (owner == VK_QUEUE_FAMILY_IGNORED || owner == family) {
            made.release_batch = none;
            return;
        }
        d.transfers_ownership = true;
        d.src_family = owner;
        d.dst_family = family;
    }

    void emit(std::uint32_t resource, std::uint32_t cell, const Before& before, const Group& group, const Use& consumer,
              bool transition) {
        FoundDependency made = build(resource, before, group, consumer, transition);
        const bool nothing_before = before.uses.empty() && before.host_stages == 0;
        if (nothing_before && !transition && !made.dependency.transfers_ownership) {
            return;
        }
        record(made, cell);
    }

    void leave(std::uint32_t resource, std::uint32_t cell, const Before& before) {
        const ResourceDesc& desc = graph_.resources[resource];
        Group after;
        std::uint32_t family = VK_QUEUE_FAMILY_IGNORED;
        const Use& last = *before.uses.back();
        VkPipelineStageFlags2 stages = 0;
        VkAccessFlags2 access = 0;
        Hazard hazard = Hazard::import_exit;
        if (desc.import != none && graph_.imports[desc.import].has_final) {
            const ImportDesc& import = graph_.imports[desc.import];
            after.layout = import.final_layout;
            stages = import.final_stages;
            access = import.final_access;
            family = import.final_family;
        } else if (desc.has_history && desc.kind == ResourceKind::image) {
            after.layout = out_.resting_layout[resource];
            hazard = Hazard::history_rest;
        } else {
            return;
        }
        const bool transition = desc.kind == ResourceKind::image && after.layout != VK_IMAGE_LAYOUT_UNDEFINED &&
                                after.layout != before.layout;
        const std::uint32_t own_family = topology_.queues[last.queue].family;
        const bool transfers = family != VK_QUEUE_FAMILY_IGNORED && family != own_family && !is_shared(resource);
        const bool only_read = hazard == Hazard::import_exit && (access & any_write) == 0 && !full_barriers_;
        const bool needs_nothing =
            stages == 0 || (only_read && (!before.written || sees_as_much(before, last.queue, stages, access)));
        if (!transition && !transfers && needs_nothing) {
            return;
        }
        FoundDependency made = found_before(exit_slot_);
        Dependency& d = made.dependency;
        d.resource = resource;
        d.hazard = hazard;
        d.src_queue = d.dst_queue = last.queue;
        add_sources(made, before, last.queue, {});
        d.src_queue = last.queue; // the others are ordered before the last use
        d.dst_stages = nameable(topology_.queues[last.queue].capabilities, stages);
        // Where nothing was written order alone matters.
        d.dst_access = transition || transfers || d.src_access != 0 || before.written ? access : 0;
        d.old_layout = before.layout;
        d.new_layout = transition ? after.layout : before.layout;
        d.transfers_ownership = transfers;
        d.src_family = transfers ? own_family : VK_QUEUE_FAMILY_IGNORED;
        d.dst_family = transfers ? family : VK_QUEUE_FAMILY_IGNORED;
        record(made, cell);
    }

    void record(FoundDependency& made, std::uint32_t cell) {
        Dependency& d = made.dependency;
        if (full_barriers_) {
            // The host's stage is no command: where it takes part, it is named beside them.
            constexpr VkPipelineStageFlags2 host = VK_PIPELINE_STAGE_2_HOST_BIT;
            const auto widened = [](VkPipelineStageFlags2 stages) {
                return VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT | (stages & host);
            };
            d.local_stages = d.local_stages != 0 ? widened(d.local_stages) : 0;
            d.src_stages = widened(d.src_stages);
            d.dst_stages = widened(d.dst_stages);
            d.src_access = d.dst_access = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
            d.local_access = d.local_stages != 0 ? d.src_access : 0;
        }
        if (cells_.of_resource[d.resource].whole) {
            all_.push_back(made);
            return;
        }
        // Cells with the same dependency become one record.
        const auto same = std::find_if(of_cells_.begin(), of_cells_.end(), [&](const OfCells& other) {
            return other.made.slot == made.slot && other.made.only_at_release == made.only_at_release &&
                   other.made.release_batch == made.release_batch && same_but_range(other.made.dependency, d);
        });
        if (same != of_cells_.end()) {
            same->cells.push_back(cell);
            same->made.after_passes = std::max(same->made.after_passes, made.after_passes);
        } else {
            of_cells_.push_back({made, Scratch<std::uint32_t>(1, cell)});
        }
    }

    /// Splits the cells of one record into rectangles of mips and layers, or runs of bytes.
    void add_ranges(std::uint32_t resource, OfCells& found) {
        const ResourceCells& of = cells_.of_resource[resource];
        Dependency& part = found.made.dependency;
        for (const CellRange& range : as_rectangles(of, found.cells)) {
            if (graph_.resources[resource].kind == ResourceKind::image) {
                part.image_range = {range.first_mip, range.mip_count, range.first_layer, range.layer_count, 0};
            } else {
                const VkDeviceSize begin = of.boundaries[range.first_layer];
                part.buffer_range = {begin, of.boundaries[range.first_layer + range.layer_count] - begin};
            }
            all_.push_back(found.made);
        }
    }

    const GraphDesc& graph_;
    const QueueTopology& topology_;
    const Cells& cells_;
    const Schedule& schedule_;
    const Memory& memory_;
    const Batches& batches_;
    bool full_barriers_;
    std::uint32_t exit_slot_;
    Synchronised out_;
    Scratch<FoundDependency> all_;
    // Of the resource at hand; members, so that their memory serves all resources.
    Scratch<OfCells> of_cells_;
    Scratch<const Use*> entry_uses_;
    CellUses cell_uses_;
};

} // namespace

Synchronised synchronise(const GraphDesc& graph, const QueueTopology& topology, const Cells& cells,
                         const Schedule& schedule, const Memory& memory, const Batches& batches, bool full_barriers) {
    return Synchroniser(graph, topology, cells, schedule, memory, batches, full_barriers).run();
}

} // namespace tyndall::rg::stages
