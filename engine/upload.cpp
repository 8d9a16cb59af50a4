#include "engine/upload.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <utility>

#include "engine/transition.hpp"
#include "rendergraph/access.hpp"

namespace tyndall::engine {
namespace {

/// Staging memory is let go in portions, so that a large scene does not need it twice over.
constexpr VkDeviceSize staging_limit_bytes = 256ULL << 20U;

constexpr VkImageSubresourceRange color_mips(std::uint32_t first, std::uint32_t count) {
    return {VK_IMAGE_ASPECT_COLOR_BIT, first, count, 0, 1};
}

VkOffset3D corner(VkExtent2D extent, std::uint32_t mip) {
    return {static_cast<std::int32_t>(std::max(extent.width >> mip, 1U)),
            static_cast<std::int32_t>(std::max(extent.height >> mip, 1U)), 1};
}

} // namespace

tl::expected<Uploader, Error> Uploader::create(const Device& device) {
    Uploader uploader;
    uploader.device_ = &device;
    const VkCommandPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                       .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
                                       .queueFamilyIndex = device.graphics_queue().family};
    if (device.vk().CreateCommandPool(device.handle(), &info, nullptr, &uploader.pool_) != VK_SUCCESS) {
        return tl::unexpected(Error{"No command pool for uploads could be made"});
    }
    return uploader;
}

Uploader::Uploader(Uploader&& other) noexcept
    : device_(other.device_), pool_(std::exchange(other.pool_, VK_NULL_HANDLE)),
      cmd_(std::exchange(other.cmd_, VK_NULL_HANDLE)), staging_(std::move(other.staging_)),
      staged_bytes_(other.staged_bytes_) {}

Uploader::~Uploader() {
    if (pool_ != VK_NULL_HANDLE) {
        device_->vk().DestroyCommandPool(device_->handle(), pool_, nullptr);
    }
}

tl::expected<VkCommandBuffer, Error> Uploader::recording() {
    if (cmd_ != VK_NULL_HANDLE) {
        return cmd_;
    }
    const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                           .commandPool = pool_,
                                           .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                           .commandBufferCount = 1};
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    if (device_->vk().AllocateCommandBuffers(device_->handle(), &info, &cmd_) != VK_SUCCESS ||
        device_->vk().BeginCommandBuffer(cmd_, &begin) != VK_SUCCESS) {
        return tl::unexpected(Error{"No command buffer for uploads could be made"});
    }
    return cmd_;
}

tl::expected<Buffer*, Error> Uploader::stage(std::span<const std::byte> content) {
    if (staged_bytes_ + content.size() > staging_limit_bytes) {
        if (tl::expected<void, Error> done = finish(); !done) {
            return tl::unexpected(done.error());
        }
    }
    tl::expected<Buffer, Error> buffer =
        Buffer::create(*device_, content.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, MemoryUse::upload);
    if (!buffer) {
        return tl::unexpected(buffer.error());
    }
    std::memcpy(buffer->mapped().data(), content.data(), content.size());
    staged_bytes_ += content.size();
    staging_.push_back(std::move(*buffer));
    return &staging_.back();
}

tl::expected<Buffer, Error> Uploader::buffer(std::span<const std::byte> content, VkBufferUsageFlags usage) {
    tl::expected<Buffer, Error> made =
        Buffer::create(*device_, content.size(), usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryUse::device);
    if (!made || content.empty()) {
        return made;
    }
    const tl::expected<Buffer*, Error> staged = stage(content);
    if (!staged) {
        return tl::unexpected(staged.error());
    }
    const tl::expected<VkCommandBuffer, Error> cmd = recording();
    if (!cmd) {
        return tl::unexpected(cmd.error());
    }
    const VkBufferCopy copy{0, 0, content.size()};
    device_->vk().CmdCopyBuffer(*cmd, (*staged)->handle(), made->handle(), 1, &copy);
    return made;
}

namespace {

tl::expected<void, Error> check_texture(const Device& device, std::size_t size_bytes, VkFormat format,
                                        VkExtent2D extent, bool levels) {
    const std::uint32_t limit = device.properties().limits.maxImageDimension2D;
    const std::string size = std::to_string(extent.width) + "x" + std::to_string(extent.height);
    if (extent.width == 0 || extent.height == 0 || extent.width > limit || extent.height > limit) {
        return tl::unexpected(Error{"A texture of " + size + " cannot be made: device '" + device.info().name +
                                    "' takes 1 to " + std::to_string(limit) + " texels a side"});
    }
    const std::size_t needed = std::size_t{extent.width} * extent.height * rg::format_texel_bytes(format);
    if (size_bytes != needed) {
        return tl::unexpected(Error{"A texture of " + size + " needs " + std::to_string(needed) + " bytes, and " +
                                    std::to_string(size_bytes) + " were given"});
    }
    VkFormatProperties properties;
    vkGetPhysicalDeviceFormatProperties(device.physical(), format, &properties);
    VkFormatFeatureFlags uses = VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT;
    if (levels) {
        uses |= VK_FORMAT_FEATURE_BLIT_SRC_BIT | VK_FORMAT_FEATURE_BLIT_DST_BIT |
                VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT;
    }
    if ((properties.optimalTilingFeatures & uses) != uses) {
        return tl::unexpected(Error{"Device '" + device.info().name + "' cannot " +
                                    (levels ? "make the levels of" : "sample") + " textures of VkFormat " +
                                    std::to_string(format)});
    }
    return {};
}

} // namespace

