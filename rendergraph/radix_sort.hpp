// Sorting numbers by a key, for keys that come in no pattern: a comparison that a branch predictor cannot foresee costs
// more than the rest of a sort. Internal.
#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "rendergraph/scratch.hpp"

namespace tyndall::rg::stages {

struct Keyed {
    std::uint64_t key = 0;
    std::uint32_t value = 0;
};

/// By key, ascending; equal keys keep their order. By digits of a byte, the least first, of which those that all keys
/// share are left out. O(items x bytes in which keys differ).
inline void sort_by_key(Scratch<Keyed>& items) {
    constexpr std::size_t digits = 256;
    constexpr std::size_t few = 32; // fewer than counting digits pays for
    if (items.size() < few) {
        for (std::size_t i = 1; i < items.size(); ++i) {
            const Keyed item = items[i];
            std::size_t at = i;
            for (; at > 0 && item.key < items[at - 1].key; --at) {
                items[at] = items[at - 1];
            }
            items[at] = item;
        }
        return;
    }
    std::uint64_t differing = 0;
    for (const Keyed& item : items) {
        differing |= item.key ^ items.front().key;
    }
    Scratch<Keyed> sorted(differing == 0 ? 0 : items.size());
    for (std::uint32_t shift = 0; shift < 64; shift += 8) {
        if ((differing >> shift & (digits - 1)) == 0) {
            continue;
        }
        const auto digit = [&](const Keyed& item) { return item.key >> shift & (digits - 1); };
        std::array<std::uint32_t, digits> next{};
        for (const Keyed& item : items) {
            ++next[digit(item)];
        }
        std::uint32_t begin = 0;
        for (std::uint32_t& first : next) {
            begin += std::exchange(first, begin);
        }
        for (const Keyed& item : items) {
            sorted[next[digit(item)]++] = item;
        }
        items.swap(sorted);
    }
}

/// The numbers below `count` by `key(number)`, ascending; equal keys by number.
template <typename Key>
[[nodiscard]] Scratch<std::uint32_t> order_by_key(std::size_t count, Key&& key) {
    Scratch<Keyed> keyed(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        keyed[i] = {key(i), i};
    }
    sort_by_key(keyed);
    Scratch<std::uint32_t> order(count);
    for (std::size_t i = 0; i < count; ++i) {
        order[i] = keyed[i].value;
    }
    return order;
}

} // namespace tyndall::rg::stages
