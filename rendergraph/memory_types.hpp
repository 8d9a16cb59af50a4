// What placing transients works on: when resources live, which of them exclude each other, where they lie. Internal.
#pragma once

#include <cstdint>
#include <span>

#include "rendergraph/stages.hpp"

namespace tyndall::rg::stages {

/// `alignment` is a power of two.
[[nodiscard]] inline VkDeviceSize align_up(VkDeviceSize value, VkDeviceSize alignment) {
    return (value + alignment - 1) & ~(alignment - 1);
}

/// A resource to be placed.
struct Block {
    std::uint32_t resource = none;
    std::uint32_t heap = 0;
    VkDeviceSize size_bytes = 0;
    VkDeviceSize alignment = 1;
    std::uint32_t first_slot = 0;
    std::uint32_t last_slot = 0;
};

/// Where blocks live in the schedule's partial order, by block x queue, as positions on the queue.
struct Lives {
    std::uint32_t queue_count = 1;
    Scratch<std::uint32_t> first;      ///< of its first use, `none` if the queue does not use it
    Scratch<std::uint32_t> after;      ///< the first position that comes after all of its uses
    Scratch<std::uint32_t> live_begin; ///< the first position that comes after, or is, one of its uses
    Scratch<std::uint32_t> live_end;   ///< one past the last position that comes before, or is, one of its uses
};
/// O(uses x queues x log slots).
[[nodiscard]] Lives find_lives(const Schedule& schedule, std::span<const Block> blocks);

/// For each block those that may not share bytes with it, in rows, each ascending: `of(block)`.
struct Conflicts {
    Scratch<std::uint32_t> first; ///< blocks + 1 entries into `with`
    Scratch<std::uint32_t> with;
    [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t block) const {
        return {with.data() + first[block], first[block + 1] - first[block]};
    }
};
/// `blocks` by first slot. A sweep that forgets a block once all that is still to come lies behind it, so that the cost
/// follows the number of conflicts and not the square of the blocks.
[[nodiscard]] Conflicts find_conflicts(const Schedule& schedule, std::span<const Block> blocks, const Lives& lives);

/// Bytes that no packing can do without: for each heap the largest set found of blocks that all exclude each other.
/// Greedy from the few blocks whose conflicts weigh most. O(conflicts + tries x row squared).
[[nodiscard]] VkDeviceSize exclusive_bytes(std::span<const Block> blocks, const Conflicts& conflicts,
                                           std::uint32_t heap_count);

struct Packing {
    Scratch<VkDeviceSize> offset_bytes; ///< by block
    Scratch<VkDeviceSize> heap_bytes;   ///< by heap
    VkDeviceSize total_bytes = 0;
    VkDeviceSize bound_bytes = 0; ///< no packing is smaller
};
/// Greedy orders, of which the lowest total is kept, the first of equals: by size, descending, each into the smallest
/// gap that fits; then each into the lowest gap, by length of life, by size times that, both descending, by first slot,
/// and by size again. From each of these last four the block with which the best total is reached goes to the front and
/// the order is tried again, once or, with thorough effort, a bounded number of times. Up to seven blocks thorough
/// effort tries all orders, which is optimal. Ends, quick effort an eighth above it, at the larger of `live_bytes`, a
/// bound that the caller knows, and exclusive_bytes, which is only sought where the first packing is above the other.
/// `kept`, if given, is a valid packing that stays unless another is smaller. O(orders x conflicts x log), the number
/// of tries falling with the number of blocks.
[[nodiscard]] Packing pack(std::span<const Block> blocks, const Conflicts& conflicts, std::uint32_t heap_count,
                           VkDeviceSize live_bytes, Effort effort, const Packing* kept = nullptr);

} // namespace tyndall::rg::stages
