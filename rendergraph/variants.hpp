// Parts of a frame in alternative forms. Internal.
#pragma once

#include <functional>

#include <tl/expected.hpp>

#include "rendergraph/costs.hpp"
#include "rendergraph/plan.hpp"

namespace tyndall::rg::stages {

/// Compiles a graph in which every variant has one form only.
using CompileForm = std::function<tl::expected<Plan, Diagnostics>(const GraphDesc&)>;

/// Keeps the form of each variant with which the frame is predicted to be shortest: one variant after the other, with
/// the forms chosen so far, until none changes. `previous` (or null) keeps its forms unless another gains the
/// threshold. A mistake in any form is an error. O(all forms) compilations a round; two rounds are usual.
[[nodiscard]] tl::expected<Plan, Diagnostics> compile_variants(const GraphDesc& graph, const Costs& costs,
                                                               std::uint64_t passes_hash, const Plan* previous,
                                                               const CompileForm& compile_form);

/// The graph with one form of each variant. Passes keep their index; those of other forms touch nothing.
struct OneForm {
    GraphDesc graph;
    std::vector<std::uint32_t> access_of; ///< by access: its index in the whole graph
};
[[nodiscard]] OneForm with_forms(const GraphDesc& graph, const std::vector<std::uint32_t>& form_of_variant);

} // namespace tyndall::rg::stages