tl::expected<DeviceImage, Error> Uploader::texture(std::span<const std::byte> texels, VkFormat format,
                                                   VkExtent2D extent, bool levels) {
    if (const tl::expected<void, Error> fits = check_texture(*device_, texels.size(), format, extent, levels); !fits) {
        return tl::unexpected(fits.error());
    }
    const auto mips = levels ? static_cast<std::uint32_t>(std::bit_width(std::max(extent.width, extent.height))) : 1U;
    tl::expected<DeviceImage, Error> image =
        DeviceImage::create(*device_, {.format = format,
                                       .extent = {extent.width, extent.height, 1},
                                       .mips = mips,
                                       .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                                                VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    if (!image) {
        return image;
    }
    const tl::expected<Buffer*, Error> staged = stage(texels);
    if (!staged) {
        return tl::unexpected(staged.error());
    }
    const tl::expected<VkCommandBuffer, Error> cmd = recording();
    if (!cmd) {
        return tl::unexpected(cmd.error());
    }
    const rg::DeviceTable& vk = device_->vk();
    transition(*device_, *cmd, image->handle(), color_mips(0, mips), VK_IMAGE_LAYOUT_UNDEFINED,
               VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    const VkBufferImageCopy2 region{.sType = VK_STRUCTURE_TYPE_BUFFER_IMAGE_COPY_2,
                                    .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                    .imageExtent = {extent.width, extent.height, 1}};
    const VkCopyBufferToImageInfo2 copy{.sType = VK_STRUCTURE_TYPE_COPY_BUFFER_TO_IMAGE_INFO_2,
                                        .srcBuffer = (*staged)->handle(),
                                        .dstImage = image->handle(),
                                        .dstImageLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                        .regionCount = 1,
                                        .pRegions = &region};
    vk.CmdCopyBufferToImage2(*cmd, &copy);
    for (std::uint32_t mip = 1; mip < mips; ++mip) {
        transition(*device_, *cmd, image->handle(), color_mips(mip - 1, 1), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                   VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
        const VkImageBlit2 halve{.sType = VK_STRUCTURE_TYPE_IMAGE_BLIT_2,
                                 .srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, mip - 1, 0, 1},
                                 .srcOffsets = {{0, 0, 0}, corner(extent, mip - 1)},
                                 .dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, mip, 0, 1},
                                 .dstOffsets = {{0, 0, 0}, corner(extent, mip)}};
        const VkBlitImageInfo2 blit{.sType = VK_STRUCTURE_TYPE_BLIT_IMAGE_INFO_2,
                                    .srcImage = image->handle(),
                                    .srcImageLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                    .dstImage = image->handle(),
                                    .dstImageLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                    .regionCount = 1,
                                    .pRegions = &halve,
                                    .filter = VK_FILTER_LINEAR};
        vk.CmdBlitImage2(*cmd, &blit);
    }
    if (mips > 1) {
        transition(*device_, *cmd, image->handle(), color_mips(0, mips - 1), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                   VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    }
    transition(*device_, *cmd, image->handle(), color_mips(mips - 1, 1), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
               VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    return image;
}

tl::expected<void, Error> Uploader::finish() {
    if (cmd_ == VK_NULL_HANDLE) {
        return {};
    }
    const rg::DeviceTable& vk = device_->vk();
    // Later submissions find the content: waiting on the host alone makes it visible to the host alone.
    const VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                   .srcStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                   .srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                   .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                   .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
    const VkDependencyInfo dependency{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
    vk.CmdPipelineBarrier2(cmd_, &dependency);
    const VkCommandBufferSubmitInfo buffer{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                           .commandBuffer = cmd_};
    const VkSubmitInfo2 submit{
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &buffer};
    if (vk.EndCommandBuffer(cmd_) != VK_SUCCESS ||
        vk.QueueSubmit2(device_->graphics_queue().queue, 1, &submit, VK_NULL_HANDLE) != VK_SUCCESS ||
        vk.QueueWaitIdle(device_->graphics_queue().queue) != VK_SUCCESS) {
        return tl::unexpected(Error{"The device was lost while the scene was uploaded"});
    }
    vk.FreeCommandBuffers(device_->handle(), pool_, 1, &cmd_);
    cmd_ = VK_NULL_HANDLE;
    staging_.clear();
    staged_bytes_ = 0;
    return {};
}

} // namespace tyndall::engine
