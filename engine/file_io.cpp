#include "engine/file_io.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <random>
#include <string>
#include <system_error>

namespace tyndall::engine {
namespace {

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

tl::unexpected<Error> failed(const char* what, const std::filesystem::path& path, int error) {
    return tl::unexpected(
        Error{std::string("cannot ") + what + " '" + path.string() + "': " + std::generic_category().message(error)});
}

/// Unlike any other writer's, so that two that write one file do not meet in the unfinished one.
std::filesystem::path unfinished_name(const std::filesystem::path& path) {
    std::random_device random;
    return path.string() + ".unfinished-" + std::to_string(random());
}

} // namespace

tl::expected<std::vector<std::byte>, Error> read_file(const std::filesystem::path& path) {
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) { // fopen opens it all the same
        return failed("read", path, EISDIR);
    }
    const File file(std::fopen(path.c_str(), "rb"));
    if (!file) {
        return failed("read", path, errno);
    }
    std::vector<std::byte> content;
    std::vector<std::byte> portion(std::size_t{1} << 20U);
    for (;;) {
        const std::size_t count = std::fread(portion.data(), 1, portion.size(), file.get());
        content.insert(content.end(), portion.begin(), portion.begin() + static_cast<std::ptrdiff_t>(count));
        if (count < portion.size()) {
            break;
        }
    }
    if (std::ferror(file.get()) != 0) {
        return failed("read", path, EIO);
    }
    return content;
}

tl::expected<void, Error> replace_file(const std::filesystem::path& path, std::span<const std::byte> content) {
    const std::filesystem::path unfinished = unfinished_name(path);
    File file(std::fopen(unfinished.c_str(), "wbx"));
    if (!file) {
        return failed("write", path, errno);
    }
    const bool written =
        content.empty() || std::fwrite(content.data(), 1, content.size(), file.get()) == content.size();
    int error = written ? 0 : errno;
    if (std::fclose(file.release()) != 0 && error == 0) { // the rest of the buffer is written here
        error = errno;
    }
    std::error_code renamed;
    if (error == 0) {
        std::filesystem::rename(unfinished, path, renamed);
        error = renamed.value();
    }
    if (error != 0) {
        std::filesystem::remove(unfinished, renamed);
        return failed("write", path, error);
    }
    return {};
}

} // namespace tyndall::engine
