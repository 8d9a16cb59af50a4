#include "features/volumetrics/shaders.hpp"

#include <array>
#include <iterator>

#include "spirv/accumulation_fp16_c0_e0_m0.h"
#include "spirv/accumulation_fp16_c0_e0_m1.h"
#include "spirv/accumulation_fp16_c0_e1_m0.h"
#include "spirv/accumulation_fp16_c0_e1_m1.h"
#include "spirv/accumulation_fp16_c1_e0_m0.h"
#include "spirv/accumulation_fp16_c1_e0_m1.h"
#include "spirv/accumulation_fp16_c1_e1_m0.h"
#include "spirv/accumulation_fp16_c1_e1_m1.h"
#include "spirv/accumulation_fp32_c0_e0_m0.h"
#include "spirv/accumulation_fp32_c0_e0_m1.h"
#include "spirv/accumulation_fp32_c0_e1_m0.h"
#include "spirv/accumulation_fp32_c0_e1_m1.h"
#include "spirv/accumulation_fp32_c1_e0_m0.h"
#include "spirv/accumulation_fp32_c1_e0_m1.h"
#include "spirv/accumulation_fp32_c1_e1_m0.h"
#include "spirv/accumulation_fp32_c1_e1_m1.h"
#include "spirv/density_injection_fp16_m0_t0_p0.h"
#include "spirv/density_injection_fp16_m0_t0_p1.h"
#include "spirv/density_injection_fp16_m0_t1_p0.h"
#include "spirv/density_injection_fp16_m0_t1_p1.h"
#include "spirv/density_injection_fp16_m1_t0_p0.h"
#include "spirv/density_injection_fp16_m1_t0_p1.h"
#include "spirv/density_injection_fp16_m1_t1_p0.h"
#include "spirv/density_injection_fp16_m1_t1_p1.h"
#include "spirv/density_injection_fp32_m0_t0_p0.h"
#include "spirv/density_injection_fp32_m0_t0_p1.h"
#include "spirv/density_injection_fp32_m0_t1_p0.h"
#include "spirv/density_injection_fp32_m0_t1_p1.h"
#include "spirv/density_injection_fp32_m1_t0_p0.h"
#include "spirv/density_injection_fp32_m1_t0_p1.h"
#include "spirv/density_injection_fp32_m1_t1_p0.h"
#include "spirv/density_injection_fp32_m1_t1_p1.h"
#include "spirv/esm_blur.h"
#include "spirv/esm_downsample.h"
#include "spirv/fog_on_opaque_colored.h"
#include "spirv/fog_on_opaque_p0.h"
#include "spirv/fog_on_opaque_p1.h"
#include "spirv/fog_particle_clustering.h"
#include "spirv/froxel_lighting_fp16_s0_l00_h0.h"
#include "spirv/froxel_lighting_fp16_s0_l00_h1.h"
#include "spirv/froxel_lighting_fp16_s0_l10_h0.h"
#include "spirv/froxel_lighting_fp16_s0_l10_h1.h"
#include "spirv/froxel_lighting_fp16_s0_l11_h0.h"
#include "spirv/froxel_lighting_fp16_s0_l11_h1.h"
#include "spirv/froxel_lighting_fp16_s0_l20_h0.h"
#include "spirv/froxel_lighting_fp16_s0_l20_h1.h"
#include "spirv/froxel_lighting_fp16_s0_l21_h0.h"
#include "spirv/froxel_lighting_fp16_s0_l21_h1.h"
#include "spirv/froxel_lighting_fp16_s0_l30_h0.h"
#include "spirv/froxel_lighting_fp16_s0_l30_h1.h"
#include "spirv/froxel_lighting_fp16_s0_l31_h0.h"
#include "spirv/froxel_lighting_fp16_s0_l31_h1.h"
#include "spirv/froxel_lighting_fp16_s1_l00_h0.h"
#include "spirv/froxel_lighting_fp16_s1_l00_h1.h"
#include "spirv/froxel_lighting_fp16_s1_l10_h0.h"
#include "spirv/froxel_lighting_fp16_s1_l10_h1.h"
#include "spirv/froxel_lighting_fp16_s1_l11_h0.h"
#include "spirv/froxel_lighting_fp16_s1_l11_h1.h"
#include "spirv/froxel_lighting_fp16_s1_l20_h0.h"
#include "spirv/froxel_lighting_fp16_s1_l20_h1.h"
#include "spirv/froxel_lighting_fp16_s1_l21_h0.h"
#include "spirv/froxel_lighting_fp16_s1_l21_h1.h"
#include "spirv/froxel_lighting_fp16_s1_l30_h0.h"
#include "spirv/froxel_lighting_fp16_s1_l30_h1.h"
#include "spirv/froxel_lighting_fp16_s1_l31_h0.h"
#include "spirv/froxel_lighting_fp16_s1_l31_h1.h"
#include "spirv/froxel_lighting_fp32_s0_l00_h0.h"
#include "spirv/froxel_lighting_fp32_s0_l00_h1.h"
#include "spirv/froxel_lighting_fp32_s0_l10_h0.h"
#include "spirv/froxel_lighting_fp32_s0_l10_h1.h"
#include "spirv/froxel_lighting_fp32_s0_l11_h0.h"
#include "spirv/froxel_lighting_fp32_s0_l11_h1.h"
#include "spirv/froxel_lighting_fp32_s0_l20_h0.h"
#include "spirv/froxel_lighting_fp32_s0_l20_h1.h"
#include "spirv/froxel_lighting_fp32_s0_l21_h0.h"
#include "spirv/froxel_lighting_fp32_s0_l21_h1.h"
#include "spirv/froxel_lighting_fp32_s0_l30_h0.h"
#include "spirv/froxel_lighting_fp32_s0_l30_h1.h"
#include "spirv/froxel_lighting_fp32_s0_l31_h0.h"
#include "spirv/froxel_lighting_fp32_s0_l31_h1.h"
#include "spirv/froxel_lighting_fp32_s1_l00_h0.h"
#include "spirv/froxel_lighting_fp32_s1_l00_h1.h"
#include "spirv/froxel_lighting_fp32_s1_l10_h0.h"
#include "spirv/froxel_lighting_fp32_s1_l10_h1.h"
#include "spirv/froxel_lighting_fp32_s1_l11_h0.h"
#include "spirv/froxel_lighting_fp32_s1_l11_h1.h"
#include "spirv/froxel_lighting_fp32_s1_l20_h0.h"
#include "spirv/froxel_lighting_fp32_s1_l20_h1.h"
#include "spirv/froxel_lighting_fp32_s1_l21_h0.h"
#include "spirv/froxel_lighting_fp32_s1_l21_h1.h"
#include "spirv/froxel_lighting_fp32_s1_l30_h0.h"
#include "spirv/froxel_lighting_fp32_s1_l30_h1.h"
#include "spirv/froxel_lighting_fp32_s1_l31_h0.h"
#include "spirv/froxel_lighting_fp32_s1_l31_h1.h"
#include "spirv/full_screen.h"
#include "spirv/light_clustering.h"
#include "spirv/noise_bake.h"

