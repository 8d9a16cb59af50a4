#include "engine/particle_buffer.hpp"

#include <cstring>
#include <optional>
#include <string>
#include <utility>

namespace tyndall::engine {
namespace {

Error buffer_error(VkResult result) {
    return {"The device refused a buffer of the particles (VkResult " + std::to_string(static_cast<int>(result)) +
            ")."};
}

/// The first type among `type_bits` that the host writes without flushing.
std::optional<std::uint32_t> host_memory_type(const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t type_bits) {
    constexpr VkMemoryPropertyFlags wanted = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
        if ((type_bits >> i & 1U) != 0 && (memory.memoryTypes[i].propertyFlags & wanted) == wanted) {
            return i;
        }
    }
    return std::nullopt;
}

} // namespace

tl::expected<ParticleBuffer, Error> ParticleBuffer::create(const ParticleDevice& device, VkDeviceSize size_bytes) {
    ParticleBuffer made(device);
    made.size_bytes_ = size_bytes;
    const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                  .size = size_bytes,
                                  .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                  .sharingMode = VK_SHARING_MODE_EXCLUSIVE};
    VkResult result = device.vk->CreateBuffer(device.device, &info, nullptr, &made.buffer_);
    if (result != VK_SUCCESS) {
        return tl::unexpected(buffer_error(result));
    }
    VkMemoryRequirements needs{};
    device.vk->GetBufferMemoryRequirements(device.device, made.buffer_, &needs);
    const std::optional<std::uint32_t> type = host_memory_type(device.memory, needs.memoryTypeBits);
    if (!type) {
        return tl::unexpected(Error{"The device has no coherent host-visible memory for particles."});
    }
    const VkMemoryAllocateInfo allocate{
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size, .memoryTypeIndex = *type};
    result = device.vk->AllocateMemory(device.device, &allocate, nullptr, &made.memory_);
    if (result == VK_SUCCESS) {
        result = device.vk->BindBufferMemory(device.device, made.buffer_, made.memory_, 0);
    }
    void* mapped = nullptr;
    if (result == VK_SUCCESS) {
        result = device.vk->MapMemory(device.device, made.memory_, 0, VK_WHOLE_SIZE, 0, &mapped);
    }
    if (result != VK_SUCCESS) {
        return tl::unexpected(buffer_error(result));
    }
    made.mapped_ = static_cast<std::byte*>(mapped);
    return made;
}

ParticleBuffer::ParticleBuffer(ParticleBuffer&& other) noexcept
    : device_(other.device_), buffer_(std::exchange(other.buffer_, VK_NULL_HANDLE)),
      memory_(std::exchange(other.memory_, VK_NULL_HANDLE)), mapped_(std::exchange(other.mapped_, nullptr)),
      size_bytes_(std::exchange(other.size_bytes_, 0)) {}

ParticleBuffer& ParticleBuffer::operator=(ParticleBuffer&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(buffer_, other.buffer_);
    std::swap(memory_, other.memory_);
    std::swap(mapped_, other.mapped_);
    std::swap(size_bytes_, other.size_bytes_);
    return *this;
}

ParticleBuffer::~ParticleBuffer() {
    device_.vk->DestroyBuffer(device_.device, buffer_, nullptr);
    device_.vk->FreeMemory(device_.device, memory_, nullptr);
}

void ParticleBuffer::write(VkDeviceSize offset_bytes, std::span<const std::byte> bytes) {
    if (!bytes.empty()) {
        std::memcpy(mapped_ + offset_bytes, bytes.data(), bytes.size());
    }
}

} // namespace tyndall::engine
