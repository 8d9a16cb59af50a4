// A scene in device memory, ready to be drawn.
#pragma once

#include <tl/expected.hpp>

#include "engine/geometry_gpu.hpp"
#include "engine/materials_gpu.hpp"
#include "engine/textures_gpu.hpp"

namespace tyndall::engine {

struct SceneGpu {
    GeometryGpu geometry;
    TexturesGpu textures;
    MaterialsGpu materials;
    std::vector<std::uint32_t> features; ///< by primitive: its material's, and feature_vertex_color
};

/// `anisotropy` of textures, 1: none. Waits until the device has everything.
[[nodiscard]] tl::expected<SceneGpu, Error> upload_scene(const Device& device, const Scene& scene, float anisotropy);

} // namespace tyndall::engine
