// Progress of long work: a line that rewrites itself on a terminal, silence in a pipe.
#pragma once

#include <string_view>

namespace tyndall::samples {

class Progress {
public:
    Progress();
    ~Progress(); ///< clears the line
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void show(std::string_view text);

private:
    bool terminal_;
    bool shown_ = false;
};

} // namespace tyndall::samples
