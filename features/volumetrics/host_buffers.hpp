// Data that the host writes each frame: one set of buffers per frame in flight, mapped for good.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <tl/expected.hpp>

#include "features/volumetrics/error.hpp"
#include "rendergraph/device_table.hpp"
#include "shaders/common/light_clusters.h"

namespace tyndall::volumetrics {

/// The first type among `type_bits` that the host sees without flushing; -1 if none.
[[nodiscard]] int host_memory_type(const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t type_bits);

class HostBuffers {
public:
    struct Slot {
        VkBuffer data = VK_NULL_HANDLE;     ///< what `create` was told
        VkBuffer clusters = VK_NULL_HANDLE; ///< gpu::LightClusters
    };
    struct DataInfo {
        VkDeviceSize size_bytes = 0;
        VkBufferUsageFlags usage = 0;
    };

    [[nodiscard]] static tl::expected<std::unique_ptr<HostBuffers>, Error>
    create(const rg::DeviceTable& vk, VkDevice device, const VkPhysicalDeviceMemoryProperties& memory,
           std::uint32_t slots, std::span<const std::uint32_t> queue_families, const DataInfo& data);
    HostBuffers(const HostBuffers&) = delete;
    HostBuffers& operator=(const HostBuffers&) = delete;
    ~HostBuffers(); ///< no frame that reads a slot may be in flight

    [[nodiscard]] std::uint32_t slot_count() const { return static_cast<std::uint32_t>(slots_.size()); }
    [[nodiscard]] const Slot& slot(std::uint32_t slot) const { return slots_[slot]; }
    void write(std::uint32_t slot, std::span<const std::byte> data); ///< from the beginning of the slot's
    void write(std::uint32_t slot, const gpu::LightClusters& clusters);

private:
    HostBuffers(const rg::DeviceTable& vk, VkDevice device) : vk_(&vk), device_(device) {}
    [[nodiscard]] VkResult make_buffer(const DataInfo& info, std::span<const std::uint32_t> queue_families,
                                       VkBuffer& buffer);

    const rg::DeviceTable* vk_;
    VkDevice device_;
    std::vector<Slot> slots_;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    VkDeviceSize clusters_bytes_ = 0; ///< from a slot's data to its clusters
    VkDeviceSize stride_bytes_ = 0;   ///< from one slot to the next
    std::byte* mapped_ = nullptr;
};

} // namespace tyndall::volumetrics
