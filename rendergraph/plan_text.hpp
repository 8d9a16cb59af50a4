// A plan as readable text: for golden files, logs and people.
#pragma once

#include <string>

#include "rendergraph/plan.hpp"

namespace tyndall::rg {

/// Every pass with queue, slot, reason, barriers (with the pass that made the data), batch waits, memory, omissions.
[[nodiscard]] std::string to_text(const GraphDesc& graph, const Plan& plan);

/// One sentence each, for tables.
[[nodiscard]] std::string why_kept(const GraphDesc& graph, const PlannedPass& pass);
[[nodiscard]] std::string why_culled(const GraphDesc& graph, const CulledPass& pass);
[[nodiscard]] std::string why_queue(const PlannedPass& pass);
[[nodiscard]] std::string describe(const GraphDesc& graph, const Dependency& dependency);

} // namespace tyndall::rg
