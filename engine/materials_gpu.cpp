#include "engine/materials_gpu.hpp"

#include <array>
#include <cstring>
#include <string>

namespace tyndall::engine {
namespace {

constexpr std::uint32_t texture_slots = 7;

/// In the order of the slots.
std::array<const std::optional<TextureUse>*, texture_slots> texture_uses(const Material& m) {
    return {&m.base_color, &m.metallic_roughness, &m.normal, &m.occlusion, &m.emission, &m.specular, &m.specular_color};
}

bool reads_plain_uv(const TextureUse& use) {
    const TextureUse plain;
    return use.uv_set == 0 && use.uv_row_u == plain.uv_row_u && use.uv_row_v == plain.uv_row_v;
}

VkDeviceSize aligned(VkDeviceSize size, VkDeviceSize alignment) {
    return (size + alignment - 1) / alignment * alignment;
}

tl::expected<DescriptorPool, Error> make_pool(const Device& device, std::uint32_t sets) {
    const std::array<VkDescriptorPoolSize, 2> sizes = {
        {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, sets}, {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, sets * texture_slots}}};
    const VkDescriptorPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                          .maxSets = sets,
                                          .poolSizeCount = static_cast<std::uint32_t>(sizes.size()),
                                          .pPoolSizes = sizes.data()};
    VkDescriptorPool pool = VK_NULL_HANDLE;
    const VkResult result = device.vk().CreateDescriptorPool(device.handle(), &info, nullptr, &pool);
    if (result != VK_SUCCESS) {
        return tl::unexpected(Error{"The device has no room for the descriptors of " + std::to_string(sets) +
                                    " materials (VkResult " + std::to_string(static_cast<int>(result)) + ")."});
    }
    return DescriptorPool(device, pool);
}

tl::expected<DescriptorSetLayout, Error> make_layout(const Device& device) {
    constexpr VkShaderStageFlags stages = VK_SHADER_STAGE_FRAGMENT_BIT;
    std::array<VkDescriptorSetLayoutBinding, 1 + texture_slots> bindings{};
    bindings[0] = {0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1, stages, nullptr};
    for (std::uint32_t slot = 0; slot < texture_slots; ++slot) {
        bindings[1 + slot] = {1 + slot, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, stages, nullptr};
    }
    return create_set_layout(device, bindings, false);
}

void write_set(const Device& device, VkDescriptorSet set, const VkDescriptorBufferInfo& parameters,
               const Material& material, const TexturesGpu& textures) {
    std::array<VkWriteDescriptorSet, 1 + texture_slots> writes{};
    writes[0] = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                 .dstSet = set,
                 .dstBinding = 0,
                 .descriptorCount = 1,
                 .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
                 .pBufferInfo = &parameters};
    const auto uses = texture_uses(material);
    for (std::uint32_t slot = 0; slot < texture_slots; ++slot) {
        const std::optional<TextureUse>& use = *uses[slot];
        writes[1 + slot] = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                            .dstSet = set,
                            .dstBinding = 1 + slot,
                            .descriptorCount = 1,
                            .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                            .pImageInfo = use ? &textures.textures[use->texture] : &textures.white};
    }
    device.vk().UpdateDescriptorSets(device.handle(), static_cast<std::uint32_t>(writes.size()), writes.data(), 0,
                                     nullptr);
}

tl::expected<std::vector<VkDescriptorSet>, Error> allocate_sets(const Device& device, VkDescriptorPool pool,
                                                                VkDescriptorSetLayout layout, std::size_t count) {
    const std::vector<VkDescriptorSetLayout> layouts(count, layout);
    const VkDescriptorSetAllocateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                           .descriptorPool = pool,
                                           .descriptorSetCount = static_cast<std::uint32_t>(count),
                                           .pSetLayouts = layouts.data()};
    std::vector<VkDescriptorSet> sets(count);
    const VkResult result = device.vk().AllocateDescriptorSets(device.handle(), &info, sets.data());
    if (result != VK_SUCCESS) {
        return tl::unexpected(Error{"The descriptors of " + std::to_string(count) +
                                    " materials could not be made (VkResult " +
                                    std::to_string(static_cast<int>(result)) + ")."});
    }
    return sets;
}

} // namespace

gpu::GpuMaterial make_gpu_material(const Material& material) {
    gpu::GpuMaterial out{};
    out.base_color = material.base_color_factor;
    const bool mask = material.alpha_mode == AlphaMode::mask;
    out.emission_cutoff = glm::vec4(material.emissive, mask ? material.alpha_cutoff : 0.0F);
    out.surface = glm::vec4(material.metallic_factor, material.roughness_factor, material.normal_scale,
                            material.occlusion_strength);
    out.specular = glm::vec4(material.specular_color_factor, material.specular_factor);
    const auto uses = texture_uses(material);
    for (std::uint32_t slot = 0; slot < texture_slots; ++slot) {
        const TextureUse use = uses[slot]->value_or(TextureUse{});
        out.uv_rows[2 * slot] = glm::vec4(use.uv_row_u, static_cast<float>(use.uv_set));
        out.uv_rows[2 * slot + 1] = glm::vec4(use.uv_row_v, 0.0F);
    }
    return out;
}

std::uint32_t material_features(const Material& material) {
    std::uint32_t features = material.unlit ? feature_unlit : 0U;
    features |= material.blend == Blend::additive ? feature_additive : 0U;
    features |= material.blend == Blend::multiply ? feature_filter : 0U;
    const auto uses = texture_uses(material);
    for (std::uint32_t slot = 0; slot < texture_slots; ++slot) {
        if (const std::optional<TextureUse>& use = *uses[slot]) {
            features |= 1U << slot;
            features |= reads_plain_uv(*use) ? 0U : feature_uv_transform;
        }
    }
    return features;
}

tl::expected<MaterialsGpu, Error> upload_materials(const Device& device, Uploader& uploader, const Scene& scene,
                                                   const TexturesGpu& textures) {
    const auto count = static_cast<std::uint32_t>(scene.materials.size());
    const VkDeviceSize stride =
        aligned(sizeof(gpu::GpuMaterial), device.properties().limits.minUniformBufferOffsetAlignment);
    std::vector<std::byte> bytes(static_cast<std::size_t>(stride) * count);
    MaterialsGpu out;
    for (std::uint32_t i = 0; i < count; ++i) {
        const gpu::GpuMaterial material = make_gpu_material(scene.materials[i]);
        std::memcpy(bytes.data() + i * stride, &material, sizeof material);
        out.features.push_back(material_features(scene.materials[i]));
    }
    auto parameters = uploader.buffer(bytes, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT);
    auto layout = make_layout(device);
    auto pool = make_pool(device, count);
    if (!parameters || !layout || !pool) {
        return tl::unexpected(!parameters ? parameters.error() : !layout ? layout.error() : pool.error());
    }
    out.parameters = std::move(*parameters);
    out.layout = std::move(*layout);
    out.pool = std::move(*pool);
    auto sets = allocate_sets(device, out.pool.get(), out.layout.get(), count);
    if (!sets) {
        return tl::unexpected(sets.error());
    }
    out.sets = std::move(*sets);
    for (std::uint32_t i = 0; i < count; ++i) {
        const VkDescriptorBufferInfo slice{out.parameters.handle(), i * stride, sizeof(gpu::GpuMaterial)};
        write_set(device, out.sets[i], slice, scene.materials[i], textures);
    }
    return out;
}

} // namespace tyndall::engine
