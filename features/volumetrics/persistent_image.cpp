#include "features/volumetrics/persistent_image.hpp"

#include <string>

namespace tyndall::volumetrics {
namespace {

constexpr VkImageLayout resting_layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;

Error image_error(VkResult result) {
    return {"The device refused an image of the volumetrics (VkResult " + std::to_string(static_cast<int>(result)) +
            ")."};
}

/// The first type among `type_bits` that is the device's own, else any.
std::uint32_t image_memory_type(const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t type_bits) {
    std::uint32_t any = 0;
    for (std::uint32_t i = memory.memoryTypeCount; i > 0; --i) {
        any = (type_bits >> (i - 1) & 1U) != 0 ? i - 1 : any;
    }
    for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
        if ((type_bits >> i & 1U) != 0 &&
            (memory.memoryTypes[i].propertyFlags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) != 0) {
            return i;
        }
    }
    return any;
}

} // namespace

tl::expected<std::unique_ptr<PersistentImage>, Error>
PersistentImage::create(const rg::DeviceTable& vk, VkDevice device, const VkPhysicalDeviceMemoryProperties& memory,
                        std::span<const std::uint32_t> queue_families, VkFormat format, VkExtent3D extent) {
    const rg::ImageDesc desc{.format = format, .extent = extent, .type = VK_IMAGE_TYPE_3D};
    std::unique_ptr<PersistentImage> self(new PersistentImage(vk, device, desc));
    const bool shared = queue_families.size() > 1;
    const VkImageCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                 .imageType = desc.type,
                                 .format = format,
                                 .extent = extent,
                                 .mipLevels = 1,
                                 .arrayLayers = 1,
                                 .samples = VK_SAMPLE_COUNT_1_BIT,
                                 .tiling = VK_IMAGE_TILING_OPTIMAL,
                                 .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                                 .sharingMode = shared ? VK_SHARING_MODE_CONCURRENT : VK_SHARING_MODE_EXCLUSIVE,
                                 .queueFamilyIndexCount = static_cast<std::uint32_t>(queue_families.size()),
                                 .pQueueFamilyIndices = queue_families.data(),
                                 .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED};
    VkResult result = vk.CreateImage(device, &info, nullptr, &self->image_);
    if (result != VK_SUCCESS) {
        return tl::unexpected(image_error(result));
    }
    VkMemoryRequirements needs{};
    vk.GetImageMemoryRequirements(device, self->image_, &needs);
    const VkMemoryAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                        .allocationSize = needs.size,
                                        .memoryTypeIndex = image_memory_type(memory, needs.memoryTypeBits)};
    result = vk.AllocateMemory(device, &allocate, nullptr, &self->memory_);
    if (result == VK_SUCCESS) {
        result = vk.BindImageMemory(device, self->image_, self->memory_, 0);
    }
    if (result != VK_SUCCESS) {
        return tl::unexpected(image_error(result));
    }
    return self;
}

PersistentImage::~PersistentImage() {
    vk_->DestroyImage(device_, image_, nullptr);
    vk_->FreeMemory(device_, memory_, nullptr);
}

rg::Image PersistentImage::in_graph(rg::GraphBuilder& graph, std::string_view name,
                                    std::vector<rg::ImportBinding>& bindings) {
    if (handle_.valid() && graph.describe(handle_)) {
        return handle_;
    }
    // No stages on the way in: its last use was in an earlier frame, after which the executor orders this one whole.
    rg::ImportDesc import{.read_only = filled_};
    if (filled_) {
        import.initial_layout = resting_layout;
    } else {
        import.has_final = true;
        import.final_layout = resting_layout;
        import.final_stages = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
        import.final_access = VK_ACCESS_2_SHADER_SAMPLED_READ_BIT;
    }
    wants_filling_ = !filled_;
    handle_ = graph.import_image(name, desc_, import);
    graph.share_between_queues(handle_);
    bindings.push_back({.resource = handle_.resource, .image = image_});
    return handle_;
}

rg::Image PersistentImage::fill(rg::GraphBuilder& graph, std::string_view name, rg::Buffer texels) {
    auto pass = graph.add_pass(name, rg::PassKind::transfer);
    pass.reads(texels, rg::Access::transfer_source).writes(handle_, rg::Access::transfer_destination);
    pass.executes([=, target = handle_, extent = desc_.extent, filled = &filled_](rg::PassContext& ctx) {
        const VkBufferImageCopy2 region{.sType = VK_STRUCTURE_TYPE_BUFFER_IMAGE_COPY_2,
                                        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                        .imageExtent = extent};
        const VkCopyBufferToImageInfo2 copy{.sType = VK_STRUCTURE_TYPE_COPY_BUFFER_TO_IMAGE_INFO_2,
                                            .srcBuffer = ctx.buffer(texels),
                                            .dstImage = ctx.image(target),
                                            .dstImageLayout = ctx.layout(target),
                                            .regionCount = 1,
                                            .pRegions = &region};
        ctx.vk().CmdCopyBufferToImage2(ctx.cmd(), &copy);
        *filled = true;
    });
    wants_filling_ = false;
    return handle_;
}

} // namespace tyndall::volumetrics
