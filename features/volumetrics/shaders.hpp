// The compiled shaders of the feature and what each binds.
#pragma once

#include <cstdint>
#include <span>

#include <vulkan/vulkan_core.h>

#include "features/volumetrics/settings.hpp"

namespace tyndall::volumetrics {

struct ShaderBinding {
    std::uint32_t binding;
    VkDescriptorType type;
};

struct ShaderCode {
    const char* name;
    std::span<const std::uint32_t> spirv;
    std::span<const ShaderBinding> bindings; ///< of set 0, push descriptors
    std::uint32_t push_constant_bytes = 0;
};

/// As LIGHTS in froxel_lighting.comp.
enum class LocalLights : std::uint8_t { none, all, clustered, clustered_compact };

/// What froxel lighting is specialised to.
struct LightingVariant {
    StorageFormat storage = StorageFormat::fp16;
    bool sun_shadow = false;
    LocalLights lights = LocalLights::none;
    bool local_shadow = false; ///< of some of the lights, so there are some
    bool history = false;
};

/// `textures`: for media that are made of textures.
[[nodiscard]] ShaderCode density_injection_shader(StorageFormat storage, bool emission, bool textures, bool particles);
[[nodiscard]] ShaderCode noise_bake_shader();
[[nodiscard]] ShaderCode light_clustering_shader();
[[nodiscard]] ShaderCode fog_particle_clustering_shader();
[[nodiscard]] ShaderCode esm_downsample_shader();
[[nodiscard]] ShaderCode esm_blur_shader();
/// Bindings that a variant lacks are left out of the list.
[[nodiscard]] ShaderCode froxel_lighting_shader(const LightingVariant& variant);
[[nodiscard]] ShaderCode accumulation_shader(StorageFormat storage, bool colored, bool error_estimate, bool emission);
[[nodiscard]] ShaderCode full_screen_shader();
/// `local_shadow`: one of the lights that it integrates casts shadows; where extinction is coloured it integrates none.
[[nodiscard]] ShaderCode fog_on_opaque_shader(bool colored, bool local_shadow);

} // namespace tyndall::volumetrics
