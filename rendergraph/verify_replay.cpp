#include "rendergraph/verify_replay.hpp"

#include <algorithm>

namespace tyndall::rg::checker {

Replay::Replay(const GraphDesc& graph, const Plan& plan, Order& order, Memory& memory, std::vector<Violation>& found)
    : graph_(graph), plan_(plan), order_(order), memory_(memory), found_(found), frame_(memory.frame()) {}

void Replay::run() {
    std::vector<std::uint32_t> batch_of(graph_.passes.size(), none);
    for (std::uint32_t b = 0; b < plan_.batches.size(); ++b) {
        const Batch& batch = plan_.batches[b];
        for (std::uint32_t i = batch.first_pass; i < batch.first_pass + batch.pass_count; ++i) {
            batch_of[plan_.passes[i].pass] = b;
        }
    }
    // The host's final state is set in the batch of the last use.
    exits_after_.resize(plan_.batches.size());
    for (std::uint32_t d = plan_.first_exit_barrier; d < plan_.first_exit_barrier + plan_.exit_barrier_count; ++d) {
        const std::uint32_t producer = plan_.dependencies[d].producer;
        if (producer != none && batch_of[producer] != none) {
            exits_after_[batch_of[producer]].push_back(d);
        }
    }
    signals_.resize(plan_.batches.size());
    for (std::uint32_t b = 0; b < plan_.batches.size(); ++b) {
        const Batch& batch = plan_.batches[b];
        begin_batch(b);
        for (std::uint32_t i = batch.first_pass; i < batch.first_pass + batch.pass_count; ++i) {
            pass(plan_.passes[i], batch.queue);
        }
        end_batch(b);
    }
    for (std::uint32_t r = 0; r < graph_.resources.size(); ++r) {
        check_end(r);
    }
}

void Replay::report(ViolationCode code, std::uint32_t pass, std::uint32_t other, std::uint32_t resource,
                    std::string message) {
    found_.push_back({code, pass, other, resource, std::move(message)});
}
std::string Replay::pass_name(std::uint32_t pass) const {
    return pass == none ? "the host" : "'" + graph_.passes[pass].name + "'";
}
std::string Replay::resource_name(std::uint32_t resource) const {
    return "'" + graph_.resources[resource].name + "'";
}

void Replay::begin_batch(std::uint32_t index) {
    const Batch& batch = plan_.batches[index];
    const std::uint32_t first = batch.pass_count > 0 ? plan_.passes[batch.first_pass].pass : none;
    for (const BatchWait& wait : batch.waits) {
        if (wait.batch >= index || !plan_.batches[wait.batch].signals) {
            report(ViolationCode::never_signalled, first, none, none,
                   "batch " + std::to_string(index) + " waits for batch " + std::to_string(wait.batch) +
                       ", which does not signal before it");
            continue;
        }
        if (stages_it_lacks(wait.stages, plan_.topology.queues[batch.queue].capabilities) != 0) {
            report(ViolationCode::queue_cannot, first, none, none,
                   "batch " + std::to_string(index) + " waits with stages that its queue does not have");
        }
        order_.wait(batch.queue, destination_stages(wait.stages), signals_[wait.batch]);
    }
    for (const std::uint32_t resource : batch.waits_imports) {
        Object& object = memory_.of_resource(resource);
        object.awaits_host = false;
        Event event;
        event.at = {batch.queue, order_.begin_command(batch.queue), every_stage & ~host_stage, true};
        event.seen_by = {{batch.queue, event.at.stages, VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT}};
        for (Atom& atom : object.atoms) {
            atom.last_write = event;
            atom.written = true;
        }
    }
}

void Replay::end_batch(std::uint32_t index) {
    const Batch& batch = plan_.batches[index];
    const std::uint8_t can = plan_.topology.queues[batch.queue].capabilities;
    effects_.clear();
    for (const std::uint32_t d : batch.releases) {
        effects_.push_back(*effect_of(plan_.dependencies[d], Recorded::at_batch_end, can));
    }
    for (const std::uint32_t d : exits_after_[index]) {
        effects_.push_back(*effect_of(plan_.dependencies[d], Recorded::at_exit, can));
    }
    barriers(batch.queue, none);
    if (batch.signals || !batch.signals_imports.empty()) {
        signals_[index] = order_.signal(batch.queue);
    }
    for (const std::uint32_t resource : batch.signals_imports) {
        memory_.of_resource(resource).host_signal = signals_[index];
    }
}

void Replay::pass(const PlannedPass& planned, std::uint32_t queue) {
    const PassDesc& desc = graph_.passes[planned.pass];
    if (planned.queue != queue) {
        report(ViolationCode::malformed, planned.pass, none, none,
               "pass " + pass_name(planned.pass) + " and its batch are on different queues");
    }
    const std::uint8_t can = plan_.topology.queues[queue].capabilities;
    const int needs = desc.kind == PassKind::graphics   ? can_graphics
                      : desc.kind == PassKind::compute  ? can_compute
                      : desc.kind == PassKind::transfer ? can_transfer
                                                        : 0;
    if ((can & needs) != needs) {
        report(ViolationCode::queue_cannot, planned.pass, none, none,
               "pass " + pass_name(planned.pass) + " is on a queue that cannot run it");
    }
    effects_.clear();
    for (std::uint32_t d = planned.first_barrier; d < planned.first_barrier + planned.barrier_count; ++d) {
        if (const std::optional<Effect> effect = effect_of(plan_.dependencies[d], Recorded::before_consumer, can)) {
            effects_.push_back(*effect);
        }
    }
    barriers(queue, planned.pass);
    const std::uint32_t sequence = order_.begin_command(queue);
    const auto for_accesses = [&](auto&& f) {
        for (std::uint32_t i = desc.first_access; i < desc.first_access + desc.access_count; ++i) {
            const AccessDesc& access = graph_.accesses[i];
            const ResourceDesc& resource = graph_.resources[access.resource];
            const AccessScope scope =
                access_scope(access.access, access.direction,
                             resource.kind == ResourceKind::image ? resource.image.format : VK_FORMAT_UNDEFINED);
            const Toucher toucher{.pass = planned.pass,
                                  .queue = queue,
                                  .sequence = sequence,
                                  .stages = destination_stages(scope.stages),
                                  .access = scope.access,
                                  .writes = is_write(access.direction)};
            f(access, toucher, operations_of(planned, i));
        }
    };
    for_accesses([&](const auto&... args) { check_access(args...); });
    for_accesses([&](const auto&... args) { record_access(args...); });
}

const AttachmentOps* Replay::operations_of(const PlannedPass& planned, std::uint32_t access) const {
    for (std::uint32_t i = planned.first_attachment; i < planned.first_attachment + planned.attachment_count; ++i) {
        if (plan_.attachments[i].access == access) {
            return &plan_.attachments[i];
        }
    }
    return nullptr;
}

SourceScope& Replay::new_scope(StageSet stages) {
    if (scope_count_ == scopes_.size()) {
        scopes_.emplace_back();
    }
    scopes_[scope_count_].first = stages;
    return scopes_[scope_count_++].second;
}
const SourceScope* Replay::scope_of(const Effect& effect) const {
    const StageSet stages = source_stages(effect.src);
    const auto end = scopes_.begin() + static_cast<std::ptrdiff_t>(scope_count_);
    const auto found = std::find_if(scopes_.begin(), end, [&](const auto& scope) { return scope.first == stages; });
    return found == end ? nullptr : &found->second;
}

/// All of one vkCmdPipelineBarrier2: none of them comes after another.
void Replay::barriers(std::uint32_t queue, std::uint32_t before_pass) {
    if (effects_.empty()) {
        return;
    }
    const std::uint32_t sequence = order_.begin_command(queue);
    scope_count_ = 0;
    for (const Effect& effect : effects_) {
        if (stages_it_lacks(effect.src | effect.dst, plan_.topology.queues[queue].capabilities) != 0) {
            report(ViolationCode::queue_cannot, before_pass, none, effect.d->resource,
                   "a barrier of " + resource_name(effect.d->resource) + " names stages that its queue does not have");
        }
        if (scope_of(effect) == nullptr) {
            const StageSet stages = source_stages(effect.src);
            order_.source_scope(queue, stages, new_scope(stages));
        }
    }
    const auto here = [&](const Effect& effect) {
        return Point{queue, sequence, destination_stages(effect.dst), true};
    };
    // Transitions come after what their source scope names, and before memory becomes visible.
    for (const Effect& effect : effects_) {
        act(effect, *scope_of(effect), queue, before_pass);
    }
    for (const Effect& effect : effects_) {
        carry_memory(effect, *scope_of(effect), here(effect));
    }
    for (const Effect& effect : effects_) {
        record_act(effect, here(effect));
    }
    for (const Effect& effect : effects_) {
        order_.add_barrier(queue, destination_stages(effect.dst), *scope_of(effect));
    }
}

/// Layout and owner change.
void Replay::act(const Effect& effect, const SourceScope& source, std::uint32_t queue, std::uint32_t before_pass) {
    if (!effect.changes_layout && !effect.changes_owner) {
        return;
    }
    const Dependency& d = *effect.d;
    memory_.take_bytes(d.resource);
    Object& object = memory_.of_resource(d.resource);
    const Region region = region_of(graph_.resources[d.resource], d.image_range, d.buffer_range);
    const Toucher toucher{.pass = before_pass, .queue = queue, .writes = true, .source = &source, .effect = &effect};
    for_atoms(object, atoms_meeting(object, region), [&](Atom& atom) {
        check_conflicts(object, atom, toucher);
        if (atom.owner == VK_QUEUE_FAMILY_IGNORED ||
            (effect.changes_layout && d.old_layout == VK_IMAGE_LAYOUT_UNDEFINED)) {
            atom.owner = plan_.topology.queues[queue].family; // nobody's, or without content to keep
            atom.released = false;
        }
        change_owner(effect, atom, before_pass);
        if (!effect.changes_layout) {
            return;
        }
        if (d.old_layout == VK_IMAGE_LAYOUT_UNDEFINED) {
            atom.defined = false;
        } else if (atom.layout != d.old_layout) {
            report(ViolationCode::wrong_layout, before_pass, none, d.resource,
                   "a transition of " + resource_name(d.resource) + " before " + pass_name(before_pass) +
                       " starts from another layout than it has");
        }
        atom.layout = d.new_layout;
    });
}

void Replay::change_owner(const Effect& effect, Atom& atom, std::uint32_t before_pass) {
    if (!effect.changes_owner) {
        return;
    }
    const Dependency& d = *effect.d;
    const bool release = effect.dst == 0 && d.consumer != none;
    const bool leaves = d.consumer == none; // the host acquires it
    if (release || leaves) {
        const bool given_away = atom.released && atom.released_to != VK_QUEUE_FAMILY_IGNORED;
        if (atom.owner != d.src_family || given_away) {
            report(ViolationCode::ownership, before_pass, none, d.resource,
                   resource_name(d.resource) + " is released by a family that does not own it");
        }
        atom.released = true;
        atom.released_to = d.dst_family;
        return;
    }
    const bool from_host = d.producer == none;
    if (!atom.released || (!from_host && atom.released_to != d.dst_family) || atom.owner != d.src_family) {
        report(ViolationCode::ownership, before_pass, none, d.resource,
               resource_name(d.resource) + " is acquired but was not released to that family");
    }
    atom.released = false;
    atom.owner = d.dst_family;
}

/// Writes that the barrier's source scope holds become available, and visible to its destination.
void Replay::carry_memory(const Effect& effect, const SourceScope& source, const Point& here) {
    const Dependency& d = *effect.d;
    Object& object = memory_.of_resource(d.resource);
    const Region region = region_of(graph_.resources[d.resource], d.image_range, d.buffer_range);
    for_atoms(object, atoms_inside(object, region), [&](Atom& atom) {
        if (atom.written) {
            carry(atom.last_write, effect, source, here, true);
        }
    });
    if (d.hazard != Hazard::aliased_memory || effect.src_access == 0) {
        return;
    }
    // The executor adds a barrier of all memory, since other resources wrote these bytes.
    for (const std::uint32_t other : object.holds_bytes ? object.displaced : memory_.neighbours(object)) {
        for (Atom& atom : memory_.at(other).atoms) {
            if (atom.written) {
                carry(atom.last_write, effect, source, here, false);
            }
        }
    }
}

void Replay::carry(Event& event, const Effect& effect, const SourceScope& source, const Point& here,
                   bool same_resource) {
    if (!covers(source.ordered.data(), event.at)) {
        return;
    }
    const bool before = available_in(event, source);
    const bool made = event.written != 0 && covers_access(effect.src_access, event.written);
    if (made && !before) {
        event.available_from.push_back(here);
    }
    if (same_resource && (made || before) && effect.dst_access != 0) {
        event.seen_by.push_back({here.queue, here.stages, effect.dst_access});
    }
}

void Replay::record_act(const Effect& effect, const Point& here) {
    if (!effect.changes_layout && !effect.changes_owner) {
        return;
    }
    const Dependency& d = *effect.d;
    Object& object = memory_.of_resource(d.resource);
    const Region region = region_of(graph_.resources[d.resource], d.image_range, d.buffer_range);
    const Event event{.pass = d.consumer != none ? d.consumer : d.producer,
                      .at = here,
                      .seen_by = {{here.queue, here.stages, effect.dst_access}}};
    for_atoms(object, atoms_meeting(object, region), [&](Atom& atom) {
        atom.last_write = event;
        atom.written = true;
        atom.reads.clear();
        memory_.begin(object, atom);
    });
}

} // namespace tyndall::rg::checker
