// A hash by which files are known again.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace tyndall::samples {

/// Fowler, Noll and Vo's hash of 64 bits (RFC 9923), variant 1a.
class Hash {
public:
    void add(std::span<const std::byte> bytes) {
        for (const std::byte byte : bytes) {
            value_ = (value_ ^ std::to_integer<std::uint64_t>(byte)) * 0x100000001b3ULL;
        }
    }
    void add(std::string_view text) { add(std::as_bytes(std::span(text))); }
    template <class Number>
        requires std::is_arithmetic_v<Number>
    void add(Number value) {
        add(std::as_bytes(std::span(&value, 1)));
    }

    /// 16 hexadecimal digits.
    [[nodiscard]] std::string text() const {
        std::array<char, 17> digits{};
        std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(value_));
        return digits.data();
    }

private:
    std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

} // namespace tyndall::samples
