// The lists of bindings from which layouts are made are what the compiled shaders bind, in every variant.
#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "features/volumetrics/shaders.hpp"
#include "rendergraph/shader_bindings.hpp"

namespace tyndall::volumetrics {
namespace {

std::string text(std::uint32_t binding, VkDescriptorType type) {
    return std::to_string(binding) + " as type " + std::to_string(static_cast<int>(type));
}

void expect_listed(const ShaderCode& shader, const std::string& variant) {
    SCOPED_TRACE(std::string(shader.name) + " " + variant);
    const auto reflected = rg::reflect_bindings(shader.spirv);
    ASSERT_TRUE(reflected.has_value()) << reflected.error();
    std::vector<std::string> of_code;
    for (const rg::ReflectedBinding& binding : *reflected) {
        EXPECT_EQ(binding.set, 0U);
        of_code.push_back(text(binding.binding, binding.type));
    }
    std::vector<std::string> listed;
    for (const ShaderBinding& binding : shader.bindings) {
        listed.push_back(text(binding.binding, binding.type));
    }
    std::sort(of_code.begin(), of_code.end());
    std::sort(listed.begin(), listed.end());
    EXPECT_EQ(of_code, listed);
}

/// Calls `f` with each combination of `count` yes-or-no choices.
template <typename F>
void for_each_choice(std::uint32_t count, F&& f) {
    for (std::uint32_t choice = 0; choice < 1U << count; ++choice) {
        f([choice](std::uint32_t which) { return (choice >> which & 1U) != 0; }, std::to_string(choice));
    }
}

TEST(Shaders, BindWhatTheirListsSay) {
    expect_listed(noise_bake_shader(), "");
    expect_listed(light_clustering_shader(), "");
    expect_listed(fog_particle_clustering_shader(), "");
    expect_listed(esm_downsample_shader(), "");
    expect_listed(esm_blur_shader(), "");
    expect_listed(full_screen_shader(), "");
    expect_listed(fog_on_opaque_shader(true, false), "colored");
    expect_listed(fog_on_opaque_shader(false, false), "without a shadow");
    expect_listed(fog_on_opaque_shader(false, true), "with a shadow");
    for (const StorageFormat storage : {StorageFormat::fp16, StorageFormat::fp32}) {
        for_each_choice(3, [&](auto chosen, const std::string& variant) {
            expect_listed(density_injection_shader(storage, chosen(0), chosen(1), chosen(2)), variant);
            expect_listed(accumulation_shader(storage, chosen(0), chosen(1), chosen(2)), variant);
        });
        for (const LocalLights lights :
             {LocalLights::none, LocalLights::all, LocalLights::clustered, LocalLights::clustered_compact}) {
            for_each_choice(3, [&](auto chosen, const std::string& variant) {
                if (lights != LocalLights::none || !chosen(1)) {
                    expect_listed(froxel_lighting_shader({storage, chosen(0), lights, chosen(1), chosen(2)}), variant);
                }
            });
        }
    }
}

} // namespace
} // namespace tyndall::volumetrics
