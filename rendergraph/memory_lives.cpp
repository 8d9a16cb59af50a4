// When transients live and which of them exclude each other.
// In: the schedule's partial order. Out: for each block its first and last positions by queue, and its conflicts.
// Invariant: two blocks without a conflict are ordered, all uses of one before all uses of the other.
#include <algorithm>
#include <numeric>
#include <type_traits>

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

/// For each block those before it that it conflicts with, in rows, each ascending.
struct Earlier {
    Scratch<std::uint32_t> first; ///< blocks + 1 entries into `with`
    Scratch<std::uint32_t> with;
};

/// Which blocks are done and which conflict is no pattern that a branch predictor could learn, so both are counted and
/// nothing branches.
template <typename QueueCount>
Earlier find_earlier(const Schedule& schedule, std::span<const Block> blocks, const Lives& lives, QueueCount queues) {
    Earlier earlier;
    earlier.first.reserve(blocks.size() + 1);
    earlier.first.push_back(0);
    Scratch<std::uint32_t>& with = earlier.with;
    with.resize(8 * blocks.size());
    std::size_t count = 0;
    Scratch<std::uint32_t> active(blocks.size()); // what something still to come may meet
    Scratch<std::uint32_t> active_after(blocks.size() *
                                        queues); // beside it, by queue: the first position after its uses
    std::size_t active_count = 0;
    Scratch<std::uint32_t> frontier(queues, 0); // position of the first slot of each queue that is still to come
    std::uint32_t slot = 0;
    for (std::uint32_t block = 0; block < blocks.size(); ++block) {
        for (; slot < blocks[block].first_slot; ++slot) {
            ++frontier[schedule.queue[slot]];
        }
        if (with.size() < count + active_count) {
            with.resize(2 * with.size() + active_count);
        }
        const std::uint32_t* const first = lives.first.data() + std::size_t{block} * queues;
        const std::uint32_t heap = blocks[block].heap;
        std::uint32_t* conflict = with.data() + count;
        std::uint32_t* kept = active.data();
        std::uint32_t* kept_after = active_after.data();
        const std::uint32_t* after = active_after.data();
        for (std::size_t i = 0; i < active_count; ++i, after += queues) {
            const std::uint32_t other = active[i];
            bool before_all_to_come = true;
            bool before_block = true;
            for (std::uint32_t q = 0; q < queues; ++q) {
                before_all_to_come &= frontier[q] >= after[q];
                before_block &= first[q] >= after[q]; // always where it is `none`
                kept_after[q] = after[q];
            }
            *conflict = other;
            conflict += static_cast<std::ptrdiff_t>(!before_block & (blocks[other].heap == heap));
            *kept = other;
            kept += static_cast<std::ptrdiff_t>(!before_all_to_come);
            kept_after += before_all_to_come ? 0 : std::size_t{queues};
        }
        count = static_cast<std::size_t>(conflict - with.data());
        earlier.first.push_back(static_cast<std::uint32_t>(count));
        std::copy_n(lives.after.data() + std::size_t{block} * queues, std::size_t{queues}, kept_after);
        *kept = block;
        active_count = static_cast<std::size_t>(kept - active.data()) + 1;
    }
    with.resize(count);
    return earlier;
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
    Earlier earlier;
    switch (schedule.queue_count) { // a number that the compiler knows saves half of the time
    case 1: earlier = find_earlier(schedule, blocks, lives, std::integral_constant<std::uint32_t, 1>{}); break;
    case 2: earlier = find_earlier(schedule, blocks, lives, std::integral_constant<std::uint32_t, 2>{}); break;
    default: earlier = find_earlier(schedule, blocks, lives, schedule.queue_count); break;
    }
    // Each row: the earlier blocks, which are there, then the later ones, which follow one another.
    Conflicts conflicts{Scratch<std::uint32_t>(blocks.size() + 1, 0), Scratch<std::uint32_t>(2 * earlier.with.size())};
    for (const std::uint32_t other : earlier.with) {
        ++conflicts.first[other + 1];
    }
    Scratch<std::uint32_t> next(blocks.size());
    for (std::uint32_t block = 0; block < blocks.size(); ++block) {
        const std::uint32_t earlier_count = earlier.first[block + 1] - earlier.first[block];
        next[block] = conflicts.first[block] + earlier_count;
        conflicts.first[block + 1] += next[block];
    }
    for (std::uint32_t block = 0; block < blocks.size(); ++block) {
        std::uint32_t* to = conflicts.with.data() + conflicts.first[block];
        for (std::uint32_t i = earlier.first[block]; i < earlier.first[block + 1]; ++i) {
            const std::uint32_t other = earlier.with[i];
            *to++ = other;
            conflicts.with[next[other]++] = block;
        }
    }
    return conflicts;
}

VkDeviceSize exclusive_bytes(std::span<const Block> blocks, const Conflicts& conflicts, std::uint32_t heap_count) {
    struct Start {
        VkDeviceSize weight;
        std::uint32_t block;
    };
    Scratch<Start> starts(blocks.size());
    for (std::uint32_t block = 0; block < blocks.size(); ++block) {
        starts[block] = {blocks[block].size_bytes, block};
        for (const std::uint32_t other : conflicts.of(block)) {
            if (other > block) {
                break;
            }
            starts[block].weight += blocks[other].size_bytes;
        }
    }
    const std::size_t tries =
        std::min(std::clamp<std::size_t>(blocks.size() / 8, 2, 16), blocks.size()); // cheap beside the packing
    std::partial_sort(
        starts.begin(), starts.begin() + static_cast<std::ptrdiff_t>(tries), starts.end(),
        [](const Start& a, const Start& b) { return a.weight != b.weight ? a.weight > b.weight : a.block < b.block; });
    Scratch<VkDeviceSize> largest(heap_count, 0);
    for (const Block& block : blocks) {
        largest[block.heap] = std::max(largest[block.heap], block.size_bytes);
    }
    // By block: `nobody` and the number of members of the set that exclude it. What is not above `nobody` is of a set
    // before this one.
    Scratch<std::uint32_t> excluding(blocks.size(), 0);
    std::uint32_t nobody = 0;
    const auto grow = [&](std::uint32_t start, std::span<const std::uint32_t> others) {
        std::uint32_t all = nobody;
        VkDeviceSize bytes = 0;
        const auto add = [&](std::uint32_t member) {
            ++all;
            bytes += blocks[member].size_bytes;
            for (const std::uint32_t other : conflicts.of(member)) {
                excluding[other] = std::max(excluding[other], nobody) + 1;
            }
        };
        add(start);
        for (const std::uint32_t other : others) {
            if (excluding[other] == all) {
                add(other);
            }
        }
        nobody = all;
        largest[blocks[start].heap] = std::max(largest[blocks[start].heap], bytes);
    };
    Scratch<std::uint32_t> by_size;
    for (const Start& start : std::span(starts).first(tries)) {
        const std::span<const std::uint32_t> as_they_come = conflicts.of(start.block);
        grow(start.block, as_they_come);
        const auto larger = [&](std::uint32_t a, std::uint32_t b) {
            return blocks[a].size_bytes != blocks[b].size_bytes ? blocks[a].size_bytes > blocks[b].size_bytes : a < b;
        };
        if (!std::is_sorted(as_they_come.begin(), as_they_come.end(), larger)) {
            by_size.assign(as_they_come.begin(), as_they_come.end());
            std::sort(by_size.begin(), by_size.end(), larger);
            grow(start.block, by_size);
        }
    }
    return std::accumulate(largest.begin(), largest.end(), VkDeviceSize{0});
}

} // namespace tyndall::rg::stages
