#include "rendergraph/verify.hpp"

#include <algorithm>

namespace tyndall::rg {
namespace {

constexpr VkPipelineStageFlags2 all_commands = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
constexpr VkAccessFlags2 writing = VK_ACCESS_2_SHADER_WRITE_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT |
                                   VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT |
                                   VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT |
                                   VK_ACCESS_2_HOST_WRITE_BIT | VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR;

constexpr VkPipelineStageFlags2 only_graphics_stages =
    VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT |
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT |
    VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT | VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT |
    VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT;

/// `mask` names every stage of `stages`; ALL_COMMANDS names all but the host.
bool covers_stages(VkPipelineStageFlags2 mask, VkPipelineStageFlags2 stages) {
    if ((mask & all_commands) != 0) {
        stages &= VK_PIPELINE_STAGE_2_HOST_BIT;
    }
    return (stages & ~mask) == 0;
}
bool meets_stages(VkPipelineStageFlags2 a, VkPipelineStageFlags2 b) {
    const VkPipelineStageFlags2 device = ~VK_PIPELINE_STAGE_2_HOST_BIT;
    return (a & b) != 0 || ((a & all_commands) != 0 && (b & device) != 0) ||
           ((b & all_commands) != 0 && (a & device) != 0);
}
bool covers_access(VkAccessFlags2 mask, VkAccessFlags2 access) {
    const bool all_reads = (mask & VK_ACCESS_2_MEMORY_READ_BIT) != 0;
    const bool all_writes = (mask & VK_ACCESS_2_MEMORY_WRITE_BIT) != 0;
    access &= ~mask;
    access &= all_reads ? writing : ~VkAccessFlags2{0};
    access &= all_writes ? ~writing : ~VkAccessFlags2{0};
    return access == 0;
}

/// A part of a resource: mips x layers of an image, or bytes of a buffer.
struct Region {
    std::uint64_t first_a = 0, end_a = 1; ///< mips, or bytes
    std::uint64_t first_b = 0, end_b = 1; ///< layers
    [[nodiscard]] bool meets(const Region& o) const {
        return first_a < o.end_a && o.first_a < end_a && first_b < o.end_b && o.first_b < end_b;
    }
    [[nodiscard]] bool contains(const Region& o) const {
        return first_a <= o.first_a && o.end_a <= end_a && first_b <= o.first_b && o.end_b <= end_b;
    }
};

Region region_of(const ResourceDesc& resource, const ImageRange& image, const BufferRange& buffer) {
    if (resource.kind == ResourceKind::buffer) {
        const std::uint64_t end =
            buffer.size == whole_buffer ? resource.buffer.size_bytes : buffer.offset + buffer.size;
        return {buffer.offset, end, 0, 1};
    }
    const std::uint32_t mips =
        image.mip_count == all_remaining ? resource.image.mips - image.base_mip : image.mip_count;
    const std::uint32_t layers =
        image.layer_count == all_remaining ? resource.image.layers - image.base_layer : image.layer_count;
    return {image.base_mip, image.base_mip + mips, image.base_layer, image.base_layer + layers};
}

/// Where on one queue an event is known to have happened, and where its memory is visible.
struct Reach {
    VkPipelineStageFlags2 ordered = 0; ///< later commands in these stages come after it
    VkPipelineStageFlags2 visible_stages = 0;
    VkAccessFlags2 visible_access = 0;
};

/// An access, or a layout transition, that later ones may conflict with.
struct Event {
    std::uint32_t pass = none; ///< none: the host
    std::uint32_t resource = none;
    Region region;
    std::uint32_t queue = 0;
    VkPipelineStageFlags2 stages = 0; ///< 0 for transitions: reached only through `reach`
    VkAccessFlags2 access = 0;
    bool writes = false;
    bool available = false;
    std::vector<Reach> reach; ///< by queue
};

/// Layout, definedness and owner of one atom of a resource.
struct Atom {
    Region region;
    VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
    bool defined = false;
    std::uint32_t owner = VK_QUEUE_FAMILY_IGNORED; ///< IGNORED: nobody yet
    bool released = false;                         ///< to `released_to`, not yet acquired
    std::uint32_t released_to = VK_QUEUE_FAMILY_IGNORED;
};

class Verifier {
public:
    Verifier(const GraphDesc& graph, const Plan& plan) : graph_(graph), plan_(plan) {}

