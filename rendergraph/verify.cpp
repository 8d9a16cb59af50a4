#include "rendergraph/verify_types.hpp"

#include <algorithm>

namespace tyndall::rg {
namespace {

using namespace checker;

class Verifier {
public:
    Verifier(const GraphDesc& graph, const Plan& plan) : graph_(graph), plan_(plan) {}

    std::vector<Violation> run() {
        found_ = check_form(graph_, plan_);
        if (!found_.empty()) {
            return std::move(found_); // indices cannot be trusted
        }
        begin();
        for (std::uint32_t b = 0; b < plan_.batches.size(); ++b) {
            batch(b);
        }
        exits();
        return std::move(found_);
    }

private:
    void report(ViolationCode code, std::uint32_t pass, std::uint32_t other, std::uint32_t resource,
                std::string message) {
        found_.push_back({code, pass, other, resource, std::move(message)});
    }
    [[nodiscard]] std::string pass_name(std::uint32_t pass) const {
        return pass == none ? "the host" : "'" + graph_.passes[pass].name + "'";
    }
    [[nodiscard]] std::string resource_name(std::uint32_t r) const { return "'" + graph_.resources[r].name + "'"; }

    [[nodiscard]] bool share_bytes(std::uint32_t a, std::uint32_t b) const {
        return a != b && checker::share_bytes(plan_, a, b);
    }

    void begin() {
        aliases_.resize(graph_.resources.size());
        events_of_.resize(graph_.resources.size());
        for (std::uint32_t r = 0; r < graph_.resources.size(); ++r) {
            atoms_.push_back(make_atoms(graph_, plan_, r));
            if (graph_.resources[r].import != none) {
                add_host_event(r, graph_.imports[graph_.resources[r].import]);
            }
            for (std::uint32_t other = 0; other < graph_.resources.size(); ++other) {
                if (share_bytes(r, other)) {
                    aliases_[r].push_back(other);
                }
            }
        }
    }

    void add_host_event(std::uint32_t r, const ImportDesc& import) {
        if (import.initial_stages == 0) {
            return; // a semaphore, or the host's own wait, came before
        }
        Event event;
        event.resource = r;
        event.stages = import.initial_stages;
        event.access = import.initial_access;
        event.writes = (import.initial_access & (writing | VK_ACCESS_2_MEMORY_WRITE_BIT)) != 0;
        event.reach.assign(plan_.topology.queues.size(), Reach{});
        add_events(event, region_of(graph_.resources[r], {}, {}));
        host_events_ = events_.size(); // on every queue at once: the host submitted it before the frame
    }

    [[nodiscard]] bool source_includes(std::size_t e, std::uint32_t queue, VkPipelineStageFlags2 src) const {
        const Event& event = events_[e];
        const bool own =
            (event.queue == queue || e < host_events_) && event.stages != 0 && covers_stages(src, event.stages);
        return own || meets_stages(event.reach[queue].ordered, src);
    }

