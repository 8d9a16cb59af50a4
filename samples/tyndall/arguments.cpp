#include "samples/tyndall/arguments.hpp"

#include <charconv>

namespace tyndall::samples {

tl::expected<Size, std::string> parse_size(std::string_view text, std::string_view option) {
    constexpr std::uint32_t largest = 16384;
    const auto wrong = [&] {
        return tl::unexpected(std::string(option) + " must be WIDTHxHEIGHT with both from 1 to " +
                              std::to_string(largest) + ", not '" + std::string(text) + "'");
    };
    const std::size_t cross = text.find('x');
    if (cross == std::string_view::npos) {
        return wrong();
    }
    const auto number = [](std::string_view digits, std::uint32_t& value) {
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        return error == std::errc{} && end == digits.data() + digits.size() && value >= 1 && value <= largest;
    };
    Size size;
    if (!number(text.substr(0, cross), size.width) || !number(text.substr(cross + 1), size.height)) {
        return wrong();
    }
    return size;
}

} // namespace tyndall::samples
