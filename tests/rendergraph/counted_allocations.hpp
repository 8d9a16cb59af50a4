// Every heap allocation of a program that links this is counted.
#pragma once

#include <cstddef>

namespace tyndall::rg::test {

/// Calls of operator new so far, by all threads.
[[nodiscard]] std::size_t allocation_count();

} // namespace tyndall::rg::test
