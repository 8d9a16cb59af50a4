// Offsets for blocks that may share bytes unless they conflict: dynamic storage allocation, by greedy orders.
// In: sizes, alignments, conflicts. Out: an offset each. Invariant: blocks in conflict have no byte in common.
#include <algorithm>
#include <array>
#include <numeric>

#include "rendergraph/memory_types.hpp"

namespace tyndall::rg::stages {
namespace {

struct Extent {
    VkDeviceSize begin;
    VkDeviceSize end;
};

constexpr VkDeviceSize unplaced = ~VkDeviceSize{0};
constexpr std::size_t most_exact_blocks = 7;
// Blocks placed on the way to a better packing, from each order. A frame of thousands of resources takes its first one.
constexpr std::size_t most_steps = 8192;
constexpr std::size_t most_quick_steps = 2048;

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
        if (cursor < extent.begin && extent.begin - cursor < best_size) {
            const VkDeviceSize offset = align_up(cursor, block.alignment);
            if (offset + block.size_bytes <= extent.begin) {
                best = offset;
                best_size = extent.begin - cursor;
            }
        }
        cursor = std::max(cursor, extent.end);
    }
    const VkDeviceSize offset = align_up(cursor, block.alignment);
    const bool fits_at_end = offset + block.size_bytes <= heap_bytes && heap_bytes - cursor < best_size;
    return best_size == ~VkDeviceSize{0} || fits_at_end ? offset : best;
}

/// Places blocks one by one, each where `find_gap(taken, block, heap_bytes)` says. Stops at the block with which the
/// total no longer stays below `limit_bytes`, and returns its place in `order`; the order's length where all stay below
/// it.
template <typename FindGap>
std::size_t pack_in_order(std::span<const Block> blocks, const Conflicts& conflicts,
                          std::span<const std::uint32_t> order, FindGap&& find_gap, VkDeviceSize limit_bytes,
                          Packing& packing) {
    const ScratchScope scope;
    Scratch<Extent> placed(blocks.size(), {unplaced, unplaced});
    Scratch<Extent> taken;
    taken.reserve(blocks.size());
    std::fill(packing.heap_bytes.begin(), packing.heap_bytes.end(), 0);
    packing.total_bytes = 0;
    for (std::size_t at = 0; at < order.size(); ++at) {
        const std::uint32_t i = order[at];
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
            return at;
        }
    }
    std::transform(placed.begin(), placed.end(), packing.offset_bytes.begin(),
                   [](const Extent& extent) { return extent.begin; });
    return order.size();
}

/// All blocks by first slot, or by another key, descending.
Scratch<std::uint32_t> as_they_come(std::size_t count) {
    Scratch<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0U);
    return order;
}
template <typename Key>
Scratch<std::uint32_t> descending_by(std::span<const Block> blocks, Key&& key) {
    Scratch<std::uint32_t> order = as_they_come(blocks.size());
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        const auto key_a = key(blocks[a]);
        const auto key_b = key(blocks[b]);
        return key_a != key_b ? key_a > key_b : a < b;
    });
    return order;
}

/// Tries the other orders until `best` needs no more than `enough_bytes`.
void improve(std::span<const Block> blocks, const Conflicts& conflicts, Scratch<std::uint32_t> by_size,
             VkDeviceSize enough_bytes, Effort effort, Packing& best) {
    const auto find_lowest = [](std::span<const Extent> taken, const Block& block, VkDeviceSize /*heap_bytes*/) {
        return lowest_gap(taken, block);
    };
    const auto life = [](const Block& block) { return block.last_slot - block.first_slot + 1; };
    Packing other = best;
    const auto try_order = [&](Scratch<std::uint32_t> order, std::size_t rounds) {
        for (std::size_t round = 0; round < rounds && best.total_bytes > enough_bytes; ++round) {
            const std::size_t end = pack_in_order(blocks, conflicts, order, find_lowest, best.total_bytes, other);
            if (end == order.size()) {
                std::swap(best, other);
            } else {
                const auto culprit = order.begin() + static_cast<std::ptrdiff_t>(end);
                std::rotate(order.begin(), culprit, culprit + 1);
            }
        }
    };
    if (effort == Effort::thorough && blocks.size() <= most_exact_blocks) {
        // Some order is optimal: that of the offsets in an optimal packing.
        Scratch<std::uint32_t> order = as_they_come(blocks.size());
        do {
            try_order(order, 1);
        } while (std::next_permutation(order.begin(), order.end()));
        return;
    }
    const std::size_t steps = effort == Effort::thorough ? most_steps : most_quick_steps;
    const std::size_t least = effort == Effort::thorough ? 2 : 0;
    const std::size_t most = effort == Effort::thorough ? 64 : 2;
    const std::size_t rounds = std::clamp(steps / std::max<std::size_t>(blocks.size(), 1), least, most);
    try_order(descending_by(blocks, life), rounds);
    try_order(descending_by(blocks, [&](const Block& block) { return block.size_bytes * life(block); }), rounds);
    try_order(as_they_come(blocks.size()), rounds);
    try_order(std::move(by_size), rounds);
}

} // namespace

Packing pack(std::span<const Block> blocks, const Conflicts& conflicts, std::uint32_t heap_count,
             VkDeviceSize live_bytes, Effort effort, const Packing* kept) {
    Packing best;
    if (kept != nullptr && kept->total_bytes <= live_bytes) {
        best = *kept;
        best.bound_bytes = live_bytes;
        return best;
    }
    best.offset_bytes.resize(blocks.size());
    best.heap_bytes.resize(heap_count);
    Scratch<std::uint32_t> by_size = descending_by(blocks, [](const Block& block) { return block.size_bytes; });
    pack_in_order(blocks, conflicts, by_size, smallest_gap, unplaced, best);
    if (kept != nullptr && kept->total_bytes <= best.total_bytes) {
        best = *kept;
    }
    VkDeviceSize bound_bytes = live_bytes;
    if (best.total_bytes > bound_bytes) {
        bound_bytes = std::max(bound_bytes, exclusive_bytes(blocks, conflicts, heap_count));
        // A frame does not wait for the last few percent: the refined plan that follows has them.
        const VkDeviceSize enough_bytes = effort == Effort::thorough ? bound_bytes : bound_bytes + bound_bytes / 8;
        improve(blocks, conflicts, std::move(by_size), enough_bytes, effort, best);
    }
    best.bound_bytes = bound_bytes;
    return best;
}

} // namespace tyndall::rg::stages
