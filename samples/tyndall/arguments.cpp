#include "samples/tyndall/arguments.hpp"

#include <charconv>

namespace tyndall::samples {

namespace {

tl::expected<Size, std::string> parse_sides(std::string_view text, std::string_view option, std::uint32_t least,
                                            std::uint32_t most) {
    const auto wrong = [&] {
        return tl::unexpected(std::string(option) + " must be WIDTHxHEIGHT with both from " + std::to_string(least) +
                              " to " + std::to_string(most) + ", not '" + std::string(text) + "'");
    };
    const std::size_t cross = text.find('x');
    if (cross == std::string_view::npos) {
        return wrong();
    }
    const auto number = [&](std::string_view digits, std::uint32_t& value) {
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        return error == std::errc{} && end == digits.data() + digits.size() && value >= least && value <= most;
    };
    Size size;
    if (!number(text.substr(0, cross), size.width) || !number(text.substr(cross + 1), size.height)) {
        return wrong();
    }
    return size;
}

} // namespace

tl::expected<Size, std::string> parse_size(std::string_view text) {
    return parse_sides(text, "--size", 1, 16384);
}

tl::expected<Size, std::string> parse_grid(std::string_view text) {
    return parse_sides(text, "--grid", 2, 1024);
}

} // namespace tyndall::samples
