// Whole plans as readable text. After an intended change run with TYNDALL_UPDATE_GOLDEN=1 and read the difference.
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "rendergraph/explain.hpp"
#include "tests/rendergraph/frames.hpp"

namespace tyndall::rg::test {
namespace {

void expect_golden(const std::string& name, const std::string& text) {
    const std::string path = std::string(TYNDALL_GOLDEN_DIR) + "/" + name + ".txt";
    if (std::getenv("TYNDALL_UPDATE_GOLDEN") != nullptr) {
        std::ofstream(path) << text;
        return;
    }
    std::ifstream file(path);
    ASSERT_TRUE(file.good()) << "no golden file " << path;
    std::stringstream golden;
    golden << file.rdbuf();
    EXPECT_EQ(golden.str(), text);
}

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
