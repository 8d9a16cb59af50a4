// Values against their domains, for `validate`.
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include <glm/vec3.hpp>
#include <tl/expected.hpp>

#include "features/volumetrics/error.hpp"

namespace tyndall::volumetrics {

/// Six digits at most.
inline std::string text_of(double value) {
    char digits[32];
    const std::to_chars_result end =
        std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, 6);
    return {digits, end.ptr};
}

/// Keeps the first complaint.
class RangeCheck {
public:
    void in_range(std::string_view key, double value, double low, double high) {
        const bool inside = std::isfinite(value) && value >= low && value <= high;
        if (!inside && !error_) {
            error_ = Error{std::string(key) + " must be between " + text_of(low) + " and " + text_of(high) + ", not " +
                           text_of(value) + "."};
        }
    }
    void in_range(std::string_view key, const glm::vec3& value, double low, double high) {
        for (int i = 0; i < 3; ++i) {
            in_range(std::string(key) + "[" + std::to_string(i) + "]", value[i], low, high);
        }
    }
    [[nodiscard]] tl::expected<void, Error> result() const {
        if (error_) {
            return tl::unexpected(*error_);
        }
        return {};
    }

private:
    std::optional<Error> error_;
};

} // namespace tyndall::volumetrics
