// How what lets light through is laid over what lies behind it, and the words that files have for it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "engine/error.hpp"

namespace tyndall::engine {

/// With coverage a, light C of the thing itself, and in-scattered light L and transmittance T of the fog before it,
/// over the light D from behind, which holds all of its own fog already:
enum class Blend : std::uint8_t {
    premultiplied, ///< a (C T + L) + (1 - a) D
    additive,      ///< a C T + D
    multiply,      ///< (1 - m) L + m D, a filter of its colour: m = 1 - a (1 - colour), each channel for itself
};

/// Of "premultiplied", "additive" and "multiply"; other words mean none.
[[nodiscard]] std::optional<Blend> to_blend(std::string_view word);
/// What to_blend takes, for messages.
inline constexpr std::string_view blend_words = "\"premultiplied\", \"additive\" or \"multiply\"";

/// Multiplying needs a second source to blend with; the error says so of `owner`.
[[nodiscard]] tl::expected<void, Error> check_blend(const std::string& owner, Blend blend, bool dual_source_blending);

} // namespace tyndall::engine
