// When transients live and which of them exclude each other.
// In: the schedule's partial order. Out: for each block its first and last positions by queue, and its conflicts.
// Invariant: two blocks without a conflict are ordered, all uses of one before all uses of the other.
#include <algorithm>
#include <numeric>

#include "rendergraph/memory_types.hpp"

namespace tyndall::rg::stages {
namespace {

std::vector<std::vector<std::uint32_t>> slots_by_queue(const Schedule& schedule) {
    std::vector<std::vector<std::uint32_t>> slots(schedule.queue_count);
    for (std::vector<std::uint32_t>& of_queue : slots) {
        of_queue.reserve(schedule.order.size());
    }
    for (std::uint32_t slot = 0; slot < schedule.order.size(); ++slot) {
        slots[schedule.queue[slot]].push_back(slot);
    }
    return slots;
}

/// The first position among `slots`, those of one queue, that happens after `slot`: what a slot knows of another queue
/// only grows along its own.
std::uint32_t first_after(const Schedule& schedule, const std::vector<std::uint32_t>& slots, std::uint32_t slot) {
    const auto found = std::partition_point(slots.begin(), slots.end(),
                                            [&](std::uint32_t other) { return !schedule.happens_before(slot, other); });
    return static_cast<std::uint32_t>(found - slots.begin());
}

} // namespace

Lives find_lives(const Schedule& schedule, std::span<const Block> blocks) {
    const std::uint32_t queues = schedule.queue_count;
    const std::vector<std::vector<std::uint32_t>> slots = slots_by_queue(schedule);
    const std::size_t count = blocks.size() * queues;
    Lives lives{queues, std::vector<std::uint32_t>(count, none), std::vector<std::uint32_t>(count, 0),
                std::vector<std::uint32_t>(count, none), std::vector<std::uint32_t>(count, 0)};
    std::vector<std::uint32_t> last(queues);
    for (std::uint32_t block = 0; block < blocks.size(); ++block) {
        std::uint32_t* first = lives.first.data() + std::size_t{block} * queues;
        std::fill(last.begin(), last.end(), none);
        const std::uint32_t resource = blocks[block].resource;
        for (std::uint32_t i = schedule.first_use[resource]; i < schedule.first_use[resource + 1]; ++i) {
            const Use& use = schedule.uses[i]; // in slot order
            if (first[use.queue] == none) {
                first[use.queue] = schedule.position[use.slot];
            }
            last[use.queue] = use.slot;
        }
        for (std::uint32_t of = 0; of < queues; ++of) {
            if (last[of] == none) {
                continue;
            }
            const std::uint32_t first_slot = slots[of][first[of]];
            for (std::uint32_t q = 0; q < queues; ++q) {
                const std::size_t at = std::size_t{block} * queues + q;
                const bool own = q == of;
                const std::uint32_t end =
                    own ? schedule.position[last[of]] + 1 : schedule.clocks[std::size_t{last[of]} * queues + q];
                lives.live_end[at] = std::max(lives.live_end[at], end);
                lives.after[at] = std::max(lives.after[at], own ? end : first_after(schedule, slots[q], last[of]));
                lives.live_begin[at] =
                    std::min(lives.live_begin[at], own ? first[of] : first_after(schedule, slots[q], first_slot));
            }
        }
    }
    return lives;
}

Conflicts find_conflicts(const Schedule& schedule, std::span<const Block> blocks, const Lives& lives) {
    const std::uint32_t queues = schedule.queue_count;
    struct Pair {
        std::uint32_t a;
        std::uint32_t b;
    };
    std::vector<Pair> pairs;
    pairs.reserve(8 * blocks.size());
    std::vector<std::uint32_t> active;
    active.reserve(blocks.size());
    std::vector<std::uint32_t> frontier(queues, 0); // position of the first slot of each queue that is still to come
    std::uint32_t slot = 0;
    for (std::uint32_t block = 0; block < blocks.size(); ++block) {
        for (; slot < blocks[block].first_slot; ++slot) {
            ++frontier[schedule.queue[slot]];
        }
        std::erase_if(active, [&](std::uint32_t other) {
            const std::uint32_t* after = lives.after.data() + std::size_t{other} * queues;
            return std::equal(frontier.begin(), frontier.end(), after, std::greater_equal<>());
        });
        for (const std::uint32_t other : active) {
            if (blocks[other].heap == blocks[block].heap && !lives.entirely_before(other, block)) {
                pairs.push_back({other, block});
            }
        }
        active.push_back(block);
    }
    Conflicts conflicts{std::vector<std::uint32_t>(blocks.size() + 1, 0), std::vector<std::uint32_t>(2 * pairs.size())};
    for (const Pair& pair : pairs) {
        ++conflicts.first[pair.a + 1];
        ++conflicts.first[pair.b + 1];
    }
    for (std::size_t i = 1; i < conflicts.first.size(); ++i) {
        conflicts.first[i] += conflicts.first[i - 1];
    }
    std::vector<std::uint32_t> next(conflicts.first.begin(), conflicts.first.end() - 1);
    for (const Pair& pair : pairs) {
        conflicts.with[next[pair.a]++] = pair.b;
        conflicts.with[next[pair.b]++] = pair.a;
    }
    return conflicts;
}

VkDeviceSize exclusive_bytes(std::span<const Block> blocks, const Conflicts& conflicts, const Lives& lives,
                             std::uint32_t heap_count, std::size_t tries) {
    struct Start {
        VkDeviceSize weight;
        std::uint32_t block;
    };
    std::vector<Start> starts(blocks.size());
    for (std::uint32_t block = 0; block < blocks.size(); ++block) {
        starts[block] = {blocks[block].size_bytes, block};
        for (const std::uint32_t other : conflicts.of(block)) {
            starts[block].weight += other < block ? blocks[other].size_bytes : 0;
        }
    }
    tries = std::min(tries, starts.size());
    std::partial_sort(
        starts.begin(), starts.begin() + static_cast<std::ptrdiff_t>(tries), starts.end(),
        [](const Start& a, const Start& b) { return a.weight != b.weight ? a.weight > b.weight : a.block < b.block; });
    std::vector<VkDeviceSize> largest(heap_count, 0);
    for (const Block& block : blocks) {
        largest[block.heap] = std::max(largest[block.heap], block.size_bytes);
    }
    std::vector<std::uint32_t> set;
    const auto exclude_each_other = [&](std::uint32_t a, std::uint32_t b) {
        return !lives.entirely_before(a, b) && !lives.entirely_before(b, a);
    };
    const auto grow = [&](std::uint32_t start, std::span<const std::uint32_t> others) {
        set.assign(1, start);
        VkDeviceSize bytes = blocks[start].size_bytes;
        for (const std::uint32_t other : others) {
            if (std::all_of(set.begin() + 1, set.end(),
                            [&](auto member) { return exclude_each_other(member, other); })) {
                set.push_back(other);
                bytes += blocks[other].size_bytes;
            }
        }
        largest[blocks[start].heap] = std::max(largest[blocks[start].heap], bytes);
    };
    std::vector<std::uint32_t> by_size;
    for (const Start& start : std::span(starts).first(tries)) {
        const std::span<const std::uint32_t> as_they_come = conflicts.of(start.block);
        grow(start.block, as_they_come);
        by_size.assign(as_they_come.begin(), as_they_come.end());
        std::stable_sort(by_size.begin(), by_size.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return blocks[a].size_bytes > blocks[b].size_bytes; });
        grow(start.block, by_size);
    }
    return std::accumulate(largest.begin(), largest.end(), VkDeviceSize{0});
}

} // namespace tyndall::rg::stages
