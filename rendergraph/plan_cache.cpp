#include "rendergraph/plan_cache.hpp"

#include <algorithm>
#include <utility>

#include "rendergraph/json.hpp"

namespace tyndall::rg {

std::string first_difference(const GraphDesc& graph, const Plan& a, const Plan& b) {
    const std::string text_a = plan_to_json(graph, a);
    const std::string text_b = plan_to_json(graph, b);
    if (text_a == text_b) {
        return "";
    }
    const auto [at_a, at_b] = std::mismatch(text_a.begin(), text_a.end(), text_b.begin(), text_b.end());
    constexpr std::ptrdiff_t shown_before = 60;
    constexpr std::size_t shown = 120;
    const std::ptrdiff_t at = at_a - text_a.begin();
    const auto begin = static_cast<std::size_t>(std::max<std::ptrdiff_t>(at - shown_before, 0));
    return "at character " + std::to_string(at) + ": \"" + text_a.substr(begin, shown) + "\" and \"" +
           text_b.substr(begin, shown) + "\"";
}

tl::expected<const Plan*, Diagnostics> PlanCache::compile(const GraphDesc& graph, const QueueTopology& topology,
                                                          const MemoryRequirements& memory,
                                                          const CompileOptions& options, const Costs& costs) {
    // A graph with mistakes of declaration can look like the one before, without them.
    const PlanHash hash = hash_of_inputs(graph, topology, memory, options, costs);
    const bool unchanged = compiled_ > 0 && hash == hash_ && graph.declaration_errors.empty();
    if (unchanged && !shadow_compile_) {
        return &plan_;
    }
    const Plan& before = unchanged ? before_ : plan_;
    const bool has_before = compiled_ > (unchanged ? 1U : 0U);
    tl::expected<Plan, Diagnostics> plan =
        rg::compile(graph, topology, memory, options, costs, has_before ? &before : nullptr);
    if (!plan) {
        return tl::unexpected(std::move(plan.error()));
    }
    if (unchanged) {
        const std::string difference = first_difference(graph, plan_, *plan);
        if (difference.empty()) {
            return &plan_;
        }
        return tl::unexpected(
            Diagnostics{{.code = DiagnosticCode::plan_not_repeated,
                         .message = "The frame is unchanged, but compiling it gives another plan than "
                                    "the one that was kept: they differ " +
                                    difference + "; change no plan that the cache returned"}});
    }
    before_ = std::exchange(plan_, std::move(*plan));
    hash_ = hash;
    ++compiled_;
    return &plan_;
}

void PlanCache::prefer(Plan plan) {
    plan_ = std::move(plan);
    hash_ = {};
}

} // namespace tyndall::rg
