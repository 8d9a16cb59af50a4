// Texels that the host has given, on the device: copied there in the first frame that needs them, and kept.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "features/volumetrics/density_texels.hpp"
#include "features/volumetrics/persistent_image.hpp"

namespace tyndall::volumetrics {

class DensityImage {
public:
    [[nodiscard]] static tl::expected<std::unique_ptr<DensityImage>, Error>
    create(const rg::DeviceTable& vk, VkDevice device, const VkPhysicalDeviceMemoryProperties& memory,
           std::span<const std::uint32_t> queue_families, std::shared_ptr<const DensityTexels> texels);
    DensityImage(const DensityImage&) = delete;
    DensityImage& operator=(const DensityImage&) = delete;
    ~DensityImage(); ///< no frame that uses it may be in flight

    [[nodiscard]] const std::shared_ptr<const DensityTexels>& texels() const { return texels_; }
    [[nodiscard]] VkImage handle() const { return image_->handle(); }
    /// Its content in this graph, with the pass that copies it there if need be.
    [[nodiscard]] rg::Image in_graph(rg::GraphBuilder& graph, std::string_view name,
                                     std::vector<rg::ImportBinding>& bindings);

private:
    DensityImage(const rg::DeviceTable& vk, VkDevice device, std::shared_ptr<const DensityTexels> texels)
        : vk_(&vk), device_(device), texels_(std::move(texels)) {}
    [[nodiscard]] VkResult stage(const VkPhysicalDeviceMemoryProperties& memory,
                                 std::span<const std::uint32_t> queue_families);

    const rg::DeviceTable* vk_;
    VkDevice device_;
    std::shared_ptr<const DensityTexels> texels_; ///< kept, so that no others come to stand at its address
    std::unique_ptr<PersistentImage> image_;
    VkBuffer staging_ = VK_NULL_HANDLE;
    VkDeviceMemory staging_memory_ = VK_NULL_HANDLE;
};

} // namespace tyndall::volumetrics