    /// One dependency recorded on `queue`, all of one vkCmdPipelineBarrier2 at once.
    void barriers(std::uint32_t queue, const std::vector<const Dependency*>& dependencies, bool is_release,
                  std::uint32_t before_pass) {
        std::vector<Effect> effects;
        for (const Dependency* d : dependencies) {
            if (const std::optional<Effect> effect = effect_of(*d, is_release)) {
                check_stages(queue, effect->src | effect->dst, before_pass, d->resource);
                effects.push_back(*effect);
            }
        }
        // Transitions come after what their source scope names, and before the reaches grow.
        for (const Effect& effect : effects) {
            ownership(*effect.d, is_release, before_pass);
            if (effect.transition) {
                transition(*effect.d, queue, effect.src, before_pass);
            }
        }
        for (std::size_t e = 0; e < events_.size(); ++e) {
            if (retired(e)) {
                continue;
            }
            Reach grown = events_[e].reach[queue];
            for (const Effect& effect : effects) {
                if (effect.dst == 0 || !source_includes(e, queue, effect.src)) {
                    continue;
                }
                grown.ordered |= effect.dst;
                const Event& event = events_[e];
                const Region covered =
                    region_of(graph_.resources[effect.d->resource], effect.d->image_range, effect.d->buffer_range);
                // Memory: the barrier's own range, or bytes taken over (the executor adds a global barrier there).
                const bool same = event.resource == effect.d->resource && covered.contains(event.region);
                const bool aliased =
                    effect.d->hazard == Hazard::aliased_memory && share_bytes(event.resource, effect.d->resource);
                if (!same && !aliased) {
                    continue;
                }
                if (event.writes &&
                    covers_access(effect.src_access, event.access & (writing | VK_ACCESS_2_MEMORY_WRITE_BIT))) {
                    events_[e].available = true;
                }
                if (events_[e].available || !event.writes) {
                    grown.visible_stages |= effect.dst;
                    grown.visible_access |= effect.dst_access;
                }
            }
            events_[e].reach[queue] = grown;
        }
        for (const Effect& effect : effects) {
            if (effect.transition) {
                add_transition_event(*effect.d, queue, effect.dst, effect.dst_access);
            }
        }
    }

    void check_stages(std::uint32_t queue, VkPipelineStageFlags2 stages, std::uint32_t pass, std::uint32_t resource) {
        if (plan_.topology.queues[queue].kind != QueueKind::graphics && (stages & only_graphics_stages) != 0) {
            report(ViolationCode::queue_cannot, pass, none, resource,
                   "a barrier of " + resource_name(resource) + " names graphics stages on a queue that has none");
        }
    }

    void ownership(const Dependency& d, bool is_release, std::uint32_t pass) {
        if (!d.transfers_ownership) {
            return;
        }
        for_atoms(d.resource, region_of(graph_.resources[d.resource], d.image_range, d.buffer_range), [&](Atom& atom) {
            if (is_release) {
                if (atom.owner != d.src_family || atom.released) {
                    report(ViolationCode::ownership, pass, none, d.resource,
                           resource_name(d.resource) + " is released by a family that does not own it");
                }
                atom.released = true;
                atom.released_to = d.dst_family;
            } else if (d.consumer == none) {
                atom.released = true; // the host acquires it
                atom.released_to = d.dst_family;
            } else {
                const bool host = d.producer == none;
                if (!atom.released || (!host && atom.released_to != d.dst_family) || atom.owner != d.src_family) {
                    report(ViolationCode::ownership, pass, none, d.resource,
                           resource_name(d.resource) + " is acquired but was not released to that family");
                }
                atom.released = false;
                atom.owner = d.dst_family;
            }
        });
    }

    void transition(const Dependency& d, std::uint32_t queue, VkPipelineStageFlags2 src, std::uint32_t pass) {
        const Region region = region_of(graph_.resources[d.resource], d.image_range, d.buffer_range);
        for_conflicts(d.resource, region, [&](std::size_t e) {
            if (!source_includes(e, queue, src)) {
                report(ViolationCode::race, pass, events_[e].pass, d.resource,
                       "the layout transition of " + resource_name(d.resource) + " before " + pass_name(pass) +
                           " is not ordered after " + pass_name(events_[e].pass));
            }
        });
        for_atoms(d.resource, region, [&](Atom& atom) {
            if (d.old_layout == VK_IMAGE_LAYOUT_UNDEFINED) {
                atom.defined = false;
            } else if (atom.layout != d.old_layout) {
                report(ViolationCode::wrong_layout, pass, none, d.resource,
                       "a transition of " + resource_name(d.resource) + " before " + pass_name(pass) +
                           " starts from another layout than it has");
            }
            atom.layout = d.new_layout;
        });
    }

