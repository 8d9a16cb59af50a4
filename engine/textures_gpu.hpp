// A scene's textures in device memory.
#pragma once

#include <cstdint>
#include <vector>

#include <tl/expected.hpp>

#include "engine/memory.hpp"
#include "engine/pipelines.hpp"
#include "engine/scene.hpp"
#include "engine/upload.hpp"

namespace tyndall::engine {

struct TexturesGpu {
    std::vector<DeviceImage> images;
    std::vector<DeviceSampler> samplers;
    std::vector<VkDescriptorImageInfo> textures; ///< by Scene::textures; points into the two above
    VkDescriptorImageInfo white = {};            ///< one texel, where a material has no texture
};

/// Images are uploaded once for each way of reading them (colour or data), with levels where a sampler wants them.
/// `anisotropy` 1: none. Content after uploader.finish().
[[nodiscard]] tl::expected<TexturesGpu, Error> upload_textures(const Device& device, Uploader& uploader,
                                                               const Scene& scene, float anisotropy);

} // namespace tyndall::engine
