#include "engine/read_back.hpp"

#include "engine/one_time_commands.hpp"
#include "engine/transition.hpp"
#include "rendergraph/access.hpp"

namespace tyndall::engine {
namespace {

/// Runs `record(commands, destination)` and returns what the destination then holds.
template <typename Record>
tl::expected<std::vector<std::byte>, Error> read(const Device& device, VkDeviceSize size_bytes, Record&& record) {
    const tl::expected<Buffer, Error> destination =
        Buffer::create(device, size_bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryUse::readback);
    if (!destination) {
        return tl::unexpected(destination.error());
    }
    tl::expected<OneTimeCommands, Error> commands = OneTimeCommands::begin(device);
    if (!commands) {
        return tl::unexpected(commands.error());
    }
    record(*commands, destination->handle());
    if (const tl::expected<void, Error> done = commands->finish(); !done) {
        return tl::unexpected(done.error());
    }
    const std::span<std::byte> mapped = destination->mapped();
    return std::vector<std::byte>(mapped.begin(), mapped.end());
}

} // namespace

tl::expected<std::vector<std::byte>, Error> read_image(const Device& device, VkImage image, const ImagePart& part) {
    const VkImageAspectFlags aspects = rg::format_aspects(part.format);
    const VkImageSubresourceRange range{aspects, part.mip, 1, part.layer, 1};
    const VkDeviceSize size_bytes =
        VkDeviceSize{part.extent.width} * part.extent.height * part.extent.depth * rg::format_texel_bytes(part.format);
    return read(device, size_bytes, [&](const OneTimeCommands& commands, VkBuffer destination) {
        transition(device, commands.cmd(), image, range, part.layout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
        const VkBufferImageCopy2 region{.sType = VK_STRUCTURE_TYPE_BUFFER_IMAGE_COPY_2,
                                        .imageSubresource = {aspects, part.mip, part.layer, 1},
                                        .imageExtent = part.extent};
        const VkCopyImageToBufferInfo2 copy{.sType = VK_STRUCTURE_TYPE_COPY_IMAGE_TO_BUFFER_INFO_2,
                                            .srcImage = image,
                                            .srcImageLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                            .dstBuffer = destination,
                                            .regionCount = 1,
                                            .pRegions = &region};
        device.vk().CmdCopyImageToBuffer2(commands.cmd(), &copy);
        transition(device, commands.cmd(), image, range, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, part.layout);
    });
}

tl::expected<std::vector<std::byte>, Error> read_buffer(const Device& device, const Buffer& buffer) {
    return read(device, buffer.size_bytes(), [&](const OneTimeCommands& commands, VkBuffer destination) {
        const VkBufferCopy copy{0, 0, buffer.size_bytes()};
        device.vk().CmdCopyBuffer(commands.cmd(), buffer.handle(), destination, 1, &copy);
    });
}

} // namespace tyndall::engine
