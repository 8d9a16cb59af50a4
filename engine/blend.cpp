#include "engine/blend.hpp"

namespace tyndall::engine {

std::optional<Blend> to_blend(std::string_view word) {
    if (word == "premultiplied") {
        return Blend::premultiplied;
    }
    if (word == "additive") {
        return Blend::additive;
    }
    return word == "multiply" ? std::optional(Blend::multiply) : std::nullopt;
}

tl::expected<void, Error> check_blend(const std::string& owner, Blend blend, bool dual_source_blending) {
    if (blend == Blend::multiply && !dual_source_blending) {
        return tl::unexpected(Error{owner + " is blended by \"multiply\", which needs a device with dualSrcBlend."});
    }
    return {};
}

} // namespace tyndall::engine
