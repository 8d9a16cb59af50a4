// A volume of texels that the feature keeps from frame to frame, and that the first frame which needs it fills.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "features/volumetrics/error.hpp"
#include "rendergraph/device_table.hpp"
#include "rendergraph/executor.hpp"
#include "rendergraph/graph.hpp"

namespace tyndall::volumetrics {

class PersistentImage {
public:
    [[nodiscard]] static tl::expected<std::unique_ptr<PersistentImage>, Error>
    create(const rg::DeviceTable& vk, VkDevice device, const VkPhysicalDeviceMemoryProperties& memory,
           std::span<const std::uint32_t> queue_families, VkFormat format, VkExtent3D extent);
    PersistentImage(const PersistentImage&) = delete;
    PersistentImage& operator=(const PersistentImage&) = delete;
    ~PersistentImage(); ///< no frame that uses it may be in flight

    [[nodiscard]] VkImage handle() const { return image_; }
    [[nodiscard]] const VkExtent3D& extent() const { return desc_.extent; }

    /// The image in this graph, imported once however many views use it. Where it holds nothing yet, a pass of
    /// the graph must `fill` it.
    [[nodiscard]] rg::Image in_graph(rg::GraphBuilder& graph, std::string_view name,
                                     std::vector<rg::ImportBinding>& bindings);
    /// Whether the graph that it was last imported into is to fill it, and has no pass yet that does.
    [[nodiscard]] bool wants_filling() const { return wants_filling_; }
    /// Declares the pass that copies `texels`, tightly packed, into it, and returns its content.
    rg::Image fill(rg::GraphBuilder& graph, std::string_view name, rg::Buffer texels);

private:
    PersistentImage(const rg::DeviceTable& vk, VkDevice device, const rg::ImageDesc& desc)
        : vk_(&vk), device_(device), desc_(desc) {}

    const rg::DeviceTable* vk_;
    VkDevice device_;
    rg::ImageDesc desc_;
    VkImage image_ = VK_NULL_HANDLE;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    rg::Image handle_; ///< in the last graph
    bool wants_filling_ = false;
    std::atomic<bool> filled_ = false; ///< a frame that fills it has been recorded
};

} // namespace tyndall::volumetrics