    void add_transition_event(const Dependency& d, std::uint32_t queue, VkPipelineStageFlags2 dst,
                              VkAccessFlags2 dst_access) {
        Event event;
        event.pass = d.consumer;
        event.resource = d.resource;
        event.queue = queue;
        event.writes = true;
        event.available = true;
        event.reach.assign(plan_.topology.queues.size(), Reach{});
        event.reach[queue] = {dst, dst, dst_access};
        add_events(event, region_of(graph_.resources[d.resource], d.image_range, d.buffer_range));
    }

    /// One event an atom, so that a barrier of some range covers each event wholly or not at all.
    void add_events(const Event& event, const Region& region) {
        for_atoms(event.resource, region, [&](const Atom& atom) {
            Event part = event;
            part.region = atom.region;
            add_event(std::move(part));
        });
    }

    void add_event(Event event) {
        if (event.writes) {
            // What it covers was ordered before it, so later accesses need only be ordered after it.
            for (const std::uint32_t e : events_of_[event.resource]) {
                if (event.region.contains(events_[e].region)) {
                    events_[e].reach.clear();
                }
            }
            std::erase_if(events_of_[event.resource], [&](std::uint32_t e) { return retired(e); });
        }
        events_of_[event.resource].push_back(static_cast<std::uint32_t>(events_.size()));
        events_.push_back(std::move(event));
    }
    [[nodiscard]] bool retired(std::size_t e) const { return events_[e].reach.empty(); }

    template <typename F>
    void for_atoms(std::uint32_t resource, const Region& region, F&& f) {
        for (Atom& atom : atoms_[resource]) {
            if (atom.region.meets(region)) {
                f(atom);
            }
        }
    }
    /// Events that touch common bytes: of the resource itself, and of those that share its memory.
    template <typename F>
    void for_conflicts(std::uint32_t resource, const Region& region, F&& f) const {
        for (const std::uint32_t e : events_of_[resource]) {
            if (events_[e].region.meets(region)) {
                f(e);
            }
        }
        for (const std::uint32_t other : aliases_[resource]) {
            for (const std::uint32_t e : events_of_[other]) {
                f(e);
            }
        }
    }

    void batch(std::uint32_t index) {
        const Batch& b = plan_.batches[index];
        for (const BatchWait& wait : b.waits) {
            if (wait.batch >= index || !plan_.batches[wait.batch].signals) {
                report(ViolationCode::never_signalled, plan_.passes[b.first_pass].pass, none, none,
                       "batch " + std::to_string(index) + " waits for batch " + std::to_string(wait.batch) +
                           ", which does not signal before it");
                continue;
            }
            semaphore(wait.batch, b.queue, wait.stages);
        }
        for (std::uint32_t i = b.first_pass; i < b.first_pass + b.pass_count; ++i) {
            pass(plan_.passes[i], b.queue);
        }
        std::vector<const Dependency*> releases;
        for (const std::uint32_t d : b.releases) {
            releases.push_back(&plan_.dependencies[d]);
        }
        barriers(b.queue, releases, true, none);
        // What is ordered before this batch's end on its queue is what a waiter will be ordered after.
        for (std::size_t e = 0; b.signals && e < events_.size(); ++e) {
            if (!retired(e) &&
                (events_[e].queue == b.queue || events_[e].reach[b.queue].ordered != 0 || e < host_events_)) {
                before_signal_.push_back({index, e});
            }
        }
    }

    void semaphore(std::uint32_t signal, std::uint32_t queue, VkPipelineStageFlags2 stages) {
        for (const auto& [batch_index, e] : before_signal_) {
            if (batch_index == signal && !retired(e)) {
                Reach& reach = events_[e].reach[queue];
                reach.ordered |= stages;
                reach.visible_stages |= stages;
                reach.visible_access |= VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
                events_[e].available = true;
            }
        }
    }

