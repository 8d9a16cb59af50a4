// Whole plans as readable text. After an intended change run with TYNDALL_UPDATE_GOLDEN=1 and read the difference.
#include "rendergraph/explain.hpp"
#include "tests/rendergraph/frames.hpp"
#include "tests/rendergraph/golden.hpp"

namespace tyndall::rg::test {
namespace {

TEST(Golden, FogFrameOnOneQueue) {
    const DeclaredGraph declared = fog_frame();
    expect_golden("fog_one_queue", to_text(declared.desc, compiled(declared.desc, one_queue())));
}

TEST(Golden, FogFrameOnTwoFamilies) {
    const DeclaredGraph declared = fog_frame();
    expect_golden("fog_two_families", to_text(declared.desc, compiled(declared.desc, two_queues())));
}

TEST(Golden, FogFrameOnTwoQueuesOfOneFamily) {
    const DeclaredGraph declared = fog_frame();
    expect_golden("fog_two_queues", to_text(declared.desc, compiled(declared.desc, two_queues_one_family())));
}

TEST(Golden, ExplainTable) {
    const DeclaredGraph declared = fog_frame();
    const Plan plan = compiled(declared.desc, two_queues());
    const std::vector<PassDuration> durations = {{plan.passes[0].pass, 1.25}, {plan.passes[1].pass, 0.5}};
    expect_golden("explain_table", explain_table(declared.desc, plan, durations));
}

} // namespace
} // namespace tyndall::rg::test
