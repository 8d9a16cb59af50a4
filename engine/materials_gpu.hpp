// A scene's materials in device memory: one descriptor set each, with every binding written.
#pragma once

#include <cstdint>
#include <vector>

#include <tl/expected.hpp>

#include "engine/memory.hpp"
#include "engine/pipelines.hpp"
#include "engine/scene.hpp"
#include "engine/textures_gpu.hpp"
#include "engine/upload.hpp"
#include "shaders/engine/renderer_interop.h"

namespace tyndall::engine {

// What a material needs of its shader: bit i for texture slot i (see renderer_interop.h), and these; as in
// shaders/engine/material.glsl.
inline constexpr std::uint32_t feature_base_color_texture = 1U << 0U;
inline constexpr std::uint32_t feature_normal_texture = 1U << 2U;
inline constexpr std::uint32_t feature_unlit = 1U << 7U;
inline constexpr std::uint32_t feature_uv_transform = 1U << 8U;
inline constexpr std::uint32_t feature_vertex_color = 1U << 9U;
inline constexpr std::uint32_t feature_additive = 1U << 10U; ///< of what is blended
inline constexpr std::uint32_t feature_filter = 1U << 11U;   ///< likewise: Blend::multiply

[[nodiscard]] gpu::GpuMaterial make_gpu_material(const Material& material);
[[nodiscard]] std::uint32_t material_features(const Material& material);

struct MaterialsGpu {
    DescriptorSetLayout layout; ///< of set 1
    DescriptorPool pool;
    Buffer parameters;                   ///< gpu::GpuMaterial each, at the device's uniform alignment
    std::vector<VkDescriptorSet> sets;   ///< by Scene::materials
    std::vector<std::uint32_t> features; ///< by Scene::materials
};

/// Content after uploader.finish().
[[nodiscard]] tl::expected<MaterialsGpu, Error> upload_materials(const Device& device, Uploader& uploader,
                                                                 const Scene& scene, const TexturesGpu& textures);

} // namespace tyndall::engine