    void pass(const PlannedPass& planned, std::uint32_t queue) {
        const PassDesc& desc = graph_.passes[planned.pass];
        if (planned.queue != queue) {
            report(ViolationCode::malformed, planned.pass, none, none,
                   "pass " + pass_name(planned.pass) + " and its batch are on different queues");
        }
        const int needs = desc.kind == PassKind::graphics  ? can_graphics
                          : desc.kind == PassKind::compute ? can_compute
                                                           : 0;
        if ((plan_.topology.queues[queue].capabilities & needs) != needs) {
            report(ViolationCode::queue_cannot, planned.pass, none, none,
                   "pass " + pass_name(planned.pass) + " is on a queue that cannot run it");
        }
        std::vector<const Dependency*> before;
        for (std::uint32_t d = planned.first_barrier; d < planned.first_barrier + planned.barrier_count; ++d) {
            before.push_back(&plan_.dependencies[d]);
        }
        barriers(queue, before, false, planned.pass);
        const std::size_t own = events_.size();
        for (std::uint32_t i = desc.first_access; i < desc.first_access + desc.access_count; ++i) {
            access(graph_.accesses[i], queue, own);
        }
        for (std::uint32_t i = desc.first_access; i < desc.first_access + desc.access_count; ++i) {
            record(graph_.accesses[i], queue);
        }
    }

    void access(const AccessDesc& a, std::uint32_t queue, std::size_t own) {
        const ResourceDesc& resource = graph_.resources[a.resource];
        const bool image = resource.kind == ResourceKind::image;
        const AccessScope scope =
            access_scope(a.access, a.direction, image ? resource.image.format : VK_FORMAT_UNDEFINED);
        const Region region = region_of(resource, a.image_range, a.buffer_range);
        for_conflicts(a.resource, region, [&](std::size_t e) {
            const Event& event = events_[e];
            if (e >= own || (!event.writes && !is_write(a.direction) && event.resource == a.resource)) {
                return;
            }
            const Reach& reach = event.reach[queue];
            if (!covers_stages(reach.ordered, scope.stages)) {
                report(ViolationCode::race, a.pass, event.pass, a.resource,
                       pass_name(a.pass) + " touches " + resource_name(a.resource) + " without being ordered after " +
                           pass_name(event.pass));
            } else if (event.resource != a.resource) {
                // Other bytes in the same memory: their content is dead, but must not be written back later.
                if (event.writes && is_write(a.direction) && !event.available) {
                    report(ViolationCode::not_visible, a.pass, event.pass, a.resource,
                           "what " + pass_name(event.pass) + " left in memory that " + resource_name(a.resource) +
                               " takes over is not available before " + pass_name(a.pass) + " writes");
                }
            } else if (event.writes && (!event.available || !covers_stages(reach.visible_stages, scope.stages) ||
                                        !covers_access(reach.visible_access, scope.access))) {
                report(ViolationCode::not_visible, a.pass, event.pass, a.resource,
                       "what " + pass_name(event.pass) + " wrote is not visible to the access of " + pass_name(a.pass) +
                           " to " + resource_name(a.resource));
            }
        });
        const std::uint32_t family = plan_.topology.queues[queue].family;
        const bool exclusive = !plan_.placements[a.resource].concurrent && !resource.concurrent;
        for_atoms(a.resource, region, [&](Atom& atom) {
            if (image && atom.layout != scope.layout) {
                report(ViolationCode::wrong_layout, a.pass, none, a.resource,
                       pass_name(a.pass) + " finds " + resource_name(a.resource) + " in another layout than it needs");
            }
            if (is_read(a.direction) && !atom.defined) {
                report(ViolationCode::undefined_content, a.pass, none, a.resource,
                       pass_name(a.pass) + " reads undefined content of " + resource_name(a.resource));
            }
            if (exclusive && is_read(a.direction) &&
                ((atom.owner != VK_QUEUE_FAMILY_IGNORED && atom.owner != family) ||
                 (atom.released && atom.released_to != VK_QUEUE_FAMILY_IGNORED))) {
                report(ViolationCode::ownership, a.pass, none, a.resource,
                       pass_name(a.pass) + " reads " + resource_name(a.resource) + ", which another family owns");
            }
        });
    }

