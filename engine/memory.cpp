#include "engine/memory.hpp"

#include <array>
#include <string>
#include <utility>

#include "rendergraph/access.hpp"

namespace tyndall::engine {
namespace {

/// The first memory type with the most wanted properties that fits; ~0 if none does.
std::uint32_t memory_type(const Device& device, std::uint32_t bits, MemoryUse use) {
    constexpr VkMemoryPropertyFlags mapped = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    std::array<VkMemoryPropertyFlags, 2> wanted{};
    switch (use) {
    case MemoryUse::device: wanted = {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0}; break;
    case MemoryUse::upload: wanted = {mapped, mapped}; break;
    case MemoryUse::readback: wanted = {mapped | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, mapped}; break;
    }
    const VkPhysicalDeviceMemoryProperties& memory = device.memory_properties();
    for (const VkMemoryPropertyFlags flags : wanted) {
        for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
            if ((bits & (1U << i)) != 0 && (memory.memoryTypes[i].propertyFlags & flags) == flags) {
                return i;
            }
        }
    }
    return ~0U;
}

std::string mebibytes(VkDeviceSize bytes) {
    return std::to_string((bytes + (1U << 20U) - 1) >> 20U) + " MiB";
}

tl::expected<VkDeviceMemory, Error> allocate(const Device& device, const VkMemoryRequirements& needs, MemoryUse use) {
    const std::uint32_t type = memory_type(device, needs.memoryTypeBits, use);
    if (type == ~0U) {
        return tl::unexpected(Error{"Device '" + device.info().name + "' has no memory of the kind that is needed"});
    }
    const VkMemoryAllocateInfo info{
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size, .memoryTypeIndex = type};
    VkDeviceMemory memory = VK_NULL_HANDLE;
    if (device.vk().AllocateMemory(device.handle(), &info, nullptr, &memory) != VK_SUCCESS) {
        return tl::unexpected(Error{"Device '" + device.info().name + "' is out of memory: " + mebibytes(needs.size) +
                                    " were asked for"});
    }
    return memory;
}

} // namespace

tl::expected<Buffer, Error> Buffer::create(const Device& device, VkDeviceSize size_bytes, VkBufferUsageFlags usage,
                                           MemoryUse use) {
    Buffer buffer;
    buffer.device_ = &device;
    buffer.size_bytes_ = size_bytes == 0 ? 4 : size_bytes; // Vulkan has no empty buffers
    // Buffers are read by passes on any queue, and sharing costs a buffer nothing.
    const std::vector<std::uint32_t> families = device.queue_families();
    const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                  .size = buffer.size_bytes_,
                                  .usage = usage,
                                  .sharingMode =
                                      families.size() > 1 ? VK_SHARING_MODE_CONCURRENT : VK_SHARING_MODE_EXCLUSIVE,
                                  .queueFamilyIndexCount = static_cast<std::uint32_t>(families.size()),
                                  .pQueueFamilyIndices = families.data()};
    const rg::DeviceTable& vk = device.vk();
    if (vk.CreateBuffer(device.handle(), &info, nullptr, &buffer.buffer_) != VK_SUCCESS) {
        return tl::unexpected(Error{"No buffer of " + mebibytes(size_bytes) + " could be made"});
    }
    VkMemoryRequirements needs;
    vk.GetBufferMemoryRequirements(device.handle(), buffer.buffer_, &needs);
    tl::expected<VkDeviceMemory, Error> memory = allocate(device, needs, use);
    if (!memory) {
        return tl::unexpected(memory.error());
    }
    buffer.memory_ = *memory;
    if (vk.BindBufferMemory(device.handle(), buffer.buffer_, buffer.memory_, 0) != VK_SUCCESS ||
        (use != MemoryUse::device &&
         vk.MapMemory(device.handle(), buffer.memory_, 0, VK_WHOLE_SIZE, 0, &buffer.mapped_) != VK_SUCCESS)) {
        return tl::unexpected(Error{"A buffer of " + mebibytes(size_bytes) + " could not be mapped"});
    }
    return buffer;
}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(buffer_, other.buffer_);
    std::swap(memory_, other.memory_);
    std::swap(size_bytes_, other.size_bytes_);
    std::swap(mapped_, other.mapped_);
    return *this;
}

Buffer::~Buffer() {
    if (device_ != nullptr) {
        device_->vk().DestroyBuffer(device_->handle(), buffer_, nullptr);
        device_->vk().FreeMemory(device_->handle(), memory_, nullptr);
    }
}

tl::expected<DeviceImage, Error> DeviceImage::create(const Device& device, const ImageInfo& info) {
    DeviceImage image;
    image.device_ = &device;
    image.info_ = info;
    const std::vector<std::uint32_t> families = device.queue_families();
    const bool shared = info.shared_between_queues && families.size() > 1;
    const VkImageCreateInfo create{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                   .flags = info.flags,
                                   .imageType = info.type,
                                   .format = info.format,
                                   .extent = info.extent,
                                   .mipLevels = info.mips,
                                   .arrayLayers = info.layers,
                                   .samples = VK_SAMPLE_COUNT_1_BIT,
                                   .tiling = VK_IMAGE_TILING_OPTIMAL,
                                   .usage = info.usage,
                                   .sharingMode = shared ? VK_SHARING_MODE_CONCURRENT : VK_SHARING_MODE_EXCLUSIVE,
                                   .queueFamilyIndexCount = static_cast<std::uint32_t>(families.size()),
                                   .pQueueFamilyIndices = families.data(),
                                   .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED};
    const rg::DeviceTable& vk = device.vk();
    const std::string size = std::to_string(info.extent.width) + "x" + std::to_string(info.extent.height);
    if (vk.CreateImage(device.handle(), &create, nullptr, &image.image_) != VK_SUCCESS) {
        return tl::unexpected(Error{"No image of " + size + " could be made"});
    }
    VkMemoryRequirements needs;
    vk.GetImageMemoryRequirements(device.handle(), image.image_, &needs);
    tl::expected<VkDeviceMemory, Error> memory = allocate(device, needs, MemoryUse::device);
    if (!memory) {
        return tl::unexpected(memory.error());
    }
    image.memory_ = *memory;
    const VkImageViewType view_type = info.type == VK_IMAGE_TYPE_3D ? VK_IMAGE_VIEW_TYPE_3D
                                      : info.layers > 1             ? VK_IMAGE_VIEW_TYPE_2D_ARRAY
                                                                    : VK_IMAGE_VIEW_TYPE_2D;
    const VkImageViewCreateInfo view{
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = image.image_,
        .viewType = view_type,
        .format = info.format,
        .subresourceRange = {rg::format_aspects(info.format), 0, info.mips, 0, info.layers}};
    if (vk.BindImageMemory(device.handle(), image.image_, image.memory_, 0) != VK_SUCCESS ||
        vk.CreateImageView(device.handle(), &view, nullptr, &image.view_) != VK_SUCCESS) {
        return tl::unexpected(Error{"No view of an image of " + size + " could be made"});
    }
    return image;
}

DeviceImage& DeviceImage::operator=(DeviceImage&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(image_, other.image_);
    std::swap(view_, other.view_);
    std::swap(memory_, other.memory_);
    std::swap(info_, other.info_);
    return *this;
}

DeviceImage::~DeviceImage() {
    if (device_ != nullptr) {
        device_->vk().DestroyImageView(device_->handle(), view_, nullptr);
        device_->vk().DestroyImage(device_->handle(), image_, nullptr);
        device_->vk().FreeMemory(device_->handle(), memory_, nullptr);
    }
}

} // namespace tyndall::engine