    std::vector<Violation> run() {
        if (!well_formed()) {
            return std::move(found_);
        }
        placements();
        make_atoms();
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

    bool well_formed() {
        const auto broken = [&](const char* what) {
            report(ViolationCode::malformed, none, none, none, what);
            return false;
        };
        std::vector<std::uint32_t> seen(graph_.passes.size(), 0);
        for (const PlannedPass& planned : plan_.passes) {
            if (planned.pass >= graph_.passes.size() || planned.queue >= plan_.topology.queues.size() ||
                planned.first_barrier + planned.barrier_count > plan_.dependencies.size()) {
                return broken("a planned pass points outside the graph, the queues or the dependencies");
            }
            ++seen[planned.pass];
        }
        for (const CulledPass& culled : plan_.culled_passes) {
            if (culled.pass >= graph_.passes.size()) {
                return broken("a pass that is left out is not in the graph");
            }
            ++seen[culled.pass];
        }
        if (std::any_of(seen.begin(), seen.end(), [](std::uint32_t n) { return n != 1; })) {
            return broken("some pass is neither planned nor left out, or both, or twice");
        }
        std::uint32_t next = 0;
        for (const Batch& b : plan_.batches) {
            if (b.first_pass != next || b.first_pass + b.pass_count > plan_.passes.size() ||
                b.queue >= plan_.topology.queues.size()) {
                return broken("the batches do not follow the passes");
            }
            next += b.pass_count;
            for (const std::uint32_t d : b.releases) {
                if (d >= plan_.dependencies.size()) {
                    return broken("a batch releases a dependency that does not exist");
                }
            }
        }
        for (const Dependency& d : plan_.dependencies) {
            if (d.resource >= graph_.resources.size() || d.src_queue >= plan_.topology.queues.size() ||
                d.dst_queue >= plan_.topology.queues.size()) {
                return broken("a dependency points outside the resources or queues");
            }
        }
        if (next != plan_.passes.size() || plan_.placements.size() != graph_.resources.size() ||
            plan_.first_exit_barrier + plan_.exit_barrier_count > plan_.dependencies.size()) {
            return broken("the batches do not hold all passes, or the placements not all resources");
        }
        return true;
    }

    void placements() {
        for (std::uint32_t r = 0; r < plan_.placements.size(); ++r) {
            const Placement& p = plan_.placements[r];
            if (p.kind == PlacementKind::heap &&
                (p.heap >= plan_.heaps.size() || p.offset_bytes + p.size_bytes > plan_.heaps[p.heap].size_bytes)) {
                report(ViolationCode::memory_overlap, none, none, r, resource_name(r) + " lies outside its heap");
            }
        }
    }

    [[nodiscard]] bool share_bytes(std::uint32_t a, std::uint32_t b) const {
        const Placement& pa = plan_.placements[a];
        const Placement& pb = plan_.placements[b];
        return pa.kind == PlacementKind::heap && pb.kind == PlacementKind::heap && pa.heap == pb.heap &&
               pa.offset_bytes < pb.offset_bytes + pb.size_bytes && pb.offset_bytes < pa.offset_bytes + pa.size_bytes;
    }

    void make_atoms() {
        atoms_.resize(graph_.resources.size());
        aliases_.resize(graph_.resources.size());
        events_of_.resize(graph_.resources.size());
        for (std::uint32_t r = 0; r < graph_.resources.size(); ++r) {
            const ResourceDesc& resource = graph_.resources[r];
            std::vector<std::uint64_t> cuts_a;
            std::vector<std::uint64_t> cuts_b;
            const auto cut = [&](const Region& region) {
                cuts_a.insert(cuts_a.end(), {region.first_a, region.end_a});
                cuts_b.insert(cuts_b.end(), {region.first_b, region.end_b});
            };
            cut(region_of(resource, {}, {}));
            for (const AccessDesc& access : graph_.accesses) {
                if (access.resource == r) {
                    cut(region_of(resource, access.image_range, access.buffer_range));
                }
            }
            for (std::vector<std::uint64_t>* cuts : {&cuts_a, &cuts_b}) {
                std::sort(cuts->begin(), cuts->end());
                cuts->erase(std::unique(cuts->begin(), cuts->end()), cuts->end());
            }
            Atom atom;
            if (resource.import != none) {
                const ImportDesc& import = graph_.imports[resource.import];
                atom.layout = import.initial_layout;
                atom.defined =
                    resource.kind == ResourceKind::buffer || import.initial_layout != VK_IMAGE_LAYOUT_UNDEFINED;
                atom.owner = import.initial_family;
                if (import.initial_family != VK_QUEUE_FAMILY_IGNORED) {
                    atom.released = true; // to whichever family the host released it; its half is the host's
                }
            } else if (resource.lifetime == ResourceLifetime::history) {
                atom.layout = plan_.placements[r].resting_layout;
                atom.defined = true;
            }
            for (std::size_t a = 0; a + 1 < cuts_a.size(); ++a) {
                for (std::size_t b = 0; b + 1 < cuts_b.size(); ++b) {
                    atom.region = {cuts_a[a], cuts_a[a + 1], cuts_b[b], cuts_b[b + 1]};
                    atoms_[r].push_back(atom);
                }
            }
            if (resource.import != none) {
                add_host_event(r, graph_.imports[resource.import]);
            }
            for (std::uint32_t other = 0; other < graph_.resources.size(); ++other) {
                if (other != r && share_bytes(r, other)) {
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
        struct Effect {
            VkPipelineStageFlags2 src, dst;
            VkAccessFlags2 src_access, dst_access;
            const Dependency* d;
            bool transition;
        };
        std::vector<Effect> effects;
        for (const Dependency* d : dependencies) {
            const bool release_half = is_release && d->transfers_ownership && d->consumer != none;
            const bool acquire_half = !is_release && d->transfers_ownership;
            const bool crosses = d->src_queue != d->dst_queue && !is_release;
            const bool transition = d->old_layout != d->new_layout && !release_half;
            Effect effect{d->src_stages, d->dst_stages, d->src_access, d->dst_access, d, transition};
            if (crosses) {
                effect.src = d->local_stages;
                effect.src_access = d->local_access;
                if (transition || acquire_half) {
                    effect.src = all_commands; // chained to the semaphore wait
                } else if (effect.src == 0) {
                    continue; // the semaphore is all there is
                }
            }
            if (release_half) {
                effect.dst = 0;
                effect.dst_access = 0;
            }
            check_stages(queue, effect.src | effect.dst, before_pass, d->resource);
            effects.push_back(effect);
        }
        // Transitions are ordered after what their source scope names, before the reaches grow.
        for (const Effect& effect : effects) {
            ownership(*effect.d, is_release, before_pass);
            if (effect.transition) {
                transition(*effect.d, queue, effect.src, before_pass);
            }
        }
        const std::size_t count = events_.size();
        for (std::size_t e = 0; e < count; ++e) {
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
                // Memory: the barrier's own range, or bytes that its resource took over (the executor adds a global
                // memory barrier there).
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
                    retire(e);
                }
            }
            std::erase_if(events_of_[event.resource], [&](std::uint32_t e) { return retired(e); });
        }
        events_of_[event.resource].push_back(static_cast<std::uint32_t>(events_.size()));
        events_.push_back(std::move(event));
    }
    void retire(std::size_t e) { events_[e].reach.clear(); }
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
        std::uint8_t needs = 0;
        if (desc.kind != PassKind::host && desc.kind != PassKind::transfer) {
            needs = desc.kind == PassKind::graphics ? std::uint8_t{can_graphics} : std::uint8_t{can_compute};
        }
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
            const bool touched = std::any_of(events_of_[r].begin(), events_of_[r].end(),
                                             [&](std::uint32_t e) { return e >= host_events_; });
            for (const Atom& atom : atoms_[r]) {
                if (touched && resource.kind == ResourceKind::image && wanted != VK_IMAGE_LAYOUT_UNDEFINED &&
                    atom.layout != wanted) {
                    report(ViolationCode::exit_state, none, none, r,
                           resource_name(r) + " is not left in the layout that was agreed");
                    break;
                }
            }
        }
    }

