#include "features/volumetrics/host_buffers.hpp"

#include <algorithm>
#include <cstring>
#include <string>

namespace tyndall::volumetrics {
namespace {

Error buffer_error(VkResult result) {
    return {"The device refused the host-written buffers of the volumetrics (VkResult " +
            std::to_string(static_cast<int>(result)) + ")."};
}

} // namespace

int host_memory_type(const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t type_bits) {
    const VkMemoryPropertyFlags wanted = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
        if ((type_bits >> i & 1U) != 0 && (memory.memoryTypes[i].propertyFlags & wanted) == wanted) {
            return static_cast<int>(i);
        }
    }
    return -1;
}

VkResult HostBuffers::make_buffer(const DataInfo& info, std::span<const std::uint32_t> queue_families,
                                  VkBuffer& buffer) {
    const bool shared = queue_families.size() > 1;
    const VkBufferCreateInfo create{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                    .size = info.size_bytes,
                                    .usage = info.usage,
                                    .sharingMode = shared ? VK_SHARING_MODE_CONCURRENT : VK_SHARING_MODE_EXCLUSIVE,
                                    .queueFamilyIndexCount = static_cast<std::uint32_t>(queue_families.size()),
                                    .pQueueFamilyIndices = queue_families.data()};
    return vk_->CreateBuffer(device_, &create, nullptr, &buffer);
}

tl::expected<std::unique_ptr<HostBuffers>, Error>
HostBuffers::create(const rg::DeviceTable& vk, VkDevice device, const VkPhysicalDeviceMemoryProperties& memory,
                    std::uint32_t slots, std::span<const std::uint32_t> queue_families, const DataInfo& data) {
    std::unique_ptr<HostBuffers> self(new HostBuffers(vk, device));
    self->slots_.resize(slots);
    VkResult result = VK_SUCCESS;
    VkDeviceSize alignment = 1;
    VkDeviceSize largest[2] = {}; // of data, of clusters
    std::uint32_t type_bits = ~0U;
    const DataInfo infos[] = {data, {sizeof(gpu::LightClusters), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT}};
    for (Slot& slot : self->slots_) {
        for (const int which : {0, 1}) {
            VkBuffer& buffer = which == 0 ? slot.data : slot.clusters;
            result = self->make_buffer(infos[which], queue_families, buffer);
            if (result != VK_SUCCESS) {
                return tl::unexpected(buffer_error(result));
            }
            VkMemoryRequirements needs{};
            vk.GetBufferMemoryRequirements(device, buffer, &needs);
            alignment = std::max(alignment, needs.alignment);
            largest[which] = std::max(largest[which], needs.size);
            type_bits &= needs.memoryTypeBits;
        }
    }
    const int type = host_memory_type(memory, type_bits);
    if (type < 0) {
        return tl::unexpected(Error{"The device has no coherent host-visible memory for the volumetrics."});
    }
    const auto aligned = [&](VkDeviceSize bytes) { return (bytes + alignment - 1) / alignment * alignment; };
    self->clusters_bytes_ = aligned(largest[0]);
    self->stride_bytes_ = self->clusters_bytes_ + aligned(largest[1]);
    const VkMemoryAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                        .allocationSize = self->stride_bytes_ * slots,
                                        .memoryTypeIndex = static_cast<std::uint32_t>(type)};
    result = vk.AllocateMemory(device, &allocate, nullptr, &self->memory_);
    if (result != VK_SUCCESS) {
        return tl::unexpected(buffer_error(result));
    }
    VkDeviceSize offset = 0;
    for (const Slot& slot : self->slots_) {
        for (const bool clusters : {false, true}) {
            result = vk.BindBufferMemory(device, clusters ? slot.clusters : slot.data, self->memory_,
                                         offset + (clusters ? self->clusters_bytes_ : 0));
            if (result != VK_SUCCESS) {
                return tl::unexpected(buffer_error(result));
            }
        }
        offset += self->stride_bytes_;
    }
    void* mapped = nullptr;
    result = vk.MapMemory(device, self->memory_, 0, VK_WHOLE_SIZE, 0, &mapped);
    if (result != VK_SUCCESS) {
        return tl::unexpected(buffer_error(result));
    }
    self->mapped_ = static_cast<std::byte*>(mapped);
    return self;
}

HostBuffers::~HostBuffers() {
    for (const Slot& slot : slots_) {
        vk_->DestroyBuffer(device_, slot.data, nullptr);
        vk_->DestroyBuffer(device_, slot.clusters, nullptr);
    }
    vk_->FreeMemory(device_, memory_, nullptr);
}

void HostBuffers::write(std::uint32_t slot, std::span<const std::byte> data) {
    std::memcpy(mapped_ + stride_bytes_ * slot, data.data(), data.size());
}

void HostBuffers::write(std::uint32_t slot, const gpu::LightClusters& clusters) {
    std::memcpy(mapped_ + stride_bytes_ * slot + clusters_bytes_, &clusters, sizeof clusters);
}

} // namespace tyndall::volumetrics