namespace tyndall::volumetrics {
namespace {

constexpr VkDescriptorType uniform = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
constexpr VkDescriptorType sampled = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
constexpr VkDescriptorType storage_image = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
constexpr VkDescriptorType storage_buffer = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;

// Which of them a variant has follows from its index below.
constexpr ShaderBinding density_bindings[] = {
    {0, uniform},         {1, storage_image},   {2, storage_image}, {3, sampled}, {4, sampled},
    {5, sampled},         {6, sampled},         {7, sampled},       {8, sampled}, {9, sampled},
    {10, storage_buffer}, {11, storage_buffer}, {12, uniform}};

struct DensityBindings {
    std::array<ShaderBinding, std::size(density_bindings)> list{};
    std::size_t count = 0;
};

/// By variant without the storage format: emission * 4 + textures * 2 + particles.
constexpr std::array<DensityBindings, 8> density_binding_lists = [] {
    std::array<DensityBindings, 8> lists{};
    for (std::size_t i = 0; i < lists.size(); ++i) {
        for (const ShaderBinding& binding : density_bindings) {
            const std::uint32_t b = binding.binding;
            if (b < 2 || (b == 2 && i >= 4) || (b >= 3 && b <= 9 && i / 2 % 2 == 1) || (b >= 10 && i % 2 == 1)) {
                lists[i].list[lists[i].count++] = binding;
            }
        }
    }
    return lists;
}();

constexpr ShaderBinding bake_bindings[] = {{0, storage_buffer}};
constexpr ShaderBinding clustering_bindings[] = {
    {0, uniform}, {1, uniform}, {2, storage_buffer}, {3, storage_buffer}, {4, storage_buffer}};
constexpr ShaderBinding downsample_bindings[] = {{0, uniform}, {1, sampled}, {2, storage_image}};
constexpr ShaderBinding blur_bindings[] = {{0, storage_image}, {1, storage_image}};

// By variant: without what it leaves out of error estimate (4) and emission (5).
constexpr ShaderBinding accumulation_bindings[] = {{0, uniform},       {1, storage_image}, {2, storage_image},
                                                   {3, storage_image}, {4, storage_image}, {5, storage_image}};
constexpr ShaderBinding emitting_accumulation_bindings[] = {
    {0, uniform}, {1, storage_image}, {2, storage_image}, {3, storage_image}, {5, storage_image}};
constexpr ShaderBinding fog_bindings[] = {{0, uniform}, {1, sampled}, {2, sampled}, {3, sampled}, {4, storage_buffer}};

// Numbered as in froxel_lighting.comp; which of them a variant has follows from its index below.
constexpr ShaderBinding lighting_bindings[] = {
    {0, uniform}, {1, storage_image},  {2, sampled}, {3, uniform}, {4, storage_buffer},
    {5, uniform}, {6, storage_buffer}, {7, sampled}, {8, sampled}, {9, storage_buffer}};

/// Kinds of local lights: those without shadows as LIGHTS counts them, then the same three with shadows.
constexpr std::uint32_t light_kinds = 7;

constexpr bool has_binding(std::uint32_t binding, bool sun_shadow, std::uint32_t light_kind, bool history) {
    const std::uint32_t lights = light_kind > 3 ? light_kind - 3 : light_kind;
    switch (binding) {
    case 2:
    case 3: return sun_shadow;
    case 4: return lights >= 1;
    case 5:
    case 6: return lights >= 2;
    case 7: return history;
    case 8:
    case 9: return light_kind > 3;
    default: return true;
    }
}

struct LightingBindings {
    std::array<ShaderBinding, 10> list{};
    std::size_t count = 0;
};

/// By variant without the storage format: (sun_shadow * light_kinds + kind of lights) * 2 + history.
constexpr std::array<LightingBindings, 4 * light_kinds> lighting_binding_lists = [] {
    std::array<LightingBindings, 4 * light_kinds> lists{};
    for (std::uint32_t i = 0; i < lists.size(); ++i) {
        const std::uint32_t kind = (i / 2) % light_kinds;
        for (const ShaderBinding& binding : lighting_bindings) {
            if (has_binding(binding.binding, i / 2 >= light_kinds, kind, i % 2 == 1)) {
                lists[i].list[lists[i].count] = binding;
                if (binding.binding == 4 && kind % 3 == 0 && kind > 0) { // clustered_compact
                    lists[i].list[lists[i].count].type = uniform;
                }
                ++lists[i].count;
            }
        }
    }
    return lists;
}();

/// By variant, storage format first.
const std::span<const std::uint32_t> lighting_code[] = {
    froxel_lighting_fp16_s0_l00_h0, froxel_lighting_fp16_s0_l00_h1, froxel_lighting_fp16_s0_l10_h0,
    froxel_lighting_fp16_s0_l10_h1, froxel_lighting_fp16_s0_l20_h0, froxel_lighting_fp16_s0_l20_h1,
    froxel_lighting_fp16_s0_l30_h0, froxel_lighting_fp16_s0_l30_h1, froxel_lighting_fp16_s0_l11_h0,
    froxel_lighting_fp16_s0_l11_h1, froxel_lighting_fp16_s0_l21_h0, froxel_lighting_fp16_s0_l21_h1,
    froxel_lighting_fp16_s0_l31_h0, froxel_lighting_fp16_s0_l31_h1, froxel_lighting_fp16_s1_l00_h0,
    froxel_lighting_fp16_s1_l00_h1, froxel_lighting_fp16_s1_l10_h0, froxel_lighting_fp16_s1_l10_h1,
    froxel_lighting_fp16_s1_l20_h0, froxel_lighting_fp16_s1_l20_h1, froxel_lighting_fp16_s1_l30_h0,
    froxel_lighting_fp16_s1_l30_h1, froxel_lighting_fp16_s1_l11_h0, froxel_lighting_fp16_s1_l11_h1,
    froxel_lighting_fp16_s1_l21_h0, froxel_lighting_fp16_s1_l21_h1, froxel_lighting_fp16_s1_l31_h0,
    froxel_lighting_fp16_s1_l31_h1, froxel_lighting_fp32_s0_l00_h0, froxel_lighting_fp32_s0_l00_h1,
    froxel_lighting_fp32_s0_l10_h0, froxel_lighting_fp32_s0_l10_h1, froxel_lighting_fp32_s0_l20_h0,
    froxel_lighting_fp32_s0_l20_h1, froxel_lighting_fp32_s0_l30_h0, froxel_lighting_fp32_s0_l30_h1,
    froxel_lighting_fp32_s0_l11_h0, froxel_lighting_fp32_s0_l11_h1, froxel_lighting_fp32_s0_l21_h0,
    froxel_lighting_fp32_s0_l21_h1, froxel_lighting_fp32_s0_l31_h0, froxel_lighting_fp32_s0_l31_h1,
    froxel_lighting_fp32_s1_l00_h0, froxel_lighting_fp32_s1_l00_h1, froxel_lighting_fp32_s1_l10_h0,
    froxel_lighting_fp32_s1_l10_h1, froxel_lighting_fp32_s1_l20_h0, froxel_lighting_fp32_s1_l20_h1,
    froxel_lighting_fp32_s1_l30_h0, froxel_lighting_fp32_s1_l30_h1, froxel_lighting_fp32_s1_l11_h0,
    froxel_lighting_fp32_s1_l11_h1, froxel_lighting_fp32_s1_l21_h0, froxel_lighting_fp32_s1_l21_h1,
    froxel_lighting_fp32_s1_l31_h0, froxel_lighting_fp32_s1_l31_h1,
};

} // namespace

ShaderCode density_injection_shader(StorageFormat storage, bool emission, bool textures, bool particles) {
    const std::span<const std::uint32_t> code[] = {
        density_injection_fp16_m0_t0_p0, density_injection_fp16_m0_t0_p1, density_injection_fp16_m0_t1_p0,
        density_injection_fp16_m0_t1_p1, density_injection_fp16_m1_t0_p0, density_injection_fp16_m1_t0_p1,
        density_injection_fp16_m1_t1_p0, density_injection_fp16_m1_t1_p1, density_injection_fp32_m0_t0_p0,
        density_injection_fp32_m0_t0_p1, density_injection_fp32_m0_t1_p0, density_injection_fp32_m0_t1_p1,
        density_injection_fp32_m1_t0_p0, density_injection_fp32_m1_t0_p1, density_injection_fp32_m1_t1_p0,
        density_injection_fp32_m1_t1_p1};
    const std::size_t index = (emission ? 4U : 0U) + (textures ? 2U : 0U) + (particles ? 1U : 0U);
    const DensityBindings& bindings = density_binding_lists[index];
    return {"density injection", code[(storage == StorageFormat::fp16 ? 0 : density_binding_lists.size()) + index],
            std::span(bindings.list).first(bindings.count)};
}

ShaderCode noise_bake_shader() {
    return {"noise bake", noise_bake, bake_bindings};
}

ShaderCode light_clustering_shader() {
    return {"light clustering", light_clustering, clustering_bindings};
}

ShaderCode fog_particle_clustering_shader() {
    return {"fog particle clustering", fog_particle_clustering, std::span(clustering_bindings).first(4)};
}

ShaderCode esm_downsample_shader() {
    return {"ESM downsample", esm_downsample, downsample_bindings};
}

ShaderCode esm_blur_shader() {
    return {"ESM blur", esm_blur, blur_bindings};
}

ShaderCode froxel_lighting_shader(const LightingVariant& variant) {
    const std::size_t kind = static_cast<std::size_t>(variant.lights) + (variant.local_shadow ? 3 : 0);
    const std::size_t index = (static_cast<std::size_t>(variant.sun_shadow) * light_kinds + kind) * 2 +
                              static_cast<std::size_t>(variant.history);
    const LightingBindings& bindings = lighting_binding_lists[index];
    const std::size_t format = variant.storage == StorageFormat::fp16 ? 0 : lighting_binding_lists.size();
    return {"froxel lighting", lighting_code[format + index], std::span(bindings.list).first(bindings.count),
            variant.history ? 4U : 0U};
}

ShaderCode accumulation_shader(StorageFormat storage, bool colored, bool error_estimate, bool emission) {
    const std::span<const std::uint32_t> code[] = {
        accumulation_fp16_c0_e0_m0, accumulation_fp16_c0_e0_m1, accumulation_fp16_c0_e1_m0, accumulation_fp16_c0_e1_m1,
        accumulation_fp16_c1_e0_m0, accumulation_fp16_c1_e0_m1, accumulation_fp16_c1_e1_m0, accumulation_fp16_c1_e1_m1,
        accumulation_fp32_c0_e0_m0, accumulation_fp32_c0_e0_m1, accumulation_fp32_c0_e1_m0, accumulation_fp32_c0_e1_m1,
        accumulation_fp32_c1_e0_m0, accumulation_fp32_c1_e0_m1, accumulation_fp32_c1_e1_m0, accumulation_fp32_c1_e1_m1};
    const std::size_t format = (storage == StorageFormat::fp16 ? 0 : 8) + (colored ? 4 : 0);
    const std::size_t index = format + (error_estimate ? 2 : 0) + (emission ? 1 : 0);
    if (emission && !error_estimate) {
        return {"accumulation", code[index], emitting_accumulation_bindings};
    }
    return {"accumulation", code[index], std::span(accumulation_bindings).first(emission ? 6 : error_estimate ? 5 : 4)};
}

ShaderCode full_screen_shader() {
    return {"full screen", full_screen, {}};
}

ShaderCode fog_on_opaque_shader(bool colored, bool local_shadow) {
    const std::span<const std::uint32_t> code[] = {fog_on_opaque_p0, fog_on_opaque_p1, fog_on_opaque_colored};
    const std::size_t index = colored ? 2 : local_shadow ? 1 : 0;
    return {"fog on opaque", code[index], std::span(fog_bindings).first(index == 1 ? 5 : 3)};
}

} // namespace tyndall::volumetrics
