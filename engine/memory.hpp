// Buffers and images of the engine itself, each with memory of its own.
#pragma once

#include <cstdint>
#include <span>

#include <tl/expected.hpp>
#include <vulkan/vulkan.h>

#include "engine/device.hpp"
#include "engine/error.hpp"

namespace tyndall::engine {

enum class MemoryUse : std::uint8_t {
    device,   ///< the device alone touches it
    upload,   ///< mapped, written by the host
    readback, ///< mapped, read by the host; cached where the device has such memory
};

/// Move-only; freed with the object. Mapped memory is coherent.
class Buffer {
public:
    [[nodiscard]] static tl::expected<Buffer, Error> create(const Device& device, VkDeviceSize size_bytes,
                                                            VkBufferUsageFlags usage, MemoryUse use);
    Buffer() = default;
    Buffer(Buffer&& other) noexcept { *this = std::move(other); }
    Buffer& operator=(Buffer&& other) noexcept;
    Buffer(const Buffer&) = delete;
    Buffer& operator=(const Buffer&) = delete;
    ~Buffer();

    [[nodiscard]] VkBuffer handle() const { return buffer_; }
    [[nodiscard]] VkDeviceSize size_bytes() const { return size_bytes_; }
    /// Empty for device memory.
    [[nodiscard]] std::span<std::byte> mapped() const {
        return {static_cast<std::byte*>(mapped_), mapped_ == nullptr ? 0 : static_cast<std::size_t>(size_bytes_)};
    }
    template <typename T>
    [[nodiscard]] std::span<T> mapped_as() const {
        return {static_cast<T*>(mapped_), mapped_ == nullptr ? 0 : static_cast<std::size_t>(size_bytes_) / sizeof(T)};
    }

private:
    const Device* device_ = nullptr;
    VkBuffer buffer_ = VK_NULL_HANDLE;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    VkDeviceSize size_bytes_ = 0;
    void* mapped_ = nullptr;
};

struct ImageInfo {
    VkFormat format = VK_FORMAT_R8G8B8A8_UNORM;
    VkExtent3D extent = {1, 1, 1};
    std::uint32_t mips = 1;
    std::uint32_t layers = 1;
    VkImageUsageFlags usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    VkImageType type = VK_IMAGE_TYPE_2D;
    VkImageCreateFlags flags = 0;
    bool shared_between_queues = false; ///< used by several queue families without handing over the ownership
};

/// An image in device memory with a view of all of it. Move-only.
class DeviceImage {
public:
    [[nodiscard]] static tl::expected<DeviceImage, Error> create(const Device& device, const ImageInfo& info);
    DeviceImage() = default;
    DeviceImage(DeviceImage&& other) noexcept { *this = std::move(other); }
    DeviceImage& operator=(DeviceImage&& other) noexcept;
    DeviceImage(const DeviceImage&) = delete;
    DeviceImage& operator=(const DeviceImage&) = delete;
    ~DeviceImage();

    [[nodiscard]] VkImage handle() const { return image_; }
    [[nodiscard]] VkImageView view() const { return view_; }
    [[nodiscard]] const ImageInfo& info() const { return info_; }

private:
    const Device* device_ = nullptr;
    VkImage image_ = VK_NULL_HANDLE;
    VkImageView view_ = VK_NULL_HANDLE;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    ImageInfo info_;
};

} // namespace tyndall::engine