    void record(const AccessDesc& a, std::uint32_t queue) {
        const ResourceDesc& resource = graph_.resources[a.resource];
        const bool image = resource.kind == ResourceKind::image;
        const AccessScope scope =
            access_scope(a.access, a.direction, image ? resource.image.format : VK_FORMAT_UNDEFINED);
        Event event;
        event.pass = a.pass;
        event.resource = a.resource;
        event.queue = queue;
        event.stages = scope.stages;
        event.access = scope.access;
        event.writes = is_write(a.direction);
        event.reach.assign(plan_.topology.queues.size(), Reach{});
        const Region region = region_of(resource, a.image_range, a.buffer_range);
        for_atoms(a.resource, region, [&](Atom& atom) {
            atom.defined = atom.defined || event.writes;
            atom.owner = plan_.topology.queues[queue].family;
            atom.released = false;
        });
        add_events(event, region);
    }

    [[nodiscard]] bool touched(std::uint32_t r) const {
        return !events_of_[r].empty() && events_of_[r].back() >= host_events_;
    }
    void exits() {
        for (std::uint32_t d = plan_.first_exit_barrier; d < plan_.first_exit_barrier + plan_.exit_barrier_count; ++d) {
            // Stages that ran on other queues were waited for by the last use; this queue names them as all commands.
            Dependency leaving = plan_.dependencies[d];
            const bool foreign = plan_.topology.queues[leaving.src_queue].kind != QueueKind::graphics &&
                                 (leaving.src_stages & only_graphics_stages) != 0;
            leaving.src_stages = foreign ? all_commands : leaving.src_stages;
            leaving.src_access = foreign ? VkAccessFlags2{VK_ACCESS_2_MEMORY_WRITE_BIT} : leaving.src_access;
            barriers(leaving.src_queue, {&leaving}, false, none);
        }
        for (std::uint32_t r = 0; r < graph_.resources.size(); ++r) {
            const ResourceDesc& resource = graph_.resources[r];
            VkImageLayout wanted = VK_IMAGE_LAYOUT_UNDEFINED;
            if (resource.import != none && graph_.imports[resource.import].has_final) {
                const ImportDesc& import = graph_.imports[resource.import];
                wanted = import.final_layout;
                for (const std::uint32_t e : events_of_[r]) {
                    check_exit_visibility(r, e, import);
                }
            } else if (resource.has_history) {
                wanted = plan_.placements[r].resting_layout;
            }
            const bool left_as_agreed =
                resource.kind != ResourceKind::image || wanted == VK_IMAGE_LAYOUT_UNDEFINED || !touched(r) ||
                std::all_of(atoms_[r].begin(), atoms_[r].end(), [&](const Atom& a) { return a.layout == wanted; });
            if (!left_as_agreed) {
                report(ViolationCode::exit_state, none, none, r,
                       resource_name(r) + " is not left in the layout that was agreed");
            }
        }
    }

    void check_exit_visibility(std::uint32_t r, std::uint32_t e, const ImportDesc& import) {
        const Event& event = events_[e];
        if (!event.writes || import.final_stages == 0 || e < host_events_) {
            return;
        }
        if (!visible_anywhere(event, import.final_stages, import.final_access)) {
            report(ViolationCode::exit_state, event.pass, none, r,
                   resource_name(r) + " is not visible to the host's next access when the frame ends");
        }
    }

    const GraphDesc& graph_;
    const Plan& plan_;
    std::vector<Violation> found_;
    std::vector<Event> events_;
    std::size_t host_events_ = 0;
    std::vector<std::vector<std::uint32_t>> events_of_;                ///< by resource, those not retired
    std::vector<std::vector<Atom>> atoms_;                             ///< by resource
    std::vector<std::vector<std::uint32_t>> aliases_;                  ///< by resource: others whose bytes it shares
    std::vector<std::pair<std::uint32_t, std::size_t>> before_signal_; ///< (batch, event)
};

} // namespace

std::vector<Violation> verify(const GraphDesc& graph, const Plan& plan) {
    return Verifier(graph, plan).run();
}

} // namespace tyndall::rg
