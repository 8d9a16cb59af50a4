// From a random frame that shows something to a small one that still does: delta debugging.
#pragma once

#include <functional>
#include <string>

#include "tests/rendergraph/any_frame.hpp"

namespace tyndall::rg::test {

using Shows = std::function<bool(const AnyFrame&)>;

/// Drops passes, accesses, resources, queues and variants, widens ranges, and simplifies images, buffers, imports,
/// wishes and costs, as long as `shows` holds; which must hold of `frame`. Nothing more can be taken away one by one
/// from what is returned. `shows` is asked O(size of the frame squared) times, and of frames that may not compile.
[[nodiscard]] AnyFrame shrunk(AnyFrame frame, const Shows& shows);

/// A small frame that compile or the checker refuses for the same first reason as this one, as a file of the corpus.
/// Put it there once the fault is found.
[[nodiscard]] std::string small_failure(const AnyFrame& frame, const CompileOptions& options = {});

/// As a file of the corpus.
[[nodiscard]] std::string as_json(const AnyFrame& frame, const std::string& about);

} // namespace tyndall::rg::test
