// What only several pictures show together.
#pragma once

#include <string>
#include <vector>

#include "engine/device.hpp"
#include "samples/tyndall/progress.hpp"
#include "samples/tyndall/stability_report.hpp"

namespace tyndall::samples {

/// A study of several pictures: its rows, or what the device failed at.
struct StabilitySeries {
    const char* name;
    tl::expected<std::vector<StabilityRow>, std::string> (*run)(const engine::Device& device, bool quick);
};

[[nodiscard]] std::span<const StabilitySeries> stability_series();

} // namespace tyndall::samples
