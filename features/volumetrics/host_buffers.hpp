// The uniform data that the host writes each frame: one set of buffers per frame in flight, mapped for good.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <tl/expected.hpp>

#include "features/volumetrics/error.hpp"
#include "rendergraph/device_table.hpp"
#include "shaders/volumetrics/interop.h"

namespace tyndall::volumetrics {

/// The first type among `type_bits` that the host sees without flushing; -1 if none.
[[nodiscard]] int host_memory_type(const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t type_bits);

class HostBuffers {
public:
    struct Slot {
        VkBuffer parameters = VK_NULL_HANDLE; ///< gpu::VolumetricParameters
        VkBuffer clusters = VK_NULL_HANDLE;   ///< gpu::LightClusters
    };

    [[nodiscard]] static tl::expected<std::unique_ptr<HostBuffers>, Error>
    create(const rg::DeviceTable& vk, VkDevice device, const VkPhysicalDeviceMemoryProperties& memory,
           std::uint32_t slots, std::span<const std::uint32_t> queue_families);
    HostBuffers(const HostBuffers&) = delete;
    HostBuffers& operator=(const HostBuffers&) = delete;
    ~HostBuffers(); ///< no frame that reads a slot may be in flight

    [[nodiscard]] std::uint32_t slot_count() const { return static_cast<std::uint32_t>(slots_.size()); }
    [[nodiscard]] const Slot& slot(std::uint32_t slot) const { return slots_[slot]; }
    void write(std::uint32_t slot, const gpu::VolumetricParameters& parameters);
    void write(std::uint32_t slot, const gpu::LightClusters& clusters);

private:
    HostBuffers(const rg::DeviceTable& vk, VkDevice device) : vk_(&vk), device_(device) {}
    [[nodiscard]] VkResult make_buffer(VkDeviceSize size_bytes, std::span<const std::uint32_t> queue_families,
                                       VkBuffer& buffer);

    const rg::DeviceTable* vk_;
    VkDevice device_;
    std::vector<Slot> slots_;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    VkDeviceSize stride_bytes_ = 0; ///< from one buffer to the next: parameters and clusters of slot 0, of slot 1, ...
    std::byte* mapped_ = nullptr;
};

} // namespace tyndall::volumetrics
