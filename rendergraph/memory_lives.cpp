// When transients live and which of them exclude each other.
// In: the schedule's partial order. Out: for each block its first and last positions by queue, and its conflicts.
// Invariant: two blocks without a conflict are ordered, all uses of one before all uses of the other.
#include <algorithm>

#include "rendergraph/memory_types.hpp"

namespace tyndall::rg::stages {
namespace {

std::vector<std::vector<std::uint32_t>> slots_by_queue(const Schedule& schedule) {
    std::vector<std::vector<std::uint32_t>> slots(schedule.queue_count);
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
    std::vector<std::uint32_t> active;
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

} // namespace tyndall::rg::stages
