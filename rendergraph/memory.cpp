// Placing transients in memory, shared where the partial order allows it.
// In: the schedule's partial order, sizes and alignments. Out: heap and offset of each. Invariant: resources whose
// bytes overlap have all accesses of one before all accesses of the other. Size-descending, best-fitting gap.
// O(resources^2).
#include <algorithm>
#include <span>
#include <tuple>

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

/// When resources are used, by resource and queue, in numbers of passes of that queue.
class Lifetimes {
public:
    Lifetimes(const Schedule& schedule, std::size_t resources)
        : schedule_(schedule), queues_(schedule.queue_count), ordered_before_(resources * queues_, 0),
          last_end_(resources * queues_, 0) {}

    /// O(uses of the resource x queues).
    void add(std::uint32_t resource) {
        std::uint32_t* before = ordered_before_.data() + resource * queues_;
        std::uint32_t* end = last_end_.data() + resource * queues_;
        std::fill_n(before, queues_, none);
        for (std::uint32_t i = schedule_.first_use[resource]; i < schedule_.first_use[resource + 1]; ++i) {
            const Use& use = schedule_.uses[i];
            const std::uint32_t position = schedule_.position[use.slot];
            for (std::uint32_t q = 0; q < queues_; ++q) {
                before[q] = std::min(before[q], q == use.queue ? position : clock(use.slot)[q]);
            }
            end[use.queue] = std::max(end[use.queue], position + 1);
        }
    }

    /// Every use of `a` happens before every use of `b`. O(queues).
    [[nodiscard]] bool entirely_before(std::uint32_t a, std::uint32_t b) const {
        for (std::size_t q = 0; q < queues_; ++q) {
            if (last_end_[a * queues_ + q] > ordered_before_[b * queues_ + q]) {
                return false;
            }
        }
        return true;
    }

    /// The most bytes of `placed` that are live at one slot: used before or at it, and after or at it.
    /// O((uses + resources log slots) x queues).
    [[nodiscard]] VkDeviceSize largest_live_set(std::span<const std::uint32_t> placed,
                                                std::span<const Placement> placements) const {
        std::vector<std::vector<std::uint32_t>> slots(queues_); // by queue, in order
        for (std::uint32_t slot = 0; slot < schedule_.order.size(); ++slot) {
            slots[schedule_.queue[slot]].push_back(slot);
        }
        VkDeviceSize largest = 0;
        std::vector<VkDeviceSize> begins; // by position: bytes that become live there
        std::vector<VkDeviceSize> ends;   // and that were live up to there
        for (std::uint32_t q = 0; q < queues_; ++q) {
            begins.assign(slots[q].size() + 1, 0);
            ends.assign(slots[q].size() + 1, 0);
            for (const std::uint32_t resource : placed) {
                const auto [begin, end] = live_positions(resource, q, slots[q]);
                if (begin < end) {
                    begins[begin] += placements[resource].size_bytes;
                    ends[end] += placements[resource].size_bytes;
                }
            }
            VkDeviceSize live = 0;
            for (std::size_t position = 0; position < slots[q].size(); ++position) {
                live += begins[position];
                live -= ends[position];
                largest = std::max(largest, live);
            }
        }
        return largest;
    }

private:
    struct Positions {
        std::uint32_t begin;
        std::uint32_t end;
    };
    /// Clocks only grow along a queue, so the slots where a resource is live are neighbours.
    [[nodiscard]] Positions live_positions(std::uint32_t resource, std::uint32_t queue,
                                           const std::vector<std::uint32_t>& slots) const {
        Positions live{none, 0};
        for (std::uint32_t i = schedule_.first_use[resource]; i < schedule_.first_use[resource + 1]; ++i) {
            const Use& use = schedule_.uses[i];
            live.end = std::max(live.end, clock(use.slot)[queue]);
            const std::uint32_t position = schedule_.position[use.slot];
            const auto begin = std::partition_point(
                slots.begin(), slots.end(), [&](std::uint32_t slot) { return clock(slot)[use.queue] <= position; });
            live.begin = std::min(live.begin, static_cast<std::uint32_t>(begin - slots.begin()));
        }
        return live;
    }
    [[nodiscard]] const std::uint32_t* clock(std::uint32_t slot) const {
        return schedule_.clocks.data() + std::size_t{slot} * queues_;
    }

    const Schedule& schedule_;
    std::size_t queues_;
    std::vector<std::uint32_t> ordered_before_; ///< so many passes of the queue happen before every use
    std::vector<std::uint32_t> last_end_;       ///< position after the last use on the queue, 0 if there is none
};

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

/// Calls `f(a, b)` once for every two resources with bytes in common; sorts `placed` by heap and offset.
/// O(resources log resources + calls).
template <typename F>
void for_each_overlap(std::vector<std::uint32_t>& placed, std::span<const Placement> placements, F&& f) {
    std::sort(placed.begin(), placed.end(), [&](std::uint32_t a, std::uint32_t b) {
        const Placement& left = placements[a];
        const Placement& right = placements[b];
        return std::tie(left.heap, left.offset_bytes, a) < std::tie(right.heap, right.offset_bytes, b);
    });
    for (std::size_t i = 0; i < placed.size(); ++i) {
        const Placement& low = placements[placed[i]];
        const VkDeviceSize end = low.offset_bytes + low.size_bytes;
        for (std::size_t k = i + 1; k < placed.size(); ++k) {
            const Placement& high = placements[placed[k]];
            if (high.heap != low.heap || high.offset_bytes >= end) {
                break;
            }
            f(placed[i], placed[k]);
        }
    }
}

} // namespace

Memory place(const GraphDesc& graph, const QueueTopology& topology, const Schedule& schedule,
             const MemoryRequirements& requirements, bool aliasing) {
    const auto count = static_cast<std::uint32_t>(graph.resources.size());
    Memory memory;
    memory.placements.resize(count);
    memory.takes_over.resize(count);
    Lifetimes lives(schedule, count);
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
            lives.add(resource);
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
            const bool ordered =
                aliasing && (lives.entirely_before(other, resource) || lives.entirely_before(resource, other));
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
    for_each_overlap(placed, memory.placements, [&](std::uint32_t a, std::uint32_t b) {
        if (lives.entirely_before(a, b)) {
            memory.takes_over[b].push_back(a);
        } else if (lives.entirely_before(b, a)) {
            memory.takes_over[a].push_back(b);
        }
    });
    for (const std::uint32_t resource : placed) {
        std::vector<std::uint32_t>& before = memory.takes_over[resource];
        std::sort(before.begin(), before.end());
        memory.placements[resource].shares_with = before.empty() ? none : before.front();
    }
    memory.largest_live_set_bytes = lives.largest_live_set(placed, memory.placements);
    return memory;
}

} // namespace stages
} // namespace tyndall::rg
