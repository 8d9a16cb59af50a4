// What the checker starts from: the plan's form (indices inside their tables, everything there once), and the parts of
// each resource in their first state. O(size of the plan, and accesses of each resource).
#include <algorithm>

#include "rendergraph/verify_types.hpp"

namespace tyndall::rg {
namespace checker {
namespace {

/// What is wrong with the plan's indices; empty when they can be trusted.
std::string index_mistake(const GraphDesc& graph, const Plan& plan) {
    std::vector<std::uint32_t> seen(graph.passes.size(), 0);
    for (const PlannedPass& planned : plan.passes) {
        if (planned.pass >= graph.passes.size() || planned.queue >= plan.topology.queues.size() ||
            planned.first_barrier + planned.barrier_count > plan.dependencies.size()) {
            return "a planned pass points outside the graph, the queues or the dependencies";
        }
        ++seen[planned.pass];
    }
    for (const CulledPass& culled : plan.culled_passes) {
        if (culled.pass >= graph.passes.size()) {
            return "a pass that is left out is not in the graph";
        }
        ++seen[culled.pass];
    }
    if (std::any_of(seen.begin(), seen.end(), [](std::uint32_t n) { return n != 1; })) {
        return "some pass is neither planned nor left out, or both, or twice";
    }
    std::uint32_t next = 0;
    for (const Batch& b : plan.batches) {
        if (b.first_pass != next || b.first_pass + b.pass_count > plan.passes.size() ||
            b.queue >= plan.topology.queues.size()) {
            return "the batches do not follow the passes";
        }
        next += b.pass_count;
        for (const std::uint32_t d : b.releases) {
            if (d >= plan.dependencies.size()) {
                return "a batch releases a dependency that does not exist";
            }
        }
    }
    for (const Dependency& d : plan.dependencies) {
        if (d.resource >= graph.resources.size() || d.src_queue >= plan.topology.queues.size() ||
            d.dst_queue >= plan.topology.queues.size()) {
            return "a dependency points outside the resources or queues";
        }
    }
    if (next != plan.passes.size() || plan.placements.size() != graph.resources.size() ||
        plan.first_exit_barrier + plan.exit_barrier_count > plan.dependencies.size()) {
        return "the batches do not hold all passes, or the placements not all resources";
    }
    return {};
}

} // namespace

std::vector<Violation> check_form(const GraphDesc& graph, const Plan& plan) {
    std::vector<Violation> found;
    if (std::string mistake = index_mistake(graph, plan); !mistake.empty()) {
        found.push_back({.code = ViolationCode::malformed, .message = std::move(mistake)});
        return found;
    }
    for (std::uint32_t r = 0; r < plan.placements.size(); ++r) {
        const Placement& p = plan.placements[r];
        if (p.kind == PlacementKind::heap &&
            (p.heap >= plan.heaps.size() || p.offset_bytes + p.size_bytes > plan.heaps[p.heap].size_bytes)) {
            found.push_back({.code = ViolationCode::memory_overlap,
                             .resource = r,
                             .message = "'" + graph.resources[r].name + "' lies outside its heap"});
        }
    }
    return found;
}

std::optional<Effect> effect_of(const Dependency& d, bool is_release) {
    const bool release_half = is_release && d.transfers_ownership && d.consumer != none;
    const bool acquire_half = !is_release && d.transfers_ownership;
    const bool transition = d.old_layout != d.new_layout && !release_half;
    Effect effect{d.src_stages, d.dst_stages, d.src_access, d.dst_access, &d, transition};
    if (d.src_queue != d.dst_queue && !is_release) {
        effect.src = d.local_stages;
        effect.src_access = d.local_access;
        if (transition || acquire_half) {
            effect.src = all_commands; // chained to the semaphore wait
        } else if (effect.src == 0) {
            return std::nullopt;
        }
    }
    if (release_half) {
        effect.dst = 0;
        effect.dst_access = 0;
    }
    return effect;
}

bool visible_anywhere(const Event& event, VkPipelineStageFlags2 stages, VkAccessFlags2 access) {
    return event.available && std::any_of(event.reach.begin(), event.reach.end(), [&](const Reach& reach) {
               return covers_stages(reach.visible_stages, stages) && covers_access(reach.visible_access, access);
           });
}

bool share_bytes(const Plan& plan, std::uint32_t a, std::uint32_t b) {
    const Placement& pa = plan.placements[a];
    const Placement& pb = plan.placements[b];
    return pa.kind == PlacementKind::heap && pb.kind == PlacementKind::heap && pa.heap == pb.heap &&
           pa.offset_bytes < pb.offset_bytes + pb.size_bytes && pb.offset_bytes < pa.offset_bytes + pa.size_bytes;
}

std::vector<Atom> make_atoms(const GraphDesc& graph, const Plan& plan, std::uint32_t r) {
    const ResourceDesc& resource = graph.resources[r];
    std::vector<std::uint64_t> cuts_a;
    std::vector<std::uint64_t> cuts_b;
    const auto cut = [&](const Region& region) {
        cuts_a.insert(cuts_a.end(), {region.first_a, region.end_a});
        cuts_b.insert(cuts_b.end(), {region.first_b, region.end_b});
    };
    cut(region_of(resource, {}, {}));
    for (const AccessDesc& access : graph.accesses) {
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
        const ImportDesc& import = graph.imports[resource.import];
        atom.layout = import.initial_layout;
        atom.defined = resource.kind == ResourceKind::buffer || import.initial_layout != VK_IMAGE_LAYOUT_UNDEFINED;
        atom.owner = import.initial_family;
        atom.released = import.initial_family != VK_QUEUE_FAMILY_IGNORED; // to us; that half is the host's
    } else if (resource.lifetime == ResourceLifetime::history) {
        atom.layout = plan.placements[r].resting_layout;
        atom.defined = true;
    }
    std::vector<Atom> atoms;
    for (std::size_t a = 0; a + 1 < cuts_a.size(); ++a) {
        for (std::size_t b = 0; b + 1 < cuts_b.size(); ++b) {
            atom.region = {cuts_a[a], cuts_a[a + 1], cuts_b[b], cuts_b[b + 1]};
            atoms.push_back(atom);
        }
    }
    return atoms;
}

} // namespace checker

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

} // namespace tyndall::rg
