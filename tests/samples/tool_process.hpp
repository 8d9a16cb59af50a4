// Running the tool as a process.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tyndall::test {

struct ToolRun {
    int exit_code = -1; ///< 128 + signal after a crash
    std::string output;
    std::string errors;
};

/// Runs the tool with these arguments, no shell between, on the driver whose manifest `driver` names (empty: as the
/// test itself).
[[nodiscard]] ToolRun run_tool(const std::vector<std::string>& arguments, const std::string& driver = {});

/// An empty folder of the running test's own.
[[nodiscard]] std::filesystem::path fresh_folder();

void write_text(const std::filesystem::path& path, const std::string& text);

} // namespace tyndall::test
