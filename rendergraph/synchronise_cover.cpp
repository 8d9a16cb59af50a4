// Barriers that nothing needs, since others of their queue order the same stages.
// In: all dependencies by slot. Out: those that carry no memory and change nothing are narrowed to the stages that no
// others order, or left out. Invariant: whatever was ordered still is: for each pair of a source and a destination
// stage that is taken away, another barrier with that pair, or a chain of them, is recorded between the same passes.
// O(dependencies x stages squared), squared within a slot.
#include <algorithm>
#include <array>

#include "rendergraph/synchronise_types.hpp"

namespace tyndall::rg::stages {
namespace {

/// Stages that are told apart; others stay as they are.
constexpr std::array known_stages = {
    VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
    VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT,
    VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT,
    VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT,
    VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT,
    VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT,
    VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
    VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
    VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
    VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
    VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
    VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR,
    VK_PIPELINE_STAGE_2_HOST_BIT,
    VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
};

bool names(VkPipelineStageFlags2 mask, VkPipelineStageFlags2 stage) {
    const bool all = (mask & VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT) != 0 && stage != VK_PIPELINE_STAGE_2_HOST_BIT;
    return all || (mask & stage) != 0;
}

/// The last barrier of one queue for each pair of stages.
class Ordered {
public:
    /// A barrier recorded when `passes` had been.
    void add(std::uint32_t barrier, const Dependency& d, std::uint32_t passes) {
        for (std::size_t s = 0; s < known_stages.size(); ++s) {
            for (std::size_t t = 0; t < known_stages.size() && names(d.local_stages, known_stages[s]); ++t) {
                if (names(d.dst_stages, known_stages[t])) {
                    last_[s][t] = {passes + 1, barrier};
                }
            }
        }
    }
    /// The barrier with that pair that was recorded when at least so many passes had been; `none`.
    [[nodiscard]] std::uint32_t find(VkPipelineStageFlags2 src, VkPipelineStageFlags2 dst, std::uint32_t passes) const {
        const auto number = [](VkPipelineStageFlags2 stage) {
            return static_cast<std::size_t>(std::find(known_stages.begin(), known_stages.end(), stage) -
                                            known_stages.begin());
        };
        const std::size_t s = number(src);
        const std::size_t t = number(dst);
        const bool known = s < known_stages.size() && t < known_stages.size();
        return known && last_[s][t].since > passes ? last_[s][t].barrier : none;
    }

private:
    struct Last {
        std::uint32_t since = 0; ///< passes before it, plus 1
        std::uint32_t barrier = none;
    };
    std::array<std::array<Last, known_stages.size()>, known_stages.size()> last_ = {};
};

/// No memory, no transition, no owner: it only orders, as far as its own queue is concerned.
bool only_orders(const FoundDependency& found) {
    const Dependency& d = found.dependency;
    return d.local_stages != 0 && d.src_access == 0 && d.dst_access == 0 && d.old_layout == d.new_layout &&
           !d.transfers_ownership && !found.only_at_release;
}

class Coverer {
public:
    Coverer(const Schedule& schedule, std::span<FoundDependency> found)
        : schedule_(schedule), found_(found), ordered_(schedule.queue_count) {}

    void run(std::span<const std::uint32_t> order) {
        const auto exit_slot = static_cast<std::uint32_t>(schedule_.order.size());
        while (!order.empty()) {
            const std::uint32_t slot = found_[order.front()].slot;
            const auto end =
                std::find_if(order.begin(), order.end(), [&](std::uint32_t i) { return found_[i].slot != slot; });
            const auto together = order.first(static_cast<std::size_t>(end - order.begin()));
            // Who asks for less comes first: what then covers a later one in its stead covers it too.
            candidates_.clear();
            std::copy_if(together.begin(), together.end(), std::back_inserter(candidates_),
                         [&](std::uint32_t i) { return only_orders(found_[i]); });
            std::stable_sort(candidates_.begin(), candidates_.end(), [&](std::uint32_t a, std::uint32_t b) {
                return found_[a].after_passes < found_[b].after_passes;
            });
            for (const std::uint32_t i : candidates_) {
                narrow(found_[i], together, slot == exit_slot);
            }
            if (slot != exit_slot) {
                for (const std::uint32_t i : together) {
                    if (!found_[i].only_at_release) {
                        ordered_[schedule_.queue[slot]].add(i, found_[i].dependency, schedule_.position[slot]);
                    }
                }
            }
            order = order.subspan(together.size());
        }
    }

private:
    /// `together` are recorded in one command; exits at the ends of batches, each after its own producers.
    void narrow(FoundDependency& found, std::span<const std::uint32_t> together, bool exits) {
        Dependency& d = found.dependency;
        const auto who_covers = [&](VkPipelineStageFlags2 src, VkPipelineStageFlags2 dst) {
            const auto covers = [&](std::uint32_t i) {
                const Dependency& other = found_[i].dependency;
                return &other != &d && other.dst_queue == d.dst_queue && !found_[i].only_at_release &&
                       (!exits || found_[i].after_passes >= found.after_passes) && names(other.local_stages, src) &&
                       names(other.dst_stages, dst);
            };
            const auto beside = std::find_if(together.begin(), together.end(), covers);
            return beside != together.end() ? *beside : ordered_[d.dst_queue].find(src, dst, found.after_passes);
        };
        const auto all_covered = [&](VkPipelineStageFlags2 src, VkPipelineStageFlags2 dst) {
            bool all = true;
            for_each_pair(src, dst, [&](auto s, auto t) { all = all && who_covers(s, t) != none; });
            if (all) {
                for_each_pair(src, dst, [&](auto s, auto t) {
                    std::uint32_t& orders_for = found_[who_covers(s, t)].dependency.orders_for;
                    orders_for = orders_for == none ? d.resource : orders_for;
                });
            }
            return all;
        };
        VkPipelineStageFlags2 src = d.local_stages;
        for_each_bit(d.local_stages, [&](auto s) { src &= all_covered(s, d.dst_stages) ? ~s : all_bits; });
        if (d.src_queue == d.dst_queue) { // else the whole of it is for queues that are folded onto one
            d.src_stages &= ~(d.local_stages & ~src);
            VkPipelineStageFlags2 dst = d.dst_stages;
            for_each_bit(d.dst_stages, [&](auto t) { dst &= all_covered(d.src_stages, t) ? ~t : all_bits; });
            d.dst_stages = dst;
        }
        d.local_stages = src;
    }

    static constexpr VkPipelineStageFlags2 all_bits = ~VkPipelineStageFlags2{0};
    template <typename F>
    static void for_each_pair(VkPipelineStageFlags2 src, VkPipelineStageFlags2 dst, F&& f) {
        for_each_bit(src,
                     [&](VkPipelineStageFlags2 s) { for_each_bit(dst, [&](VkPipelineStageFlags2 t) { f(s, t); }); });
    }
    template <typename F>
    static void for_each_bit(VkPipelineStageFlags2 mask, F&& f) {
        for (; mask != 0; mask &= mask - 1) {
            f(mask & (~mask + 1));
        }
    }

    const Schedule& schedule_;
    std::span<FoundDependency> found_;
    Scratch<Ordered> ordered_; ///< by queue
    Scratch<std::uint32_t> candidates_;
};

} // namespace

void leave_out_covered(std::span<const std::uint32_t> order, const Schedule& schedule,
                       std::span<FoundDependency> found) {
    if (std::any_of(found.begin(), found.end(), only_orders)) {
        Coverer(schedule, found).run(order);
    }
}

} // namespace tyndall::rg::stages
