// Offsets for blocks that may share bytes unless they conflict: dynamic storage allocation, by greedy orders.
// In: sizes, alignments, conflicts. Out: an offset each. Invariant: blocks in conflict have no byte in common.
#include <algorithm>
#include <array>
#include <numeric>

#include "rendergraph/memory_types.hpp"

namespace tyndall::rg::stages {
namespace {

VkDeviceSize align_up(VkDeviceSize value, VkDeviceSize alignment) {
    return (value + alignment - 1) / alignment * alignment;
}

struct Extent {
    VkDeviceSize begin;
    VkDeviceSize end;
};

constexpr VkDeviceSize unplaced = ~VkDeviceSize{0};

/// The lowest offset at which the block overlaps none of `taken`.
VkDeviceSize lowest_gap(std::span<const Extent> taken, const Block& block) {
    VkDeviceSize offset = 0;
    for (bool moved = true; moved;) {
        moved = false;
        for (const Extent& extent : taken) {
            if (extent.begin < offset + block.size_bytes && offset < extent.end) {
                offset = align_up(extent.end, block.alignment);
                moved = true;
            }
        }
    }
    return offset;
}

/// The smallest gap between `taken` extents that fits, the end of the heap being one, else the first free offset behind
/// them all. Sorts `taken`.
VkDeviceSize smallest_gap(std::span<Extent> taken, const Block& block, VkDeviceSize heap_bytes) {
    std::sort(taken.begin(), taken.end(), [](const Extent& a, const Extent& b) { return a.begin < b.begin; });
    VkDeviceSize cursor = 0;
    VkDeviceSize best = 0;
    VkDeviceSize best_size = ~VkDeviceSize{0};
    for (const Extent& extent : taken) {
        const VkDeviceSize offset = align_up(cursor, block.alignment);
        if (offset + block.size_bytes <= extent.begin && extent.begin - cursor < best_size) {
            best = offset;
            best_size = extent.begin - cursor;
        }
        cursor = std::max(cursor, extent.end);
    }
    const VkDeviceSize offset = align_up(cursor, block.alignment);
    const bool fits_at_end = offset + block.size_bytes <= heap_bytes && heap_bytes - cursor < best_size;
    return best_size == ~VkDeviceSize{0} || fits_at_end ? offset : best;
}

/// Places blocks one by one, each where `find_gap(taken, block, heap_bytes)` says. False, with `packing` unfinished,
/// once it is not going to stay below `limit_bytes` in total.
template <typename FindGap>
bool pack_in_order(std::span<const Block> blocks, const Conflicts& conflicts, std::span<const std::uint32_t> order,
                   FindGap&& find_gap, VkDeviceSize limit_bytes, Packing& packing) {
    std::vector<Extent> placed(blocks.size(), {unplaced, unplaced});
    std::vector<Extent> taken;
    std::fill(packing.heap_bytes.begin(), packing.heap_bytes.end(), 0);
    packing.total_bytes = 0;
    for (const std::uint32_t i : order) {
        const Block& block = blocks[i];
        taken.clear();
        for (const std::uint32_t other : conflicts.of(i)) {
            if (placed[other].begin != unplaced) {
                taken.push_back(placed[other]);
            }
        }
        VkDeviceSize& heap_bytes = packing.heap_bytes[block.heap];
        const VkDeviceSize offset = find_gap(std::span<Extent>(taken), block, heap_bytes);
        const VkDeviceSize grown = std::max(heap_bytes, offset + block.size_bytes);
        placed[i] = {offset, offset + block.size_bytes};
        packing.total_bytes += grown - heap_bytes;
        heap_bytes = grown;
        if (packing.total_bytes >= limit_bytes) {
            return false;
        }
    }
    std::transform(placed.begin(), placed.end(), packing.offset_bytes.begin(),
                   [](const Extent& extent) { return extent.begin; });
    return true;
}

} // namespace

Packing pack(std::span<const Block> blocks, const Conflicts& conflicts, std::uint32_t heap_count) {
    Packing best{std::vector<VkDeviceSize>(blocks.size()), std::vector<VkDeviceSize>(heap_count)};
    Packing other = best;
    std::vector<std::uint32_t> as_they_come(blocks.size()); // by first slot
    std::iota(as_they_come.begin(), as_they_come.end(), 0U);
    const auto descending_by = [&](auto key) {
        std::vector<std::uint32_t> order = as_they_come;
        std::stable_sort(order.begin(), order.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return key(blocks[a]) > key(blocks[b]); });
        return order;
    };
    const auto consider = [&](std::span<const std::uint32_t> order) {
        const auto find_gap = [](std::span<const Extent> taken, const Block& block, VkDeviceSize /*heap_bytes*/) {
            return lowest_gap(taken, block);
        };
        if (pack_in_order(blocks, conflicts, order, find_gap, best.total_bytes, other)) {
            std::swap(best, other);
        }
    };
    const auto life = [](const Block& block) { return block.last_slot - block.first_slot + 1; };
    const std::vector<std::uint32_t> by_size = descending_by([](const Block& block) { return block.size_bytes; });
    pack_in_order(blocks, conflicts, by_size, smallest_gap, unplaced, best);
    const std::vector<std::uint32_t> by_life = descending_by(life);
    consider(by_life);
    const std::vector<std::uint32_t> by_both =
        descending_by([&](const Block& block) { return block.size_bytes * life(block); });
    if (by_both != by_life) {
        consider(by_both);
    }
    consider(as_they_come);
    return best;
}

} // namespace tyndall::rg::stages
