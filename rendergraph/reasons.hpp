// Why a plan is as it is: a sentence for everything in it that is not a pass or a barrier (those are in plan_text.hpp).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rendergraph/plan.hpp"

namespace tyndall::rg {

/// What happens before what in a plan, by queue order and waits, and who lives when. Built once for many questions.
/// O(passes^2 / 64 + accesses) to build.
class PlanOrder {
public:
    PlanOrder(const GraphDesc& graph, const Plan& plan);

    /// Places in Plan::passes of the passes that touch the resource, ascending.
    [[nodiscard]] const std::vector<std::uint32_t>& users(std::uint32_t resource) const { return users_[resource]; }
    /// Whether the pass at place `first` has ended when the one at place `second` starts, whatever the durations.
    [[nodiscard]] bool before(std::uint32_t first, std::uint32_t second) const;
    /// Whether every user of one is before every user of the other.
    [[nodiscard]] bool resource_before(std::uint32_t first, std::uint32_t second) const;
    /// Transients that have bytes in common with it, in order of their first users.
    [[nodiscard]] std::vector<std::uint32_t> sharers(const Plan& plan, std::uint32_t resource) const;

private:
    std::vector<std::vector<std::uint32_t>> users_;        ///< by resource
    std::vector<std::vector<std::uint64_t>> predecessors_; ///< by place, a bit a place
};

/// Why the batch waits for that other one. Never empty.
[[nodiscard]] std::string why_wait(const GraphDesc& graph, const Plan& plan, const PlanOrder& order,
                                   std::uint32_t batch, const BatchWait& wait);
/// Why the resource's bytes are where they are: shared and with whom, or why not. Never empty.
[[nodiscard]] std::string why_memory(const GraphDesc& graph, const Plan& plan, const PlanOrder& order,
                                     std::uint32_t resource);
[[nodiscard]] std::string why_omitted(const CulledResource& resource);
/// "form 'overlap' of 'culling' is kept: ...", with what was predicted for each form.
[[nodiscard]] std::string why_form(const GraphDesc& graph, const Plan& plan, std::uint32_t variant);

} // namespace tyndall::rg
