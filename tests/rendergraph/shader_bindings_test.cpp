// What is read from SPIR-V is what the GLSL says, and damaged words are an error or another list, never a crash.
#include <algorithm>
#include <ostream>
#include <random>

#include <gtest/gtest.h>

#include "rendergraph/shader_bindings.hpp"
#include "spirv/test_accumulate.h"
#include "spirv/test_affine.h"
#include "spirv/test_cover.h"
#include "spirv/test_double.h"
#include "spirv/test_every_kind.h"
#include "spirv/test_pattern.h"

namespace tyndall::rg {

std::ostream& operator<<(std::ostream& out, const ReflectedBinding& binding) {
    return out << "{set " << binding.set << ", binding " << binding.binding << ", type " << binding.type
               << (binding.may_read ? ", reads" : "") << (binding.may_write ? ", writes" : "") << "}";
}

namespace {

using Spirv = std::span<const std::uint32_t>;
using Bindings = std::vector<ReflectedBinding>;

constexpr VkDescriptorType storage_buffer = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
constexpr VkDescriptorType storage_image = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
constexpr VkDescriptorType sampled = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;

TEST(ShaderBindings, AreWhatTheShaderDeclares) {
    EXPECT_EQ(reflect_bindings(test_affine),
              (Bindings{{0, 0, storage_buffer, true, false}, {0, 1, storage_buffer, false, true}}));
    EXPECT_EQ(reflect_bindings(test_pattern), (Bindings{{0, 0, storage_image, false, true}}));
    EXPECT_EQ(reflect_bindings(test_accumulate),
              (Bindings{{0, 0, sampled, true, false}, {0, 1, storage_image, false, true}}));
    EXPECT_EQ(reflect_bindings(test_double), (Bindings{{0, 0, sampled, true, false}}));
    EXPECT_EQ(reflect_bindings(test_cover), Bindings{});
}

TEST(ShaderBindings, OfSeveralShadersAreOneList) {
    Bindings bindings;
    merge_bindings(bindings, Bindings{{0, 2, storage_buffer, true, false}, {0, 1, storage_buffer, false, true}});
    merge_bindings(bindings, Bindings{{0, 2, storage_buffer, false, true}, {0, 1, sampled, true, false}});
    merge_bindings(bindings, Bindings{{1, 0, sampled, true, false}, {0, 1, sampled, true, false}});
    EXPECT_EQ(bindings, (Bindings{{0, 1, sampled, true, false},
                                  {0, 1, storage_buffer, false, true},
                                  {0, 2, storage_buffer, true, true},
                                  {1, 0, sampled, true, false}}));
}

TEST(ShaderBindings, OfEveryKindAndWithoutWhatIsNotTouched) {
    const Bindings expected = {{0, 0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, true, false},
                               {0, 1, storage_buffer, true, true},
                               {0, 2, storage_buffer, true, true}, // only one of its members is readonly
                               {0, 3, storage_buffer, true, false},
                               {0, 5, storage_image, true, true},
                               {0, 6, storage_image, true, false},
                               {0, 7, VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, true, false},
                               {0, 8, VK_DESCRIPTOR_TYPE_SAMPLER, true, false},
                               {0, 9, VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, true, false},
                               {0, 10, VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER, false, true},
                               {1, 0, sampled, true, false}};
    EXPECT_EQ(reflect_bindings(test_every_kind), expected);
}

TEST(ShaderBindings, WordsThatAreNoModuleAreRefused) {
    const std::string no_module = "The words do not begin as a SPIR-V module of this machine's byte order";
    EXPECT_EQ(reflect_bindings({}).error(), no_module);
    EXPECT_EQ(reflect_bindings(Spirv(test_affine).first(4)).error(), no_module);
    const std::uint32_t other_byte_order[] = {0x03022307, 0, 0, 1, 0};
    EXPECT_EQ(reflect_bindings(other_byte_order).error(), no_module);
    const std::uint32_t endless[] = {test_affine[0], 0x00010600, 0, 1, 0, 17};
    EXPECT_EQ(reflect_bindings(endless).error(), "The instruction at word 5 has a length that cannot be");
    const std::uint32_t too_short[] = {test_affine[0], 0x00010600, 0, 9, 0, 2U << 16U | 25, 1};
    EXPECT_EQ(reflect_bindings(too_short).error(), "The instruction at word 5 makes no sense");
}

TEST(ShaderBindings, DamagedWordsAreNeverReadBeyondTheirEnd) {
    std::mt19937 random(7);
    std::size_t refused = 0;
    for (const Spirv whole : {Spirv(test_affine), Spirv(test_accumulate), Spirv(test_every_kind)}) {
        const std::size_t count = reflect_bindings(whole)->size();
        for (std::size_t length = 0; length < whole.size(); ++length) {
            // A copy of exactly this length, so that a sanitiser sees one word too many.
            const std::vector<std::uint32_t> cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
            const auto read = reflect_bindings(cut);
            refused += read ? 0U : 1U;
            EXPECT_LE(read ? read->size() : 0, count);
        }
        for (int trial = 0; trial < 20000; ++trial) {
            std::vector<std::uint32_t> damaged(whole.begin(), whole.end());
            for (std::uint32_t i = 0; i <= random() % 4; ++i) {
                std::uint32_t& word = damaged[random() % damaged.size()];
                switch (random() % 3) {
                case 0: word = static_cast<std::uint32_t>(random()); break;
                case 1: word ^= 1U << random() % 32; break;
                default: word = damaged[random() % damaged.size()]; break;
                }
            }
            const auto read = reflect_bindings(damaged);
            refused += read ? 0U : 1U;
            if (read) {
                EXPECT_TRUE(std::is_sorted(read->begin(), read->end(), [](const auto& a, const auto& b) {
                    return std::pair(a.set, a.binding) < std::pair(b.set, b.binding);
                }));
            }
        }
    }
    EXPECT_GT(refused, 1000U);
}

} // namespace
} // namespace tyndall::rg
