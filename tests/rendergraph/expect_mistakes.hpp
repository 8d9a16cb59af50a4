// The mistakes of a frame, and what a test says of them.
#pragma once

#include <source_location>
#include <string>

#include "tests/rendergraph/frames.hpp"

namespace tyndall::rg::test {

inline Diagnostics mistakes(GraphBuilder& graph, const QueueTopology& topology = {}) {
    const DeclaredGraph declared = graph.finish();
    tl::expected<Plan, Diagnostics> plan = compile(declared.desc, topology, estimate_memory(declared.desc));
    return plan.has_value() ? Diagnostics{} : plan.error();
}

/// Exactly one mistake, of that code and text, pointing at these lines of the caller's file.
inline void expect_one(const Diagnostics& found, DiagnosticCode code, const std::string& message, unsigned line,
                       unsigned other_line, const std::source_location& test = std::source_location::current()) {
    ASSERT_EQ(found.size(), 1U) << to_text(found);
    EXPECT_EQ(found[0].code, code) << to_text(found);
    EXPECT_EQ(found[0].message, message);
    EXPECT_EQ(found[0].where.line(), line);
    EXPECT_EQ(found[0].other_where.line(), other_line);
    EXPECT_STREQ(found[0].where.file_name(), test.file_name());
}

} // namespace tyndall::rg::test
