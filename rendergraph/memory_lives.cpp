// When transients live and which of them exclude each other.
// In: the schedule's partial order. Out: for each block its first and last positions by queue, and its conflicts.
// Invariant: two blocks without a conflict are ordered, all uses of one before all uses of the other.
#include <algorithm>
#include <numeric>

#include "rendergraph/memory_types.hpp"

namespace tyndall::rg::stages {
namespace {

Scratch<Scratch<std::uint32_t>> slots_by_queue(const Schedule& schedule) {
    Scratch<Scratch<std::uint32_t>> slots(schedule.queue_count);
    for (Scratch<std::uint32_t>& of_queue : slots) {
        of_queue.reserve(schedule.order.size());
    }
    for (std::uint32_t slot = 0; slot < schedule.order.size(); ++slot) {
        slots[schedule.queue[slot]].push_back(slot);
    }
    return slots;
}

/// By slot and queue: the first position on that queue that happens after the slot. What a slot knows of another queue
/// only grows along its own, so that two positions move forward together. O(slots x queues).
Scratch<std::uint32_t> first_after(const Schedule& schedule, const Scratch<Scratch<std::uint32_t>>& slots) {
    const std::uint32_t queues = schedule.queue_count;
    Scratch<std::uint32_t> after(schedule.order.size() * queues);
    for (std::uint32_t of = 0; of < queues; ++of) {
        for (std::uint32_t q = 0; q < queues; ++q) {
            std::uint32_t at = 0;
            for (const std::uint32_t slot : slots[of]) {
                while (at < slots[q].size() && !schedule.happens_before(slot, slots[q][at])) {
                    ++at;
                }
                after[std::size_t{slot} * queues + q] = at;
            }
        }
    }
    return after;
}

} // namespace

Lives find_lives(const Schedule& schedule, std::span<const Block> blocks) {
    const std::uint32_t queues = schedule.queue_count;
    const Scratch<Scratch<std::uint32_t>> slots = slots_by_queue(schedule);
    const Scratch<std::uint32_t> after = first_after(schedule, slots);
    const std::size_t count = blocks.size() * queues;
    Lives lives{queues, Scratch<std::uint32_t>(count, none), Scratch<std::uint32_t>(count, 0),
                Scratch<std::uint32_t>(count, none), Scratch<std::uint32_t>(count, 0)};
    Scratch<std::uint32_t> last(queues);
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
                lives.after[at] = std::max(lives.after[at], after[std::size_t{last[of]} * queues + q]);
                lives.live_begin[at] =
                    std::min(lives.live_begin[at], own ? first[of] : after[std::size_t{first_slot} * queues + q]);
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
    Scratch<Pair> pairs;
    pairs.reserve(8 * blocks.size());
    Scratch<std::uint32_t> active;
    active.reserve(blocks.size());
    Scratch<std::uint32_t> frontier(queues, 0); // position of the first slot of each queue that is still to come
    std::uint32_t slot = 0;
    for (std::uint32_t block = 0; block < blocks.size(); ++block) {
        for (; slot < blocks[block].first_slot; ++slot) {
            ++frontier[schedule.queue[slot]];
        }
        std::size_t kept = 0;
        for (const std::uint32_t other : active) {
            const std::uint32_t* after = lives.after.data() + std::size_t{other} * queues;
            if (std::equal(frontier.begin(), frontier.end(), after, std::greater_equal<>())) {
                continue;
            }
            active[kept++] = other;
            if (blocks[other].heap == blocks[block].heap && !lives.entirely_before(other, block)) {
                pairs.push_back({other, block});
            }
        }
        active.resize(kept);
        active.push_back(block);
    }
    Conflicts conflicts{Scratch<std::uint32_t>(blocks.size() + 1, 0), Scratch<std::uint32_t>(2 * pairs.size())};
    for (const Pair& pair : pairs) {
        ++conflicts.first[pair.a + 1];
        ++conflicts.first[pair.b + 1];
    }
    for (std::size_t i = 1; i < conflicts.first.size(); ++i) {
        conflicts.first[i] += conflicts.first[i - 1];
    }
    Scratch<std::uint32_t> next(conflicts.first.begin(), conflicts.first.end() - 1);
    for (const Pair& pair : pairs) {
        conflicts.with[next[pair.a]++] = pair.b;
        conflicts.with[next[pair.b]++] = pair.a;
    }
    return conflicts;
}

VkDeviceSize exclusive_bytes(std::span<const Block> blocks, const Conflicts& conflicts, std::uint32_t heap_count,
                             std::size_t tries) {
    struct Start {
        VkDeviceSize weight;
        std::uint32_t block;
    };
    Scratch<Start> starts(blocks.size());
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
    Scratch<VkDeviceSize> largest(heap_count, 0);
    for (const Block& block : blocks) {
        largest[block.heap] = std::max(largest[block.heap], block.size_bytes);
    }
    Scratch<std::uint32_t> set;
    Scratch<std::uint32_t> excluding(blocks.size(), 0); // by block: members of the set that exclude it
    const auto grow = [&](std::uint32_t start, std::span<const std::uint32_t> others) {
        set.clear();
        VkDeviceSize bytes = 0;
        const auto add = [&](std::uint32_t member) {
            set.push_back(member);
            bytes += blocks[member].size_bytes;
            for (const std::uint32_t other : conflicts.of(member)) {
                ++excluding[other];
            }
        };
        add(start);
        for (const std::uint32_t other : others) {
            if (excluding[other] == set.size()) {
                add(other);
            }
        }
        for (const std::uint32_t member : set) {
            for (const std::uint32_t other : conflicts.of(member)) {
                excluding[other] = 0;
            }
        }
        largest[blocks[start].heap] = std::max(largest[blocks[start].heap], bytes);
    };
    Scratch<std::uint32_t> by_size;
    for (const Start& start : std::span(starts).first(tries)) {
        const std::span<const std::uint32_t> as_they_come = conflicts.of(start.block);
        grow(start.block, as_they_come);
        by_size.assign(as_they_come.begin(), as_they_come.end());
        std::sort(by_size.begin(), by_size.end(), [&](std::uint32_t a, std::uint32_t b) {
            return blocks[a].size_bytes != blocks[b].size_bytes ? blocks[a].size_bytes > blocks[b].size_bytes : a < b;
        });
        grow(start.block, by_size);
    }
    return std::accumulate(largest.begin(), largest.end(), VkDeviceSize{0});
}

} // namespace tyndall::rg::stages
