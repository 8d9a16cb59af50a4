// What the error of a configuration consists of.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "samples/tyndall/precision_bench.hpp"

namespace tyndall::samples {

/// The configuration's error against each truth, and what of it is left, against all of physics, when
/// one cause at a time is removed or made far smaller. `progress` is told the cause. The error is one sentence.
[[nodiscard]] tl::expected<std::vector<CauseRow>, std::string>
list_causes(Bench& bench, const PrecisionConfiguration& configuration,
            const std::function<void(const std::string&)>& progress);

} // namespace tyndall::samples
