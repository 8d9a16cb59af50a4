// Frames, costs and plans as JSON, both ways. The frame's schema, made to be written by hand, is in docs/frame.md.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "rendergraph/costs.hpp"
#include "rendergraph/plan.hpp"

namespace tyndall::rg {

/// All that compile needs to know of a frame, and where it comes from.
struct Frame {
    std::string about = {}; ///< origin, in words; may be empty
    GraphDesc graph;
    QueueTopology topology;
    Costs costs;
};

/// A queue that a file only names: a family of its own that can do what such queues can on common devices.
[[nodiscard]] QueueInfo usual_queue(QueueKind kind);

/// The frame's graph without places in source code and without errors of its declaration: neither can be in a file.
/// O(accesses).
[[nodiscard]] std::string frame_to_json(const Frame& frame);

/// Reads what frame_to_json writes, or a person. frame_from_json(frame_to_json(f)) is f again. On failure all mistakes
/// together, each naming pass, resource and key: those of the file, and those that compile finds in what the file's
/// own mistakes do not touch. O(accesses + names of the file squared where one is misspelt).
[[nodiscard]] tl::expected<Frame, Diagnostics> frame_from_json(std::string_view text);

/// Costs by the names of passes, and of the model where they differ from the defaults. `about` says where they are
/// from.
[[nodiscard]] std::string costs_to_json(const std::string& about, const GraphDesc& graph, const Costs& costs);

struct NamedCosts {
    std::string about = {};
    Costs costs;
    std::vector<std::string> without_pass = {}; ///< names in the file that the graph does not have
};
/// Reads what costs_to_json writes. What the file does not say stays as in `base`. On failure all mistakes together.
[[nodiscard]] tl::expected<NamedCosts, Diagnostics> costs_from_json(std::string_view text, const GraphDesc& graph,
                                                                    const Costs& base = {});

/// The whole plan, with the names of the graph's passes and resources. O(plan).
[[nodiscard]] std::string plan_to_json(const GraphDesc& graph, const Plan& plan);

/// Reads what plan_to_json writes. Fails where the names are not those of `graph`, or where an index is outside its
/// table, so that what is returned can be explained and verified. O(plan).
[[nodiscard]] tl::expected<Plan, Diagnostics> plan_from_json(std::string_view text, const GraphDesc& graph);

} // namespace tyndall::rg