    void check_exit_visibility(std::uint32_t r, std::uint32_t e, const ImportDesc& import) {
        const Event& event = events_[e];
        if (!event.writes || import.final_stages == 0 || e < host_events_) {
            return;
        }
        const bool visible = std::any_of(event.reach.begin(), event.reach.end(), [&](const Reach& reach) {
            return event.available && covers_stages(reach.visible_stages, import.final_stages) &&
                   covers_access(reach.visible_access, import.final_access);
        });
        if (!visible) {
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

std::string_view name_of(ViolationCode code) {
    switch (code) {
    case ViolationCode::malformed: return "malformed";
    case ViolationCode::race: return "race";
    case ViolationCode::not_visible: return "not visible";
    case ViolationCode::wrong_layout: return "wrong layout";
    case ViolationCode::undefined_content: return "undefined content";
    case ViolationCode::ownership: return "ownership";
    case ViolationCode::queue_cannot: return "queue cannot";
    case ViolationCode::never_signalled: return "never signalled";
    case ViolationCode::memory_overlap: return "memory overlap";
    case ViolationCode::exit_state: return "exit state";
    }
    return "";
}

std::vector<Violation> verify(const GraphDesc& graph, const Plan& plan) {
    return Verifier(graph, plan).run();
}

} // namespace tyndall::rg
