#include "samples/tyndall/progress.hpp"

#include <cstdio>

#include <unistd.h>

namespace tyndall::samples {

Progress::Progress() : terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
    if (shown_) {
        std::fprintf(stderr, "\r\033[K");
    }
}

void Progress::show(std::string_view text) {
    if (terminal_) {
        std::fprintf(stderr, "\r\033[K%.*s", static_cast<int>(text.size()), text.data());
        std::fflush(stderr);
        shown_ = true;
    }
}

} // namespace tyndall::samples
