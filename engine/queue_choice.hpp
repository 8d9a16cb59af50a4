// Which queues of which families are opened.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/device_info.hpp"
#include "rendergraph/graph_desc.hpp"

namespace tyndall::engine {

struct QueueChoice {
    rg::QueueKind kind = rg::QueueKind::graphics;
    std::uint32_t family = 0;
    std::uint32_t index = 0; ///< within the family
};

/// The graphics queue (which computes too); an async compute queue: of a family without graphics, else a second queue
/// of a family that computes, else none; a transfer queue: of a family that does only that, else a queue that is still
/// free, preferably not of a graphics family, else none. Empty when there is no family for graphics and compute.
[[nodiscard]] std::vector<QueueChoice> choose_queues(std::span<const QueueFamilyInfo> families);

} // namespace tyndall::engine
