// On what a figure was measured.
#pragma once

#include <string>

#include "engine/device_info.hpp"

namespace tyndall::samples {

/// Device and driver; of a driver in software the processor too, whose time it is.
[[nodiscard]] std::string machine_text(const engine::DeviceInfo& device);

} // namespace tyndall::samples
