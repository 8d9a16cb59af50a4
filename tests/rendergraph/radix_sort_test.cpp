// Sorting by key: as the standard library's stable sort has it, at every size and width of keys.
#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "rendergraph/radix_sort.hpp"

namespace tyndall::rg::stages {
namespace {

TEST(RadixSort, IsTheStableSort) {
    const ScratchScope scope;
    std::mt19937_64 random(3);
    for (std::size_t count = 0; count < 200; ++count) {
        for (std::uint32_t bits = 0; bits <= 64; bits += 4) { // few bits: many equal keys
            Scratch<Keyed> items(count);
            for (std::uint32_t i = 0; i < count; ++i) {
                const std::uint64_t key = bits == 0 ? 7 : random() >> (64 - bits);
                items[i] = {bits % 8 == 0 ? key : ~key, i};
            }
            std::vector<Keyed> expected(items.begin(), items.end());
            std::stable_sort(expected.begin(), expected.end(),
                             [](const Keyed& a, const Keyed& b) { return a.key < b.key; });
            sort_by_key(items);
            ASSERT_TRUE(std::equal(items.begin(), items.end(), expected.begin(), expected.end(),
                                   [](const Keyed& a, const Keyed& b) { return a.key == b.key && a.value == b.value; }))
                << count << " items, keys of " << bits << " bits";
        }
    }
}

} // namespace
} // namespace tyndall::rg::stages
