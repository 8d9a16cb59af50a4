// Placing transients in memory, shared where the partial order allows it.
// In: the schedule's partial order, sizes and alignments. Out: heap and offset of each. Invariant: resources whose
// bytes overlap have all accesses of one before all accesses of the other. Size-descending, best-fitting gap.
// O(resources^2).
#include <algorithm>

#include "rendergraph/stages.hpp"

namespace tyndall::rg {

MemoryRequirements estimate_memory(const GraphDesc& graph) {
    constexpr VkDeviceSize buffer_alignment = 256;
    constexpr VkDeviceSize image_alignment = 4096;
    const auto up = [](VkDeviceSize size, VkDeviceSize alignment) {
        return (size + alignment - 1) / alignment * alignment;
    };
    MemoryRequirements requirements;
    for (const ResourceDesc& resource : graph.resources) {
        MemoryRequirement& out = requirements.of_resource.emplace_back();
        if (resource.kind == ResourceKind::buffer) {
            out = {up(resource.buffer.size_bytes, buffer_alignment), buffer_alignment, ~0U};
            continue;
        }
        const ImageDesc& image = resource.image;
        VkDeviceSize texels = 0;
        for (std::uint32_t mip = 0; mip < image.mips; ++mip) {
            const auto at = [mip](std::uint32_t n) { return VkDeviceSize{std::max(n >> mip, 1U)}; };
            texels += at(image.extent.width) * at(image.extent.height) * at(image.extent.depth);
        }
        const VkDeviceSize bytes = texels * image.layers * format_texel_bytes(image.format) * image.samples;
        out = {up(bytes, image_alignment), image_alignment, ~0U};
    }
    return requirements;
}

namespace stages {
namespace {

/// When a resource is used: its first and last slot on each queue.
struct Lifetime {
    std::vector<std::uint32_t> first; ///< by queue, `none` if the queue does not use it
    std::vector<std::uint32_t> last;
};

Lifetime lifetime_of(const Schedule& schedule, std::uint32_t resource) {
    Lifetime life{std::vector<std::uint32_t>(schedule.queue_count, none),
                  std::vector<std::uint32_t>(schedule.queue_count, none)};
    for (std::uint32_t i = schedule.first_use[resource]; i < schedule.first_use[resource + 1]; ++i) {
        const Use& use = schedule.uses[i];
        if (life.first[use.queue] == none) {
            life.first[use.queue] = use.slot;
        }
        life.last[use.queue] = use.slot;
    }
    return life;
}

/// Every use of `a` happens before every use of `b`: the last of each queue before the first of each queue is enough.
bool entirely_before(const Schedule& schedule, const Lifetime& a, const Lifetime& b) {
    for (const std::uint32_t last : a.last) {
        for (const std::uint32_t first : b.first) {
            if (last != none && first != none && !schedule.happens_before(last, first)) {
                return false;
            }
        }
    }
    return true;
}

/// Some use of the resource is before or at `slot`, and some after or at it.
bool contains(const Schedule& schedule, const Lifetime& life, std::uint32_t slot) {
    bool before = false;
    bool after = false;
    for (std::uint32_t q = 0; q < schedule.queue_count; ++q) {
        before = before ||
                 (life.first[q] != none && (life.first[q] == slot || schedule.happens_before(life.first[q], slot)));
        after =
            after || (life.last[q] != none && (life.last[q] == slot || schedule.happens_before(slot, life.last[q])));
    }
    return before && after;
}

VkDeviceSize align_up(VkDeviceSize value, VkDeviceSize alignment) {
    return (value + alignment - 1) / alignment * alignment;
}

struct Block {
    VkDeviceSize begin;
    VkDeviceSize end;
};

/// Offset of the smallest gap between `blocked` blocks that fits, else the first free offset behind them all.
VkDeviceSize best_gap(std::vector<Block>& blocked, VkDeviceSize size, VkDeviceSize alignment, VkDeviceSize heap_size) {
    std::sort(blocked.begin(), blocked.end(), [](const Block& a, const Block& b) { return a.begin < b.begin; });
    VkDeviceSize cursor = 0;
    VkDeviceSize best = 0;
    VkDeviceSize best_size = ~VkDeviceSize{0};
    for (const Block& block : blocked) {
        const VkDeviceSize offset = align_up(cursor, alignment);
        if (offset + size <= block.begin && block.begin - cursor < best_size) {
            best = offset;
            best_size = block.begin - cursor;
        }
        cursor = std::max(cursor, block.end);
    }
    const VkDeviceSize offset = align_up(cursor, alignment);
    const bool fits_at_end = offset + size <= heap_size && heap_size - cursor < best_size;
    return best_size == ~VkDeviceSize{0} || fits_at_end ? offset : best;
}

} // namespace

Memory place(const GraphDesc& graph, const QueueTopology& topology, const Schedule& schedule,
             const MemoryRequirements& requirements, bool aliasing) {
    const auto count = static_cast<std::uint32_t>(graph.resources.size());
    Memory memory;
    memory.placements.resize(count);
    memory.takes_over.resize(count);
    std::vector<Lifetime> lives(count);
    std::vector<std::uint32_t> candidates;
    for (std::uint32_t resource = 0; resource < count; ++resource) {
        const ResourceDesc& desc = graph.resources[resource];
        Placement& placement = memory.placements[resource];
        const std::uint32_t first = schedule.first_use[resource];
        const std::uint32_t end = schedule.first_use[resource + 1];
        const bool paired = desc.has_history || desc.history_of != none;
        if ((first == end && !paired) || desc.lifetime == ResourceLifetime::imported) {
            continue;
        }
        placement.size_bytes = requirements.of_resource[resource].size_bytes;
        placement.image_usage = desc.image.extra_usage;
        placement.buffer_usage = desc.buffer.extra_usage;
        placement.concurrent = schedule.concurrent[resource];
        for (std::uint32_t i = first; i < end; ++i) {
            const std::uint32_t family = topology.queues[schedule.uses[i].queue].family;
            if (std::find(placement.families.begin(), placement.families.end(), family) == placement.families.end()) {
                placement.families.push_back(family);
            }
        }
        std::sort(placement.families.begin(), placement.families.end());
        if (paired) {
            placement.kind = PlacementKind::history;
        } else {
            placement.kind = PlacementKind::heap;
            lives[resource] = lifetime_of(schedule, resource);
            candidates.push_back(resource);
        }
    }
    for (const AccessDesc& access : graph.accesses) {
        if (schedule.slot_of[access.pass] != none) {
            const AccessInfo& info = access_info(access.access);
            memory.placements[access.resource].image_usage |= info.image_usage;
            memory.placements[access.resource].buffer_usage |= info.buffer_usage;
        }
    }
    // The two copies of a history swap roles, so both can do what either must.
    for (std::uint32_t resource = 0; resource < count; ++resource) {
        if (const std::uint32_t current = graph.resources[resource].history_of; current != none) {
            Placement& a = memory.placements[resource];
            Placement& b = memory.placements[current];
            a.image_usage = b.image_usage = a.image_usage | b.image_usage;
            a.buffer_usage = b.buffer_usage = a.buffer_usage | b.buffer_usage;
            a.concurrent = b.concurrent = a.concurrent || b.concurrent;
            a.families.insert(a.families.end(), b.families.begin(), b.families.end());
            std::sort(a.families.begin(), a.families.end());
            a.families.erase(std::unique(a.families.begin(), a.families.end()), a.families.end());
            b.families = a.families;
            a.concurrent = b.concurrent = a.concurrent || a.families.size() > 1; // nobody releases it between frames
        }
    }

    std::stable_sort(candidates.begin(), candidates.end(), [&](std::uint32_t a, std::uint32_t b) {
        return requirements.of_resource[a].size_bytes > requirements.of_resource[b].size_bytes;
    });
    std::vector<std::uint32_t> placed;
    std::vector<Block> blocked;
    for (const std::uint32_t resource : candidates) {
        const MemoryRequirement& need = requirements.of_resource[resource];
        // Buffers and images never share a page of bufferImageGranularity: both keep to whole pages.
        const VkDeviceSize alignment = std::max(need.alignment, requirements.buffer_image_granularity);
        const VkDeviceSize size = align_up(need.size_bytes, requirements.buffer_image_granularity);
        std::uint32_t heap = 0;
        while (heap < memory.heaps.size() && memory.heaps[heap].memory_type_bits != need.memory_type_bits) {
            ++heap;
        }
        if (heap == memory.heaps.size()) {
            memory.heaps.push_back({need.memory_type_bits, 0});
        }
        blocked.clear();
        for (const std::uint32_t other : placed) {
            const Placement& placement = memory.placements[other];
            const bool ordered = aliasing && (entirely_before(schedule, lives[other], lives[resource]) ||
                                              entirely_before(schedule, lives[resource], lives[other]));
            if (placement.heap == heap && !ordered) {
                blocked.push_back({placement.offset_bytes, placement.offset_bytes + placement.size_bytes});
            }
        }
        Placement& placement = memory.placements[resource];
        placement.heap = heap;
        placement.size_bytes = size;
        placement.offset_bytes = best_gap(blocked, size, alignment, memory.heaps[heap].size_bytes);
        memory.heaps[heap].size_bytes = std::max(memory.heaps[heap].size_bytes, placement.offset_bytes + size);
        memory.unaliased_bytes += size;
        placed.push_back(resource);
    }
    std::sort(placed.begin(), placed.end());
    for (const std::uint32_t b : placed) {
        Placement& mine = memory.placements[b];
        for (const std::uint32_t a : placed) {
            const Placement& other = memory.placements[a];
            const bool overlap = a != b && mine.heap == other.heap &&
                                 other.offset_bytes < mine.offset_bytes + mine.size_bytes &&
                                 mine.offset_bytes < other.offset_bytes + other.size_bytes;
            if (overlap && entirely_before(schedule, lives[a], lives[b])) {
                memory.takes_over[b].push_back(a);
            }
        }
        if (!memory.takes_over[b].empty()) {
            mine.shares_with = memory.takes_over[b].front();
        }
    }
    for (std::uint32_t slot = 0; slot < schedule.order.size(); ++slot) {
        VkDeviceSize live = 0;
        for (const std::uint32_t resource : placed) {
            live += contains(schedule, lives[resource], slot) ? memory.placements[resource].size_bytes : 0;
        }
        memory.largest_live_set_bytes = std::max(memory.largest_live_set_bytes, live);
    }
    return memory;
}

} // namespace stages
} // namespace tyndall::rg
