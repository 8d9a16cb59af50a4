#include "features/volumetrics/pipelines.hpp"

#include <string>
#include <utility>

namespace tyndall::volumetrics {
namespace {

Error vulkan_error(const char* what, const char* shader, VkResult result) {
    return {std::string("The device refused to make the ") + what + " of the " + shader + " pass (VkResult " +
            std::to_string(static_cast<int>(result)) + ")."};
}

/// Constants of four bytes each, one behind the other, with ids from 0 on.
std::vector<VkSpecializationMapEntry> constant_map(std::size_t count) {
    std::vector<VkSpecializationMapEntry> map;
    for (std::uint32_t i = 0; i < count; ++i) {
        map.push_back({i, i * 4, 4});
    }
    return map;
}

} // namespace

Pipelines::Pipelines(const rg::DeviceTable& vk, VkDevice device, VkPipelineCache cache, bool check_bindings)
    : vk_(&vk), device_(device), cache_(cache), check_bindings_(rg::checks_bindings(check_bindings)) {}

Pipelines::~Pipelines() {
    for (Entry& entry : entries_) {
        destroy(entry);
    }
}

void Pipelines::destroy(Entry& entry) {
    vk_->DestroyPipeline(device_, entry.program.pipeline, nullptr);
    vk_->DestroyPipelineLayout(device_, entry.program.layout, nullptr);
    vk_->DestroyDescriptorSetLayout(device_, entry.set_layout, nullptr);
}

const Pipelines::Entry* Pipelines::find(const ShaderCode& shader, const std::vector<std::uint32_t>& key) const {
    for (const Entry& entry : entries_) {
        if (entry.code == shader.spirv.data() && entry.key == key) {
            return &entry;
        }
    }
    return nullptr;
}

tl::expected<void, Error> Pipelines::make_layout(const ShaderCode& shader, VkShaderStageFlags stages, Entry& entry) {
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (const ShaderBinding& binding : shader.bindings) {
        bindings.push_back({binding.binding, binding.type, 1, stages, nullptr});
    }
    const VkDescriptorSetLayoutCreateInfo set_info{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR,
        .bindingCount = static_cast<std::uint32_t>(bindings.size()),
        .pBindings = bindings.data(),
    };
    VkResult result = vk_->CreateDescriptorSetLayout(device_, &set_info, nullptr, &entry.set_layout);
    if (result != VK_SUCCESS) {
        return tl::unexpected(vulkan_error("descriptor layout", shader.name, result));
    }
    const VkPushConstantRange push{stages, 0, shader.push_constant_bytes};
    const VkPipelineLayoutCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .setLayoutCount = 1,
        .pSetLayouts = &entry.set_layout,
        .pushConstantRangeCount = shader.push_constant_bytes > 0 ? 1U : 0U,
        .pPushConstantRanges = &push,
    };
    result = vk_->CreatePipelineLayout(device_, &info, nullptr, &entry.program.layout);
    if (result != VK_SUCCESS) {
        return tl::unexpected(vulkan_error("pipeline layout", shader.name, result));
    }
    return {};
}

tl::expected<void, Error> Pipelines::reflect(const ShaderCode& shader, Entry& entry) const {
    if (!check_bindings_) {
        return {};
    }
    auto bindings = rg::reflect_bindings(shader.spirv);
    if (!bindings) {
        return tl::unexpected(
            Error{std::string("The shader of the ") + shader.name + " pass cannot be read. " + bindings.error() + "."});
    }
    entry.bindings = std::move(*bindings);
    return {};
}

Program Pipelines::keep(Entry entry) {
    Entry& kept = entries_.emplace_back(std::move(entry));
    kept.program.bindings = kept.bindings; // stays where it is when entries move
    return kept.program;
}

tl::expected<VkShaderModule, Error> Pipelines::make_module(const ShaderCode& shader) {
    const VkShaderModuleCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
        .codeSize = shader.spirv.size_bytes(),
        .pCode = shader.spirv.data(),
    };
    VkShaderModule shader_module = VK_NULL_HANDLE;
    const VkResult result = vk_->CreateShaderModule(device_, &info, nullptr, &shader_module);
    if (result != VK_SUCCESS) {
        return tl::unexpected(vulkan_error("shader module", shader.name, result));
    }
    return shader_module;
}

tl::expected<Program, Error> Pipelines::compute(const ShaderCode& shader, const GroupShape& group,
                                                std::span<const std::uint32_t> constants) {
    Entry entry{.key = {group.begin(), group.end()}, .code = shader.spirv.data()};
    entry.key.insert(entry.key.end(), constants.begin(), constants.end());
    if (const Entry* found = find(shader, entry.key)) {
        return found->program;
    }
    auto shader_module = make_module(shader);
    if (!shader_module) {
        return tl::unexpected(shader_module.error());
    }
    tl::expected<void, Error> made = reflect(shader, entry);
    if (made) {
        made = make_layout(shader, VK_SHADER_STAGE_COMPUTE_BIT, entry);
    }
    if (made) {
        const std::vector<VkSpecializationMapEntry> map = constant_map(entry.key.size());
        const VkSpecializationInfo specialization{static_cast<std::uint32_t>(map.size()), map.data(),
                                                  entry.key.size() * 4, entry.key.data()};
        const VkComputePipelineCreateInfo info{
            .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
            .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                      .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                      .module = *shader_module,
                      .pName = "main",
                      .pSpecializationInfo = &specialization},
            .layout = entry.program.layout,
        };
        const VkResult result =
            vk_->CreateComputePipelines(device_, cache_, 1, &info, nullptr, &entry.program.pipeline);
        if (result != VK_SUCCESS) {
            made = tl::unexpected(vulkan_error("pipeline", shader.name, result));
        }
    }
    vk_->DestroyShaderModule(device_, *shader_module, nullptr);
    if (!made) {
        destroy(entry);
        return tl::unexpected(made.error());
    }
    return keep(std::move(entry));
}

