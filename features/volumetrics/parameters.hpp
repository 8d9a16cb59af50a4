// From a frame's inputs to the uniform structs that the shaders read: pure functions.
#pragma once

#include <cstdint>
#include <optional>

#include "features/volumetrics/frame_inputs.hpp"
#include "features/volumetrics/light_path.hpp"
#include "shaders/volumetrics/interop.h"

namespace tyndall::volumetrics {

/// Lights of up to this many froxels share a cluster's mask.
inline constexpr glm::uvec3 cluster_block{8, 8, 2};

/// What the next frame needs of this one.
struct FrameMemory {
    Camera camera;
    Medium medium;
    glm::uvec2 image_size{0};
    std::optional<Sun> sun;
    std::vector<gpu::GpuLight> lights;    ///< in the render space of `camera`; dark where the froxels leave them out
    std::vector<std::uint32_t> airlights; ///< those that they leave out, ascending
    glm::vec4 air{0.0F};                  ///< of air_of
    LightMarch march;
    gpu::ScatteringVolume volume;
    StorageFormat storage = StorageFormat::fp16;
    std::uint32_t frames_since_cut = 0;
};

/// `parameters` are those that were made of `frame`.
[[nodiscard]] FrameMemory memory_of(const FrameInputs& frame, const gpu::VolumetricParameters& parameters);

/// What takes from light on its way: extinction of homogeneous and of height fog, 1/m, the latter's falloff, 1/m, and
/// base height, m. 0 where nothing does.
[[nodiscard]] glm::vec4 air_of(const FrameInputs& frame);

/// Columns of the images that hold the grid.
[[nodiscard]] glm::uvec2 allocated_columns(const FrameInputs& frame);

/// The volume that the grid settings and a camera span. `radiance_scale` is what radiance is stored times.
[[nodiscard]] gpu::ScatteringVolume scattering_volume(const GridSettings& grid, const Camera& camera,
                                                      float radiance_scale);
/// A power of two by which radiance is stored: 1 unless the brightest light would leave the range of fp16, or the fog
/// be too dim for its digits. The frame before's is kept while it serves, so that it does not change with every
/// flicker.
[[nodiscard]] float radiance_scale_for(const FrameInputs& frame,
                                       const std::optional<FrameMemory>& before = std::nullopt);

[[nodiscard]] gpu::LightClusters light_clusters(const GridSettings& grid, std::uint32_t light_count,
                                                const gpu::DepthLaw& law);

/// True when the frame must not use the one before: there is none, the host cut, or grid, range, field of view or size
/// of the image differ.
[[nodiscard]] bool starts_cold(const FrameInputs& frame, const std::optional<FrameMemory>& before);

/// True when view and place are those of the frame before.
[[nodiscard]] bool camera_stands(const FrameInputs& frame, const std::optional<FrameMemory>& before);

[[nodiscard]] bool is_perspective(const Camera& camera);

/// Everything but the sizes of the shadow maps (`esm_size`), which only the declared graph knows. `before` is empty on
/// a cold start.
[[nodiscard]] gpu::VolumetricParameters volumetric_parameters(const FrameInputs& frame,
                                                              const std::optional<FrameMemory>& before);

} // namespace tyndall::volumetrics
