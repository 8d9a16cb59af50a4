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
/// "ceiling 0.41 ms, predicted 0.22 ms, threshold 0.10 ms: overlap": what overlap could gain at most, what it is
/// predicted to gain, what it must gain; what was decided, and why where that does not follow.
[[nodiscard]] std::string describe(const AsyncDecision& decision);
/// "1.25 ms", rounded to the nearest hundredth.
[[nodiscard]] std::string milliseconds_text(std::int64_t nanoseconds);
/// "1.25 MiB", rounded to the nearest hundredth.
[[nodiscard]] std::string mebibytes_text(VkDeviceSize bytes);

} // namespace tyndall::rg
