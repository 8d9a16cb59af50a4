// The parts of which random frames are put together, each drawn from seeded bits.
#pragma once

#include <initializer_list>
#include <random>

#include "rendergraph/plan.hpp"

namespace tyndall::rg::test {

/// Only the generator's raw bits are used: distributions differ between standard libraries.
class Bits {
public:
    explicit Bits(std::uint32_t seed) : bits_(seed) {}
    std::uint32_t below(std::uint32_t limit) { return static_cast<std::uint32_t>(bits_() % limit); }
    std::uint32_t any() { return static_cast<std::uint32_t>(bits_()); }
    template <typename T>
    T one_of(std::initializer_list<T> values) {
        return values.begin()[below(static_cast<std::uint32_t>(values.size()))];
    }

private:
    std::mt19937 bits_;
};

/// 1 to 3 queues, of one family or several.
[[nodiscard]] QueueTopology any_topology(Bits& bits);
/// With mips, layers or depth.
[[nodiscard]] ImageDesc any_image(Bits& bits);
/// All that a host may say on the way in and wish on the way out.
[[nodiscard]] ImportDesc any_import(Bits& bits, const QueueTopology& topology, bool image);
[[nodiscard]] PassKind any_kind(Bits& bits);
/// What such a pass may ask for.
[[nodiscard]] QueueWish any_wish(Bits& bits, PassKind kind);

} // namespace tyndall::rg::test
