// Dependencies as they were found, resource by resource, into the order in which a frame records them: by slot.
#include <numeric>

#include "rendergraph/synchronise_types.hpp"

namespace tyndall::rg::stages {
namespace {

/// Indices into `found` by slot, those of one slot as they were found.
Scratch<std::uint32_t> by_slot(std::span<const FoundDependency> found, std::uint32_t exit_slot) {
    Scratch<std::uint32_t> next(exit_slot + 2, 0);
    for (const FoundDependency& one : found) {
        ++next[one.slot + 1];
    }
    std::partial_sum(next.begin(), next.end(), next.begin());
    Scratch<std::uint32_t> order(found.size());
    for (std::uint32_t i = 0; i < found.size(); ++i) {
        order[next[found[i].slot]++] = i;
    }
    return order;
}

} // namespace

void collect(std::span<FoundDependency> found, const Schedule& schedule, Synchronised& out) {
    const auto exit_slot = static_cast<std::uint32_t>(schedule.order.size());
    Scratch<std::uint32_t> order = by_slot(found, exit_slot);
    leave_out_covered(order, schedule, found);
    std::erase_if(order, [&](std::uint32_t i) { return is_left_out(found[i]); });
    out.dependencies.reserve(found.size());
    out.first_of_slot.assign(exit_slot + 1, 0);
    const auto add = [&](const FoundDependency& one) {
        if (one.release_batch != none) {
            out.releases[one.release_batch].push_back(static_cast<std::uint32_t>(out.dependencies.size()));
        }
        out.dependencies.push_back(one.dependency);
    };
    // Those at a batch's end first, so that what stands before a slot is one range.
    for (const std::uint32_t i : order) {
        if (found[i].only_at_release) {
            add(found[i]);
        }
    }
    std::uint32_t slot = 0;
    const auto begin_slots_until = [&](std::uint32_t end) {
        for (; slot <= end; ++slot) {
            out.first_of_slot[slot] = static_cast<std::uint32_t>(out.dependencies.size());
        }
    };
    for (const std::uint32_t i : order) {
        if (!found[i].only_at_release) {
            begin_slots_until(found[i].slot);
            add(found[i]);
        }
    }
    begin_slots_until(exit_slot);
    out.first_exit = out.first_of_slot[exit_slot];
}

} // namespace tyndall::rg::stages
