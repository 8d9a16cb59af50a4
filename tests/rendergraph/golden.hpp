// Texts that a test expects word for word, kept as files.
#pragma once

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

namespace tyndall::rg::test {

/// Compares with golden/NAME.txt; with TYNDALL_UPDATE_GOLDEN=1 in the environment it writes that file instead.
inline void expect_golden(const std::string& name, const std::string& text) {
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

} // namespace tyndall::rg::test
