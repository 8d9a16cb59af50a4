// Placing transients in memory, shared where the partial order allows it.
// In: the schedule's partial order, sizes and alignments. Out: heap and offset of each. Invariant: resources whose
// bytes overlap have all accesses of one before all accesses of the other.
// O(uses x log + conflicts x log): see memory_types.hpp.
#include <algorithm>
#include <numeric>
#include <optional>

#include "rendergraph/formats.hpp"
#include "rendergraph/limits.hpp"
#include "rendergraph/memory_types.hpp"
#include "rendergraph/radix_sort.hpp"

namespace tyndall::rg {

MemoryRequirements estimate_memory(const GraphDesc& graph) {
    constexpr VkDeviceSize buffer_alignment = 256;
    constexpr VkDeviceSize image_alignment = 4096;
    static constexpr VkDeviceSize too_many_bytes = 2 * most_bytes;
    constexpr std::uint32_t most_mips = 32;
    // What is more than all transients may have stays so, without going on to where numbers end.
    const auto up = [](VkDeviceSize size, VkDeviceSize alignment) {
        return (std::min(size, too_many_bytes) + alignment - 1) / alignment * alignment;
    };
    const auto times = [](VkDeviceSize a, VkDeviceSize b) {
        if ((a | b) >> 32U == 0) { // their product is a number; a division is slow
            return std::min(a * b, too_many_bytes);
        }
        return b != 0 && a > too_many_bytes / b ? too_many_bytes : a * b;
    };
    MemoryRequirements requirements;
    requirements.of_resource.reserve(graph.resources.size());
    for (const ResourceDesc& resource : graph.resources) {
        MemoryRequirement& out = requirements.of_resource.emplace_back();
        if (resource.kind == ResourceKind::buffer) {
            out = {up(resource.buffer.size_bytes, buffer_alignment), buffer_alignment, ~0U};
            continue;
        }
        const ImageDesc& image = resource.image;
        const FormatBlock block = format_block(image.format);
        VkDeviceSize blocks = 0;
        for (std::uint32_t mip = 0; mip < std::min(image.mips, most_mips); ++mip) {
            const auto at = [mip](std::uint32_t n) { return VkDeviceSize{std::max(n >> mip, 1U)}; };
            const VkDeviceSize columns = (at(image.extent.width) + block.width - 1) / block.width;
            const VkDeviceSize rows = (at(image.extent.height) + block.height - 1) / block.height;
            blocks = std::min(blocks + times(times(columns, rows), at(image.extent.depth)), too_many_bytes);
        }
        const VkDeviceSize bytes = times(times(times(blocks, image.layers), block.bytes), image.samples);
        out = {up(bytes, image_alignment), image_alignment, ~0U};
    }
    return requirements;
}

namespace stages {

Diagnostics validate_memory(const GraphDesc& graph, const MemoryRequirements& memory) {
    Diagnostics errors;
    const auto bad = [&](const ResourceDesc& resource, const std::string& what) {
        errors.push_back({.code = DiagnosticCode::bad_description,
                          .resource = resource.name,
                          .message = "Resource '" + resource.name + "' " + what,
                          .where = resource.where,
                          .other_where = resource.where});
    };
    std::vector<bool> touched; // made for the first that has no size
    const auto is_touched = [&](std::size_t resource) {
        if (touched.empty()) {
            touched.resize(graph.resources.size());
            for (const AccessDesc& access : graph.accesses) {
                if (access.resource < touched.size()) { // a foreign handle's lies outside
                    touched[access.resource] = true;
                }
            }
        }
        return touched[resource];
    };
    VkDeviceSize total = 0;
    for (std::size_t r = 0; r < graph.resources.size(); ++r) {
        const ResourceDesc& resource = graph.resources[r];
        if (resource.lifetime == ResourceLifetime::imported) {
            continue;
        }
        const VkDeviceSize size = r < memory.of_resource.size() ? memory.of_resource[r].size_bytes : 0;
        if (size == 0) {
            // What no pass touches has no usage, and a driver then no answer; it is never made.
            if (!is_touched(r)) {
                continue;
            }
            bad(resource, "has a format of which no size is known; ask the driver what memory it needs, or choose "
                          "another format");
        } else if (total <= most_bytes) {
            total += std::min(size, most_bytes + 1);
            if (total > most_bytes) {
                bad(resource, "is more than the frame can have with what is declared before it, " +
                                  std::to_string(most_bytes) + " bytes; make it smaller");
            }
        }
    }
    return errors;
}

namespace {

/// The heap of a memory type; made when it is new.
std::uint32_t heap_of(std::vector<Heap>& heaps, std::uint32_t memory_type_bits) {
    std::uint32_t heap = 0;
    while (heap < heaps.size() && heaps[heap].memory_type_bits != memory_type_bits) {
        ++heap;
    }
    if (heap == heaps.size()) {
        heaps.push_back({memory_type_bits, 0});
    }
    return heap;
}

/// Those that begin together stay as they are, by resource.
Scratch<Block> by_first_slot(std::span<const Block> blocks) {
    Scratch<Block> sorted;
    sorted.reserve(blocks.size());
    for (const std::uint32_t i : order_by_key(blocks.size(), [&](std::uint32_t i) { return blocks[i].first_slot; })) {
        sorted.push_back(blocks[i]);
    }
    return sorted;
}

/// One behind the other.
Packing pack_without_sharing(std::span<const Block> blocks, const Conflicts& conflicts, std::uint32_t heap_count,
                             VkDeviceSize live_bytes) {
    Packing packing{Scratch<VkDeviceSize>(blocks.size()), Scratch<VkDeviceSize>(heap_count, 0)};
    for (std::uint32_t i = 0; i < blocks.size(); ++i) {
        VkDeviceSize& heap_bytes = packing.heap_bytes[blocks[i].heap];
        packing.offset_bytes[i] = align_up(heap_bytes, blocks[i].alignment);
        heap_bytes = packing.offset_bytes[i] + blocks[i].size_bytes;
    }
    packing.bound_bytes = std::max(live_bytes, exclusive_bytes(blocks, conflicts, heap_count));
    return packing;
}

/// Where the previous plan had the blocks, if that is still a packing of them: each is there with the same size, and no
/// two that are in conflict overlap. O(conflicts).
std::optional<Packing> packing_of(const Plan& previous, std::span<const Block> blocks, const Conflicts& conflicts,
                                  std::uint32_t heap_count) {
    Packing packing{Scratch<VkDeviceSize>(blocks.size()), Scratch<VkDeviceSize>(heap_count, 0)};
    for (std::uint32_t i = 0; i < blocks.size(); ++i) {
        const Block& block = blocks[i];
        if (block.resource >= previous.placements.size()) {
            return std::nullopt;
        }
        const Placement& placement = previous.placements[block.resource];
        const VkDeviceSize offset = placement.offset_bytes;
        if (placement.kind != PlacementKind::heap || placement.heap != block.heap ||
            placement.size_bytes != block.size_bytes || offset != align_up(offset, block.alignment)) {
            return std::nullopt;
        }
        for (const std::uint32_t other : conflicts.of(i)) {
            if (other < i && offset < packing.offset_bytes[other] + blocks[other].size_bytes &&
                packing.offset_bytes[other] < offset + block.size_bytes) {
                return std::nullopt;
            }
        }
        packing.offset_bytes[i] = offset;
        VkDeviceSize& heap_bytes = packing.heap_bytes[block.heap];
        heap_bytes = std::max(heap_bytes, offset + block.size_bytes);
    }
    packing.total_bytes = std::accumulate(packing.heap_bytes.begin(), packing.heap_bytes.end(), VkDeviceSize{0});
    return packing;
}

/// For each block, in order of first slot, those that lie in its bytes until then. Whoever lay there before them is
/// reached through them. O(blocks x owners of a heap at a time).
void find_owners_before(std::span<const Block> blocks, const Packing& packing, Memory& memory) {
    struct Owned {
        VkDeviceSize begin;
        VkDeviceSize end;
        std::uint32_t resource;
    };
    Scratch<Scratch<Owned>> heaps(packing.heap_bytes.size()); // each by begin, without overlap
    Scratch<Owned> remains;
    memory.owners_before.reserve(blocks.size());
    for (std::uint32_t i = 0; i < blocks.size(); ++i) {
        Scratch<Owned>& owners = heaps[blocks[i].heap];
        const Owned block{packing.offset_bytes[i], packing.offset_bytes[i] + blocks[i].size_bytes, blocks[i].resource};
        const auto first = std::partition_point(owners.begin(), owners.end(),
                                                [&](const Owned& owned) { return owned.end <= block.begin; });
        const auto last =
            std::partition_point(first, owners.end(), [&](const Owned& owned) { return owned.begin < block.end; });
        const auto before = static_cast<std::ptrdiff_t>(memory.owners_before.size());
        remains.clear();
        for (auto owned = first; owned != last; ++owned) {
            memory.owners_before.push_back(owned->resource);
            if (owned->begin < block.begin) {
                remains.push_back({owned->begin, block.begin, owned->resource});
            }
        }
        remains.push_back(block);
        if (first != last && std::prev(last)->end > block.end) {
            remains.push_back({block.end, std::prev(last)->end, std::prev(last)->resource});
        }
        const auto kept = std::min(remains.size(), static_cast<std::size_t>(last - first));
        const auto middle = std::copy_n(remains.begin(), kept, first);
        const auto rest = remains.begin() + static_cast<std::ptrdiff_t>(kept);
        if (middle != last) {
            owners.erase(middle, last);
        } else {
            owners.insert(middle, rest, remains.end());
        }
        const auto begin = memory.owners_before.begin() + before;
        std::sort(begin, memory.owners_before.end());
        memory.owners_before.erase(std::unique(begin, memory.owners_before.end()), memory.owners_before.end());
        memory.first_owner_before[block.resource] = static_cast<std::uint32_t>(before);
        memory.owner_before_count[block.resource] =
            static_cast<std::uint32_t>(memory.owners_before.size()) - static_cast<std::uint32_t>(before);
    }
}

/// Why each has its bytes with others, or alone. O(blocks + owners).
void give_reasons(std::span<const Block> blocks, const Conflicts& conflicts, bool aliasing, Memory& memory) {
    Scratch<std::uint32_t> in_heap(memory.heaps.size(), 0);
    for (const Block& block : blocks) {
        ++in_heap[block.heap];
    }
    for (std::uint32_t i = 0; i < blocks.size(); ++i) {
        Placement& placement = memory.placements[blocks[i].resource];
        placement.could_share = in_heap[blocks[i].heap] - 1 - static_cast<std::uint32_t>(conflicts.of(i).size());
        placement.reason = !aliasing                    ? MemoryReason::sharing_off
                           : placement.could_share == 0 ? MemoryReason::never_idle
                                                        : MemoryReason::better_apart;
    }
    for (const Block& block : blocks) { // by first slot: who takes over comes after those that it takes over from
        const std::span<const std::uint32_t> before = memory.taken_over_by(block.resource);
        for (const std::uint32_t other : before) {
            MemoryReason& reason = memory.placements[other].reason;
            reason = reason == MemoryReason::takes_over ? reason : MemoryReason::is_taken_over;
        }
        if (!before.empty()) {
            memory.placements[block.resource].shares_with = before.front();
            memory.placements[block.resource].reason = MemoryReason::takes_over;
        }
    }
}

/// The most bytes that are live at one pass: between two uses of each, as the partial order has it.
VkDeviceSize largest_live_set(const Schedule& schedule, std::span<const Block> blocks, const Lives& lives) {
    const std::uint32_t queues = schedule.queue_count;
    const std::size_t slots = schedule.order.size() + 1;
    Scratch<VkDeviceSize> change(slots * queues, 0); // wraps where bytes leave
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        for (std::uint32_t q = 0; q < queues; ++q) {
            const std::uint32_t begin = lives.live_begin[i * queues + q];
            const std::uint32_t end = lives.live_end[i * queues + q];
            if (begin < end) {
                change[q * slots + begin] += blocks[i].size_bytes;
                change[q * slots + end] -= blocks[i].size_bytes;
            }
        }
    }
    VkDeviceSize largest = 0;
    for (std::uint32_t q = 0; q < queues; ++q) {
        VkDeviceSize live = 0;
        for (std::size_t position = 0; position < slots; ++position) {
            live += change[q * slots + position];
            largest = std::max(largest, live);
        }
    }
    return largest;
}

} // namespace

Memory place(const GraphDesc& graph, const QueueTopology& topology, const Schedule& schedule,
             const MemoryRequirements& requirements, const CompileOptions& options, const Plan* previous) {
    const auto count = static_cast<std::uint32_t>(graph.resources.size());
    Memory memory;
    memory.placements.resize(count);
    memory.first_owner_before.resize(count, 0);
    memory.owner_before_count.resize(count, 0);
    Scratch<Block> found;
    found.reserve(count);
    for (std::uint32_t resource = 0; resource < count; ++resource) {
        const ResourceDesc& desc = graph.resources[resource];
        Placement& placement = memory.placements[resource];
        const std::uint32_t first = schedule.first_use[resource];
        const std::uint32_t end = schedule.first_use[resource + 1];
        const bool paired = desc.has_history || desc.history_of != none;
        if ((first == end && !paired) || desc.lifetime == ResourceLifetime::imported) {
            placement.reason =
                desc.lifetime == ResourceLifetime::imported ? MemoryReason::host_owns : MemoryReason::not_created;
            continue;
        }
        placement.size_bytes = requirements.of_resource[resource].size_bytes;
        placement.image_usage = desc.image.extra_usage;
        placement.buffer_usage = desc.buffer.extra_usage;
        placement.concurrent = schedule.concurrent[resource];
        if (paired) {
            for (std::uint32_t i = first; i < end; ++i) {
                const std::uint32_t family = topology.queues[schedule.uses[i].queue].family;
                if (std::find(placement.families.begin(), placement.families.end(), family) ==
                    placement.families.end()) {
                    placement.families.push_back(family);
                }
            }
            std::sort(placement.families.begin(), placement.families.end());
            placement.kind = PlacementKind::history;
            placement.reason = MemoryReason::outlives_frame;
        } else {
            placement.kind = PlacementKind::heap;
            const MemoryRequirement& need = requirements.of_resource[resource];
            // Buffers and images never share a page of bufferImageGranularity: both keep to whole pages.
            found.push_back({.resource = resource,
                             .heap = heap_of(memory.heaps, need.memory_type_bits),
                             .size_bytes = align_up(need.size_bytes, requirements.buffer_image_granularity),
                             .alignment = std::max(need.alignment, requirements.buffer_image_granularity),
                             .first_slot = schedule.uses[first].slot,
                             .last_slot = schedule.uses[end - 1].slot});
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

    const Scratch<Block> blocks = by_first_slot(found);
    const auto heap_count = static_cast<std::uint32_t>(memory.heaps.size());
    const Lives lives = find_lives(schedule, blocks);
    const Conflicts conflicts = find_conflicts(schedule, blocks, lives);
    const VkDeviceSize live_bytes = largest_live_set(schedule, blocks, lives);
    const std::optional<Packing> kept =
        previous != nullptr ? packing_of(*previous, blocks, conflicts, heap_count) : std::nullopt;
    const Packing packing =
        options.aliasing ? pack(blocks, conflicts, heap_count, live_bytes, options.effort, kept ? &*kept : nullptr)
                         : pack_without_sharing(blocks, conflicts, heap_count, live_bytes);
    memory.bound_bytes = packing.bound_bytes;
    for (std::uint32_t i = 0; i < blocks.size(); ++i) {
        Placement& placement = memory.placements[blocks[i].resource];
        placement.heap = blocks[i].heap;
        placement.size_bytes = blocks[i].size_bytes;
        placement.offset_bytes = packing.offset_bytes[i];
        memory.unaliased_bytes += blocks[i].size_bytes;
    }
    for (std::uint32_t heap = 0; heap < heap_count; ++heap) {
        memory.heaps[heap].size_bytes = packing.heap_bytes[heap];
    }
    find_owners_before(blocks, packing, memory);
    give_reasons(blocks, conflicts, options.aliasing, memory);
    return memory;
}

} // namespace stages
} // namespace tyndall::rg
