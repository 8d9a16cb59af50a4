#include "rendergraph/verify_state.hpp"

#include <algorithm>
#include <string_view>

namespace tyndall::rg::checker {
namespace {

void sort_unique(std::vector<std::uint64_t>& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

std::size_t at_or_after(const std::vector<std::uint64_t>& cuts, std::uint64_t value) {
    return static_cast<std::size_t>(std::lower_bound(cuts.begin(), cuts.end(), value) - cuts.begin());
}
std::size_t at_or_before(const std::vector<std::uint64_t>& cuts, std::uint64_t value) {
    return static_cast<std::size_t>(std::upper_bound(cuts.begin(), cuts.end(), value) - cuts.begin()) - 1;
}

/// Accesses by resource: those of `r` are indices [first[r], first[r + 1]) of `accesses`.
struct AccessesOf {
    std::vector<std::uint32_t> first;
    std::vector<std::uint32_t> accesses;
    explicit AccessesOf(const GraphDesc& graph)
        : first(graph.resources.size() + 1, 0), accesses(graph.accesses.size()) {
        for (const AccessDesc& access : graph.accesses) {
            ++first[access.resource + 1];
        }
        for (std::size_t r = 0; r < graph.resources.size(); ++r) {
            first[r + 1] += first[r];
        }
        std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
        for (std::uint32_t i = 0; i < graph.accesses.size(); ++i) {
            accesses[next[graph.accesses[i].resource]++] = i;
        }
    }
    [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t resource) const {
        return std::span(accesses).subspan(first[resource], first[resource + 1] - first[resource]);
    }
};

} // namespace

AtomRange atoms_inside(const Object& object, const Region& region) {
    AtomRange range{at_or_after(object.cuts_a, region.first_a), at_or_before(object.cuts_a, region.end_a),
                    at_or_after(object.cuts_b, region.first_b), at_or_before(object.cuts_b, region.end_b)};
    range.end_a = std::max(range.first_a, range.end_a);
    range.end_b = std::max(range.first_b, range.end_b);
    return range;
}

AtomRange atoms_meeting(const Object& object, const Region& region) {
    return {at_or_before(object.cuts_a, region.first_a), at_or_after(object.cuts_a, region.end_a),
            at_or_before(object.cuts_b, region.first_b), at_or_after(object.cuts_b, region.end_b)};
}

Object Memory::make_object(const GraphDesc& graph, const Plan& plan, std::uint32_t r,
                           std::span<const std::uint32_t> accesses) {
    const ResourceDesc& resource = graph.resources[r];
    Object object;
    object.resource = r;
    object.frame = frame_;
    object.exclusive = !plan.placements[r].concurrent && !resource.concurrent;
    const Region whole = region_of(resource, {}, {});
    object.cuts_a = {whole.first_a, whole.end_a};
    object.cuts_b = {whole.first_b, whole.end_b};
    for (const std::uint32_t i : accesses) {
        const AccessDesc& access = graph.accesses[i];
        const Region region = region_of(resource, access.image_range, access.buffer_range);
        if (region.first_a != whole.first_a || region.end_a != whole.end_a) {
            object.cuts_a.insert(object.cuts_a.end(), {region.first_a, region.end_a});
        }
        if (region.first_b != whole.first_b || region.end_b != whole.end_b) {
            object.cuts_b.insert(object.cuts_b.end(), {region.first_b, region.end_b});
        }
        if (is_write(access.direction) && of_kept_form(graph, plan, access.pass)) {
            object.writers.push_back(i);
        }
    }
    std::stable_sort(object.writers.begin(), object.writers.end(), [&](std::uint32_t a, std::uint32_t b) {
        return graph.accesses[a].version < graph.accesses[b].version;
    });
    sort_unique(object.cuts_a);
    sort_unique(object.cuts_b);
    Atom atom;
    if (resource.import != none) {
        const ImportDesc& import = graph.imports[resource.import];
        atom.layout = import.initial_layout;
        atom.defined = resource.kind == ResourceKind::buffer || import.initial_layout != VK_IMAGE_LAYOUT_UNDEFINED;
        atom.owner = import.initial_family;
        atom.released = import.initial_family != VK_QUEUE_FAMILY_IGNORED; // to us; that half is the host's
        object.awaits_host = import.waits_semaphore;
    } else if (resource.lifetime == ResourceLifetime::history) {
        atom.layout = plan.placements[r].resting_layout; // the executor prepares it where it is another
        atom.defined = true;                             // or known to be worthless: PassContext::history_valid
    }
    object.atoms.reserve((object.cuts_a.size() - 1) * (object.cuts_b.size() - 1));
    for (std::size_t a = 0; a + 1 < object.cuts_a.size(); ++a) {
        for (std::size_t b = 0; b + 1 < object.cuts_b.size(); ++b) {
            atom.region = {object.cuts_a[a], object.cuts_a[a + 1], object.cuts_b[b], object.cuts_b[b + 1]};
            object.atoms.push_back(atom);
        }
    }
    const Placement& placement = plan.placements[r];
    if (placement.kind == PlacementKind::heap) {
        object.heap = placement.heap;
        object.first_byte = placement.offset_bytes;
        object.end_byte = placement.offset_bytes + placement.size_bytes;
    } else {
        object.holds_bytes = true;
    }
    return object;
}

void Memory::begin_frame(const GraphDesc& graph, const Plan& plan, Order& order) {
    const std::uint32_t host_command = order.begin_command(order.host_queue());
    const std::vector<std::uint32_t> last = std::move(current_);
    current_.clear();
    ++frame_;
    heaps_.resize(std::max(heaps_.size(), plan.heaps.size()));
    const AccessesOf by_resource(graph);
    objects_.reserve(objects_.size() + graph.resources.size());
    for (std::uint32_t r = 0; r < graph.resources.size(); ++r) {
        current_.push_back(static_cast<std::uint32_t>(objects_.size()));
        objects_.push_back(make_object(graph, plan, r, by_resource.of(r)));
        const std::uint32_t import = graph.resources[r].import;
        if (import == none || graph.imports[import].initial_stages == 0) {
            continue;
        }
        // The host's last use, submitted before the frame.
        Event event;
        event.at = {order.host_queue(), host_command, source_stages(graph.imports[import].initial_stages), false};
        event.written = graph.imports[import].initial_access & (writing | VK_ACCESS_2_MEMORY_WRITE_BIT);
        for (Atom& atom : objects_.back().atoms) {
            if (event.written != 0) {
                atom.last_write = event;
                atom.written = true;
            } else {
                atom.reads.push_back(event);
            }
        }
    }
    if (last_graph_ != nullptr) {
        carry_over(graph, plan, last);
    }
    last_graph_ = &graph;
    last_plan_ = &plan;
}

/// An import's memory is the same in each frame, and the copies of a history swap their roles.
void Memory::carry_over(const GraphDesc& graph, const Plan& plan, const std::vector<std::uint32_t>& last) {
    const GraphDesc& last_graph = *last_graph_;
    std::map<std::string_view, std::uint32_t> by_name;
    for (std::uint32_t r = 0; r < last_graph.resources.size(); ++r) {
        by_name.emplace(last_graph.resources[r].name, last[r]);
    }
    const auto follow = [&](std::uint32_t from, std::uint32_t to) {
        const auto before = by_name.find(graph.resources[from].name);
        if (before != by_name.end()) {
            of_resource(to).displaced.push_back(before->second);
        }
    };
    for (std::uint32_t r = 0; r < graph.resources.size(); ++r) {
        const ResourceDesc& resource = graph.resources[r];
        if (resource.import != none) {
            follow(r, r);
        } else if (resource.history_of != none) {
            follow(resource.history_of, r);
            follow(r, resource.history_of);
            const auto before = by_name.find(graph.resources[resource.history_of].name);
            if (before == by_name.end()) {
                continue;
            }
            // Of other families, it would be another object, whose content is known to be worthless.
            const Object& old = objects_[before->second];
            if (last_plan_->placements[old.resource].families != plan.placements[r].families) {
                continue;
            }
            const std::vector<Atom>& left = old.atoms;
            const bool one_owner = std::all_of(
                left.begin(), left.end(), [&](const Atom& a) { return a.owner == left.front().owner && !a.released; });
            for (Atom& atom : of_resource(r).atoms) {
                // A mixture is nobody's, and nobody can acquire it.
                atom.owner = one_owner ? left.front().owner : VK_QUEUE_FAMILY_EXTERNAL;
            }
        }
    }
}

void Memory::cut(Heap& heap, VkDeviceSize at) {
    auto next = heap.upper_bound(at);
    if (next == heap.begin()) {
        return;
    }
    const auto it = std::prev(next);
    if (it->first < at && at < it->second.end) {
        heap.emplace_hint(next, at, it->second);
        it->second.end = at;
    }
}

std::vector<std::uint32_t> Memory::neighbours(const Object& object) {
    std::vector<std::uint32_t> found;
    if (object.heap == none) {
        return found;
    }
    Heap& heap = heaps_[object.heap];
    auto it = heap.upper_bound(object.first_byte);
    it = it == heap.begin() ? it : std::prev(it);
    for (; it != heap.end() && it->first < object.end_byte; ++it) {
        if (it->second.end > object.first_byte) {
            found.insert(found.end(), it->second.objects.begin(), it->second.objects.end());
        }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    std::erase_if(found, [&](std::uint32_t index) { return &objects_[index] == &object; });
    return found;
}

void Memory::add_to_heap(std::uint32_t index) {
    const Object& object = objects_[index];
    Heap& heap = heaps_[object.heap];
    cut(heap, object.first_byte);
    cut(heap, object.end_byte);
    VkDeviceSize at = object.first_byte;
    for (auto it = heap.lower_bound(at); at < object.end_byte; ++it) {
        const bool hole = it == heap.end() || it->first > at;
        if (hole) {
            const VkDeviceSize end = it == heap.end() ? object.end_byte : std::min(it->first, object.end_byte);
            it = heap.emplace_hint(it, at, Tenants{end, {}});
        }
        it->second.objects.push_back(index);
        at = it->second.end;
    }
}

void Memory::take_bytes(std::uint32_t resource) {
    Object& object = of_resource(resource);
    object.touched = true;
    if (object.holds_bytes) {
        return;
    }
    object.displaced = neighbours(object);
    object.holds_bytes = true;
    object.atoms_begun = 0;
    for (Atom& atom : object.atoms) {
        atom.begun = false;
    }
    for (const std::uint32_t other : object.displaced) {
        objects_[other].holds_bytes = objects_[other].heap == none;
        for (Atom& atom : objects_[other].atoms) {
            atom.defined = false;
            atom.layout = VK_IMAGE_LAYOUT_UNDEFINED;
        }
    }
    add_to_heap(current_[resource]);
}

void Memory::begin(Object& object, Atom& atom) {
    if (atom.begun) {
        return;
    }
    atom.begun = true;
    if (++object.atoms_begun < object.atoms.size()) {
        return;
    }
    object.displaced.clear();
    if (object.heap != none) {
        const auto index = static_cast<std::uint32_t>(&object - objects_.data());
        Heap& heap = heaps_[object.heap];
        heap.erase(heap.lower_bound(object.first_byte), heap.lower_bound(object.end_byte));
        heap.emplace(object.first_byte, Tenants{object.end_byte, {index}});
    }
}

} // namespace tyndall::rg::checker
