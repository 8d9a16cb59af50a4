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

enum class Fit : std::uint8_t { smallest_gap, lowest_gap };

/// A gap between `taken` extents that fits, else the first free offset behind them all. Sorts `taken`.
VkDeviceSize find_gap(std::vector<Extent>& taken, const Block& block, VkDeviceSize heap_bytes, Fit fit) {
    std::sort(taken.begin(), taken.end(), [](const Extent& a, const Extent& b) { return a.begin < b.begin; });
    VkDeviceSize cursor = 0;
    VkDeviceSize best = 0;
    VkDeviceSize best_size = ~VkDeviceSize{0};
    for (const Extent& extent : taken) {
        const VkDeviceSize offset = align_up(cursor, block.alignment);
        if (offset + block.size_bytes <= extent.begin && extent.begin - cursor < best_size) {
            best = offset;
            best_size = extent.begin - cursor;
            if (fit == Fit::lowest_gap) {
                return best;
            }
        }
        cursor = std::max(cursor, extent.end);
    }
    const VkDeviceSize offset = align_up(cursor, block.alignment);
    const bool fits_at_end = offset + block.size_bytes <= heap_bytes && heap_bytes - cursor < best_size;
    return best_size == ~VkDeviceSize{0} || fits_at_end ? offset : best;
}

/// False, with `packing` unfinished, once it is not going to stay below `limit_bytes` in total.
bool pack_in_order(std::span<const Block> blocks, const Conflicts& conflicts, std::uint32_t heap_count,
                   std::span<const std::uint32_t> order, Fit fit, VkDeviceSize limit_bytes, Packing& packing) {
    constexpr VkDeviceSize unplaced = ~VkDeviceSize{0};
    packing.offset_bytes.assign(blocks.size(), unplaced);
    packing.heap_bytes.assign(heap_count, 0);
    packing.total_bytes = 0;
    std::vector<Extent> taken;
    for (const std::uint32_t i : order) {
        const Block& block = blocks[i];
        taken.clear();
        for (const std::uint32_t other : conflicts.of(i)) {
            if (const VkDeviceSize begin = packing.offset_bytes[other]; begin != unplaced) {
                taken.push_back({begin, begin + blocks[other].size_bytes});
            }
        }
        VkDeviceSize& heap_bytes = packing.heap_bytes[block.heap];
        packing.offset_bytes[i] = find_gap(taken, block, heap_bytes, fit);
        const VkDeviceSize grown = std::max(heap_bytes, packing.offset_bytes[i] + block.size_bytes);
        packing.total_bytes += grown - heap_bytes;
        heap_bytes = grown;
        if (packing.total_bytes >= limit_bytes) {
            return false;
        }
    }
    return true;
}

} // namespace

Packing pack(std::span<const Block> blocks, const Conflicts& conflicts, std::uint32_t heap_count) {
    std::vector<std::uint32_t> order(blocks.size());
    const auto order_by = [&](auto key) {
        std::iota(order.begin(), order.end(), 0U);
        std::stable_sort(order.begin(), order.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return key(blocks[a]) > key(blocks[b]); });
    };
    Packing best;
    Packing other;
    order_by([](const Block& block) { return block.size_bytes; });
    pack_in_order(blocks, conflicts, heap_count, order, Fit::smallest_gap, ~VkDeviceSize{0}, best);
    const auto consider_order = [&] {
        if (pack_in_order(blocks, conflicts, heap_count, order, Fit::lowest_gap, best.total_bytes, other)) {
            std::swap(best, other);
        }
    };
    order_by([](const Block& block) { return block.last_slot - block.first_slot; });
    consider_order();
    order_by([](const Block& block) { return block.size_bytes * (block.last_slot - block.first_slot + 1); });
    consider_order();
    std::iota(order.begin(), order.end(), 0U); // as they come: by first slot
    consider_order();
    return best;
}

} // namespace tyndall::rg::stages
