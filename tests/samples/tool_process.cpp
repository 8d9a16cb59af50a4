#include "tests/samples/tool_process.hpp"

#include <cstdlib>
#include <fstream>
#include <sstream>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tyndall::test {
namespace {

std::string read_text(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

void redirect(int descriptor, const std::filesystem::path& path) {
    const int file = open(path.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
    dup2(file, descriptor);
    close(file);
}

} // namespace

ToolRun run_tool(const std::vector<std::string>& arguments, const std::string& driver) {
    const std::filesystem::path folder = fresh_folder();
    const std::filesystem::path out = folder / "stdout";
    const std::filesystem::path err = folder / "stderr";
    std::vector<std::string> words = {TYNDALL_TOOL};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) {
        argv.push_back(word.data());
    }
    argv.push_back(nullptr);
    const pid_t child = fork();
    if (child == 0) {
        if (!driver.empty()) {
            setenv("VK_DRIVER_FILES", driver.c_str(), 1);
        }
        redirect(STDOUT_FILENO, out);
        redirect(STDERR_FILENO, err);
        execv(TYNDALL_TOOL, argv.data());
        _exit(127);
    }
    int status = 0;
    waitpid(child, &status, 0);
    ToolRun run;
    run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    run.output = read_text(out);
    run.errors = read_text(err);
    std::filesystem::remove_all(folder);
    return run;
}

std::filesystem::path fresh_folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "tyndall-test-XXXXXX").string();
    return mkdtemp(pattern.data());
}

void write_text(const std::filesystem::path& path, const std::string& text) {
    std::ofstream(path) << text;
}

} // namespace tyndall::test
