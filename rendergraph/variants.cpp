// Which form of each variant the frame has.
// In: a graph with variants, costs, the previous plan. Out: the plan of the shortest frame, in terms of the whole
// graph. Invariant: the plan is one that compile gives for the graph without the other forms. O(all forms)
// compilations.
#include "rendergraph/variants.hpp"

#include <algorithm>

#include "rendergraph/simulate.hpp"

namespace tyndall::rg::stages {
namespace {

bool in_other_form(const PassDesc& pass, const std::vector<std::uint32_t>& forms) {
    return pass.variant != none && pass.form != forms[pass.variant];
}

/// What one compilation of the frame gave.
struct Attempt {
    tl::expected<Plan, Diagnostics> plan;
    std::int64_t predicted_ns = 0;
};

class Chooser {
public:
    Chooser(const GraphDesc& graph, const Costs& costs, const Plan* previous, const CompileForm& compile_form)
        : graph_(graph), costs_(costs), previous_(previous), compile_form_(compile_form),
          forms_(graph.variants.size(), 0) {}

    tl::expected<Plan, Diagnostics> run() {
        for (std::size_t v = 0; previous_ != nullptr && v < forms_.size(); ++v) {
            forms_[v] = previous_->variants[v].form;
        }
        Attempt best = attempt();
        // One variant's best form may depend on another's: until a round changes nothing. Each change shortens the
        // frame, so it ends; and a frame compiled again with its own plan as the previous one stays.
        std::vector<VariantDecision> decisions(forms_.size());
        for (bool changed = true; changed;) {
            changed = false;
            for (std::uint32_t v = 0; v < forms_.size(); ++v) {
                const std::uint32_t before = forms_[v];
                decisions[v] = choose(v, best);
                changed = changed || forms_[v] != before;
            }
        }
        if (!errors_.empty()) {
            return tl::unexpected(std::move(errors_));
        }
        Plan plan = in_terms_of_the_whole(std::move(*best.plan));
        plan.variants = std::move(decisions);
        return plan;
    }

private:
    Attempt attempt() {
        const OneForm one = with_forms(graph_, forms_);
        Attempt out{compile_form_(one.graph)};
        if (!out.plan) {
            for (Diagnostic& error : out.plan.error()) {
                const bool known = std::any_of(errors_.begin(), errors_.end(),
                                               [&](const Diagnostic& e) { return e.message == error.message; });
                if (!known) {
                    errors_.push_back(std::move(error));
                }
            }
            return out;
        }
        out.predicted_ns = simulate(one.graph, *out.plan, costs_).makespan_ns;
        for (AttachmentOps& operations : out.plan->attachments) {
            operations.access = one.access_of[operations.access];
        }
        return out;
    }

    /// Tries the other forms of one variant; `best` is the frame with the forms chosen so far.
    VariantDecision choose(std::uint32_t variant, Attempt& best) {
        const auto count = static_cast<std::uint32_t>(graph_.variants[variant].forms.size());
        const std::uint32_t start = forms_[variant];
        VariantDecision decision{.form = start, .predicted_ns = std::vector<std::int64_t>(count, 0)};
        decision.predicted_ns[start] = best.predicted_ns;
        const std::int64_t start_ns = best.predicted_ns;
        std::int64_t least_gain_ns = 1;
        if (previous_ != nullptr && best.plan) {
            least_gain_ns = std::max<std::int64_t>(best.plan->decision.threshold_ns, 1);
        }
        std::int64_t shortest_ns = start_ns;
        for (std::uint32_t form = 0; form < count; ++form) {
            if (form == start) {
                continue;
            }
            forms_[variant] = form;
            Attempt other = attempt();
            decision.predicted_ns[form] = other.predicted_ns;
            shortest_ns = std::min(shortest_ns, other.predicted_ns);
            const bool gains = start_ns - other.predicted_ns >= least_gain_ns;
            if (other.plan && measured() && gains && other.predicted_ns < best.predicted_ns) {
                best = std::move(other);
                decision.form = form;
            }
        }
        forms_[variant] = decision.form;
        decision.reason = !measured()                                          ? VariantReason::nothing_measured
                          : shortest_ns < decision.predicted_ns[decision.form] ? VariantReason::kept_by_hysteresis
                                                                               : VariantReason::shortest_frame;
        return decision;
    }

    [[nodiscard]] bool measured() const {
        return std::any_of(costs_.of_pass.begin(), costs_.of_pass.end(),
                           [](const PassCost& cost) { return cost.mean_ns > 0; });
    }

    Plan in_terms_of_the_whole(Plan plan) const {
        for (CulledPass& culled : plan.culled_passes) {
            const PassDesc& pass = graph_.passes[culled.pass];
            if (in_other_form(pass, forms_)) {
                culled = {culled.pass, CullReason::other_form, pass.variant};
            }
        }
        std::vector<bool> touched(graph_.resources.size(), false);
        for (const AccessDesc& access : graph_.accesses) {
            touched[access.resource] = true;
        }
        for (CulledResource& culled : plan.culled_resources) {
            culled.reason = touched[culled.resource] ? CullReason::all_passes_culled : CullReason::never_used;
        }
        return plan;
    }

    const GraphDesc& graph_;
    const Costs& costs_;
    const Plan* previous_;
    const CompileForm& compile_form_;
    std::vector<std::uint32_t> forms_; ///< by variant
    Diagnostics errors_;
};

bool same_variants(const GraphDesc& graph, std::uint64_t passes_hash, const Plan& previous) {
    if (previous.passes_hash != passes_hash || previous.variants.size() != graph.variants.size()) {
        return false;
    }
    for (std::size_t v = 0; v < graph.variants.size(); ++v) {
        if (previous.variants[v].form >= graph.variants[v].forms.size()) {
            return false;
        }
    }
    return true;
}

} // namespace

OneForm with_forms(const GraphDesc& graph, const std::vector<std::uint32_t>& form_of_variant) {
    OneForm one{
        .graph = {
            .resources = graph.resources, .passes = graph.passes, .imports = graph.imports, .points = graph.points}};
    for (PassDesc& pass : one.graph.passes) {
        const std::uint32_t first = pass.first_access;
        const std::uint32_t count = in_other_form(pass, form_of_variant) ? 0 : pass.access_count;
        if (in_other_form(pass, form_of_variant)) {
            pass.has_side_effect = false;
        }
        pass.first_access = static_cast<std::uint32_t>(one.graph.accesses.size());
        pass.access_count = count;
        for (std::uint32_t i = first; i < first + count; ++i) {
            one.graph.accesses.push_back(graph.accesses[i]);
            one.access_of.push_back(i);
        }
    }
    return one;
}

tl::expected<Plan, Diagnostics> compile_variants(const GraphDesc& graph, const Costs& costs, std::uint64_t passes_hash,
                                                 const Plan* previous, const CompileForm& compile_form) {
    const bool fits = previous != nullptr && same_variants(graph, passes_hash, *previous);
    return Chooser(graph, costs, fits ? previous : nullptr, compile_form).run();
}

} // namespace tyndall::rg::stages
