#include "features/volumetrics/density_image.hpp"

#include <cstring>
#include <string>

#include "features/volumetrics/host_buffers.hpp"

namespace tyndall::volumetrics {

VkResult DensityImage::stage(const VkPhysicalDeviceMemoryProperties& memory,
                             std::span<const std::uint32_t> queue_families) {
    const bool shared = queue_families.size() > 1;
    const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                  .size = texels_->values().size(),
                                  .usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                                  .sharingMode = shared ? VK_SHARING_MODE_CONCURRENT : VK_SHARING_MODE_EXCLUSIVE,
                                  .queueFamilyIndexCount = static_cast<std::uint32_t>(queue_families.size()),
                                  .pQueueFamilyIndices = queue_families.data()};
    VkResult result = vk_->CreateBuffer(device_, &info, nullptr, &staging_);
    if (result != VK_SUCCESS) {
        return result;
    }
    VkMemoryRequirements needs{};
    vk_->GetBufferMemoryRequirements(device_, staging_, &needs);
    const int type = host_memory_type(memory, needs.memoryTypeBits);
    if (type < 0) {
        return VK_ERROR_FEATURE_NOT_PRESENT;
    }
    const VkMemoryAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                        .allocationSize = needs.size,
                                        .memoryTypeIndex = static_cast<std::uint32_t>(type)};
    result = vk_->AllocateMemory(device_, &allocate, nullptr, &staging_memory_);
    if (result == VK_SUCCESS) {
        result = vk_->BindBufferMemory(device_, staging_, staging_memory_, 0);
    }
    void* mapped = nullptr;
    if (result == VK_SUCCESS) {
        result = vk_->MapMemory(device_, staging_memory_, 0, VK_WHOLE_SIZE, 0, &mapped);
    }
    if (result == VK_SUCCESS) {
        std::memcpy(mapped, texels_->values().data(), texels_->values().size());
        vk_->UnmapMemory(device_, staging_memory_);
    }
    return result;
}

tl::expected<std::unique_ptr<DensityImage>, Error> DensityImage::create(const rg::DeviceTable& vk, VkDevice device,
                                                                        const VkPhysicalDeviceMemoryProperties& memory,
                                                                        std::span<const std::uint32_t> queue_families,
                                                                        std::shared_ptr<const DensityTexels> texels) {
    const glm::uvec3& size = texels->size();
    auto image =
        PersistentImage::create(vk, device, memory, queue_families, VK_FORMAT_R8_UNORM, {size.x, size.y, size.z});
    if (!image) {
        return tl::unexpected(image.error());
    }
    std::unique_ptr<DensityImage> self(new DensityImage(vk, device, std::move(texels)));
    self->image_ = std::move(*image);
    if (const VkResult result = self->stage(memory, queue_families); result != VK_SUCCESS) {
        return tl::unexpected(Error{"The device refused memory for densities of the volumetrics (VkResult " +
                                    std::to_string(static_cast<int>(result)) + ")."});
    }
    return self;
}

DensityImage::~DensityImage() {
    vk_->DestroyBuffer(device_, staging_, nullptr);
    vk_->FreeMemory(device_, staging_memory_, nullptr);
}

rg::Image DensityImage::in_graph(rg::GraphBuilder& graph, std::string_view name,
                                 std::vector<rg::ImportBinding>& bindings) {
    const rg::Image image = image_->in_graph(graph, name, bindings);
    if (!image_->wants_filling()) {
        return image;
    }
    const std::string texels = std::string(name) + " texels";
    const rg::Buffer staged =
        graph.import_buffer(texels, {.size_bytes = texels_->values().size()}, {.read_only = true});
    graph.share_between_queues(staged);
    bindings.push_back({.resource = staged.resource, .buffer = staging_});
    return image_->fill(graph, std::string(name) + " copy", staged);
}

} // namespace tyndall::volumetrics