tl::expected<Program, Error> Pipelines::full_screen_blend(const ShaderCode& vertex, const ShaderCode& fragment,
                                                          VkFormat color_format, bool second_source,
                                                          std::span<const std::uint32_t> constants) {
    Entry entry{.key = {static_cast<std::uint32_t>(color_format)}, .code = fragment.spirv.data()};
    entry.key.insert(entry.key.end(), constants.begin(), constants.end());
    if (const Entry* found = find(fragment, entry.key)) {
        return found->program;
    }
    auto vertex_module = make_module(vertex);
    if (!vertex_module) {
        return tl::unexpected(vertex_module.error());
    }
    auto fragment_module = make_module(fragment);
    if (!fragment_module) {
        vk_->DestroyShaderModule(device_, *vertex_module, nullptr);
        return tl::unexpected(fragment_module.error());
    }
    tl::expected<void, Error> made = reflect(fragment, entry);
    if (made) {
        made = make_layout(fragment, VK_SHADER_STAGE_FRAGMENT_BIT, entry);
    }
    if (made) {
        const std::vector<VkSpecializationMapEntry> map = constant_map(constants.size());
        const VkSpecializationInfo specialization{static_cast<std::uint32_t>(map.size()), map.data(),
                                                  constants.size_bytes(), constants.data()};
        const VkPipelineShaderStageCreateInfo stages[] = {
            {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
             .stage = VK_SHADER_STAGE_VERTEX_BIT,
             .module = *vertex_module,
             .pName = "main"},
            {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
             .stage = VK_SHADER_STAGE_FRAGMENT_BIT,
             .module = *fragment_module,
             .pName = "main",
             .pSpecializationInfo = &specialization},
        };
        const VkPipelineVertexInputStateCreateInfo vertex_input{
            .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
        const VkPipelineInputAssemblyStateCreateInfo assembly{
            .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
            .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
        const VkPipelineViewportStateCreateInfo viewport{
            .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1, .scissorCount = 1};
        const VkPipelineRasterizationStateCreateInfo raster{
            .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
            .polygonMode = VK_POLYGON_MODE_FILL,
            .cullMode = VK_CULL_MODE_NONE,
            .lineWidth = 1.0F};
        const VkPipelineMultisampleStateCreateInfo samples{.sType =
                                                               VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
                                                           .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
        const VkPipelineColorBlendAttachmentState attachment{
            .blendEnable = VK_TRUE,
            .srcColorBlendFactor = VK_BLEND_FACTOR_ONE,
            .dstColorBlendFactor = second_source ? VK_BLEND_FACTOR_SRC1_COLOR : VK_BLEND_FACTOR_SRC_ALPHA,
            .colorBlendOp = VK_BLEND_OP_ADD,
            .srcAlphaBlendFactor = VK_BLEND_FACTOR_ZERO,
            .dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
            .alphaBlendOp = VK_BLEND_OP_ADD,
            .colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT |
                              VK_COLOR_COMPONENT_A_BIT};
        const VkPipelineColorBlendStateCreateInfo blend{.sType =
                                                            VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                                                        .attachmentCount = 1,
                                                        .pAttachments = &attachment};
        const VkDynamicState dynamic_states[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
        const VkPipelineDynamicStateCreateInfo dynamic{.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
                                                       .dynamicStateCount = 2,
                                                       .pDynamicStates = dynamic_states};
        const VkPipelineRenderingCreateInfo rendering{.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
                                                      .colorAttachmentCount = 1,
                                                      .pColorAttachmentFormats = &color_format};
        const VkGraphicsPipelineCreateInfo info{
            .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
            .pNext = &rendering,
            .stageCount = 2,
            .pStages = stages,
            .pVertexInputState = &vertex_input,
            .pInputAssemblyState = &assembly,
            .pViewportState = &viewport,
            .pRasterizationState = &raster,
            .pMultisampleState = &samples,
            .pColorBlendState = &blend,
            .pDynamicState = &dynamic,
            .layout = entry.program.layout,
        };
        const VkResult result =
            vk_->CreateGraphicsPipelines(device_, cache_, 1, &info, nullptr, &entry.program.pipeline);
        if (result != VK_SUCCESS) {
            made = tl::unexpected(vulkan_error("pipeline", fragment.name, result));
        }
    }
    vk_->DestroyShaderModule(device_, *vertex_module, nullptr);
    vk_->DestroyShaderModule(device_, *fragment_module, nullptr);
    if (!made) {
        destroy(entry);
        return tl::unexpected(made.error());
    }
    return keep(std::move(entry));
}

} // namespace tyndall::volumetrics
