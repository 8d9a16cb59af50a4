// tyndall precision --orders.
#pragma once

#include "samples/tyndall/arguments.hpp"

namespace tyndall::samples {

/// Prints the integrators' orders of convergence, as table or JSON, and writes orders.csv and orders.json to the
/// folder, if one is given. Needs no device.
[[nodiscard]] int run_orders(const PrecisionArguments& arguments);

} // namespace tyndall::samples
