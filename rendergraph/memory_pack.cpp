// Offsets for blocks that may share bytes unless they conflict: dynamic storage allocation, by greedy orders.
// In: sizes, alignments, conflicts. Out: an offset each. Invariant: blocks in conflict have no byte in common.
#include <algorithm>
#include <numeric>

#include "rendergraph/memory_types.hpp"
#include "rendergraph/radix_sort.hpp"

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

/// The bytes that a block may not have, by begin. In the order of first slots, and of sizes where many are equal,
/// blocks that follow one another mostly conflict with the same others, so that few bytes change from one to the next.
class TakenBytes {
public:
    explicit TakenBytes(std::size_t block_count)
        : placed_(block_count, {unplaced, unplaced}), waiting_for_(block_count, none), taken_(block_count),
          come_(block_count), placed_conflicts_(block_count, 0) {}
    void place(std::uint32_t block, VkDeviceSize begin, VkDeviceSize end) { placed_[block] = {begin, end}; }
    [[nodiscard]] VkDeviceSize begin_of(std::uint32_t block) const { return placed_[block].begin; }

    /// Makes it the bytes of those in conflict with a block, which must be placed before the next one is moved to. Each
    /// block once; who is in whose `conflicts` is mutual. O(taken before + conflicts), and where more than a few come
    /// O(taken log taken).
    void move_to(std::uint32_t block, std::span<const std::uint32_t> conflicts) {
        for (const std::uint32_t other : conflicts) {
            waiting_for_[other] = block;
            ++placed_conflicts_[other];
        }
        // What stays and what comes is no pattern that a branch predictor could learn: counted, without branches.
        std::size_t stay = 0;
        for (std::size_t i = 0; i < count_; ++i) {
            const std::uint32_t other = taken_[i];
            const bool stays = waiting_for_[other] == block;
            taken_[stay] = other;
            stay += stays ? 1 : 0;
            waiting_for_[other] = stays ? none : waiting_for_[other];
        }
        count_ = stay;
        std::size_t come = placed_conflicts_[block] - stay;
        const bool only_last_comes = come == 1 && waiting_for_[last_] == block;
        if (only_last_comes) {
            come_[0] = last_;
        } else if (come > 0) {
            come = 0;
            for (const std::uint32_t other : conflicts) {
                come_[come] = other;
                const bool waits = waiting_for_[other] == block;
                const bool is_placed = placed_[other].begin != unplaced;
                come += static_cast<std::size_t>(waits & is_placed);
            }
        }
        last_ = block;
        const auto by_begin = [&](std::uint32_t a, std::uint32_t b) { return placed_[a].begin < placed_[b].begin; };
        if (come > most_inserted) {
            std::copy_n(come_.begin(), come, taken_.begin() + static_cast<std::ptrdiff_t>(count_));
            count_ += come;
            std::sort(taken_.begin(), taken_.begin() + static_cast<std::ptrdiff_t>(count_), by_begin);
            return;
        }
        for (std::size_t i = 0; i < come; ++i) {
            std::size_t at = count_++;
            for (; at > 0 && by_begin(come_[i], taken_[at - 1]); --at) {
                taken_[at] = taken_[at - 1];
            }
            taken_[at] = come_[i];
        }
    }

    /// The lowest gap that fits, else the first free offset behind them all.
    [[nodiscard]] VkDeviceSize lowest_gap(const Block& block) const {
        VkDeviceSize offset = 0;
        for (std::size_t i = 0; i < count_ && placed_[taken_[i]].begin < offset + block.size_bytes; ++i) {
            offset = std::max(offset, align_up(placed_[taken_[i]].end, block.alignment));
        }
        return offset;
    }

    /// The smallest gap that fits, the end of the heap being one, else the first free offset behind them all.
    [[nodiscard]] VkDeviceSize smallest_gap(const Block& block, VkDeviceSize heap_bytes) const {
        VkDeviceSize cursor = 0;
        VkDeviceSize best = 0;
        VkDeviceSize best_size = ~VkDeviceSize{0};
        for (std::size_t i = 0; i < count_; ++i) {
            const Extent& extent = placed_[taken_[i]];
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

private:
    static constexpr std::size_t most_inserted = 4;

    Scratch<Extent> placed_;             ///< by block
    Scratch<std::uint32_t> waiting_for_; ///< by block: the last block that conflicts with it and has not met it yet
    Scratch<std::uint32_t> taken_;       ///< blocks, by begin; the first count_
    Scratch<std::uint32_t> come_;
    Scratch<std::uint32_t> placed_conflicts_; ///< by block: placed blocks that conflict with it
    std::size_t count_ = 0;
    std::uint32_t last_ = 0; ///< placed
};

enum class Gap : std::uint8_t { lowest, smallest };

/// Places blocks one by one, each in the gap of that kind. Stops at the block with which the total no longer stays
/// below `limit_bytes`, and returns its place in `order`; the order's length where all stay below it.
std::size_t pack_in_order(std::span<const Block> blocks, const Conflicts& conflicts,
                          std::span<const std::uint32_t> order, Gap gap, VkDeviceSize limit_bytes, Packing& packing) {
    const ScratchScope scope;
    TakenBytes taken(blocks.size());
    std::fill(packing.heap_bytes.begin(), packing.heap_bytes.end(), 0);
    packing.total_bytes = 0;
    for (std::size_t at = 0; at < order.size(); ++at) {
        const std::uint32_t i = order[at];
        const Block& block = blocks[i];
        VkDeviceSize& heap_bytes = packing.heap_bytes[block.heap];
        taken.move_to(i, conflicts.of(i));
        const VkDeviceSize offset =
            gap == Gap::lowest ? taken.lowest_gap(block) : taken.smallest_gap(block, heap_bytes);
        const VkDeviceSize grown = std::max(heap_bytes, offset + block.size_bytes);
        taken.place(i, offset, offset + block.size_bytes);
        packing.total_bytes += grown - heap_bytes;
        heap_bytes = grown;
        if (packing.total_bytes >= limit_bytes) {
            return at;
        }
    }
    for (std::uint32_t i = 0; i < blocks.size(); ++i) {
        packing.offset_bytes[i] = taken.begin_of(i);
    }
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
    return order_by_key(blocks.size(), [&](std::uint32_t i) { return ~std::uint64_t{key(blocks[i])}; });
}

/// Tries the other orders until `best` needs no more than `enough_bytes`.
void improve(std::span<const Block> blocks, const Conflicts& conflicts, Scratch<std::uint32_t> by_size,
             VkDeviceSize enough_bytes, Effort effort, Packing& best) {
    const auto life = [](const Block& block) { return block.last_slot - block.first_slot + 1; };
    Packing other = best;
    const auto is_enough = [&] { return best.total_bytes <= enough_bytes; };
    const auto try_order = [&](Scratch<std::uint32_t> order, std::size_t rounds) {
        for (std::size_t round = 0; round < rounds && !is_enough(); ++round) {
            const std::size_t end = pack_in_order(blocks, conflicts, order, Gap::lowest, best.total_bytes, other);
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
    const auto size_times_life = [&](const Block& block) { return block.size_bytes * life(block); };
    if (rounds > 0 && !is_enough()) {
        try_order(descending_by(blocks, life), rounds);
    }
    if (rounds > 0 && !is_enough()) {
        try_order(descending_by(blocks, size_times_life), rounds);
    }
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
    pack_in_order(blocks, conflicts, by_size, Gap::smallest, unplaced, best);
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
