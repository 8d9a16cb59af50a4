#include "engine/particle_programs.hpp"

#include <string>

namespace tyndall::engine {
namespace {

Error vulkan_error(const char* what, VkResult result) {
    return {std::string("The device refused the ") + what + " of the particles (VkResult " +
            std::to_string(static_cast<int>(result)) + ")."};
}

} // namespace

ParticlePrograms::~ParticlePrograms() {
    for (const Entry& entry : entries_) {
        device_.vk->DestroyPipeline(device_.device, entry.program.pipeline, nullptr);
        device_.vk->DestroyPipelineLayout(device_.device, entry.program.layout, nullptr);
        device_.vk->DestroyDescriptorSetLayout(device_.device, entry.set_layout, nullptr);
    }
}

tl::expected<ParticlePrograms::Entry*, Error> ParticlePrograms::make_layout(std::span<const ParticleBinding> bindings,
                                                                            const VkPushConstantRange& push) {
    Entry& entry = entries_.emplace_back();
    std::vector<VkDescriptorSetLayoutBinding> set;
    for (const ParticleBinding& binding : bindings) {
        set.push_back({binding.binding, binding.type, 1, binding.stages, nullptr});
    }
    const VkDescriptorSetLayoutCreateInfo set_info{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR,
        .bindingCount = static_cast<std::uint32_t>(set.size()),
        .pBindings = set.data(),
    };
    VkResult result = device_.vk->CreateDescriptorSetLayout(device_.device, &set_info, nullptr, &entry.set_layout);
    if (result != VK_SUCCESS) {
        return tl::unexpected(vulkan_error("descriptor layout", result));
    }
    const VkPipelineLayoutCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .setLayoutCount = 1,
        .pSetLayouts = &entry.set_layout,
        .pushConstantRangeCount = push.size > 0 ? 1U : 0U,
        .pPushConstantRanges = &push,
    };
    result = device_.vk->CreatePipelineLayout(device_.device, &info, nullptr, &entry.program.layout);
    if (result != VK_SUCCESS) {
        return tl::unexpected(vulkan_error("pipeline layout", result));
    }
    return &entry;
}

tl::expected<VkShaderModule, Error> ParticlePrograms::make_module(std::span<const std::uint32_t> spirv) {
    const VkShaderModuleCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
        .codeSize = spirv.size_bytes(),
        .pCode = spirv.data(),
    };
    VkShaderModule shader_module = VK_NULL_HANDLE;
    const VkResult result = device_.vk->CreateShaderModule(device_.device, &info, nullptr, &shader_module);
    if (result != VK_SUCCESS) {
        return tl::unexpected(vulkan_error("shader module", result));
    }
    return shader_module;
}

tl::expected<ParticleProgram, Error> ParticlePrograms::compute(std::span<const std::uint32_t> spirv,
                                                               std::span<const ParticleBinding> bindings,
                                                               std::uint32_t push_bytes,
                                                               std::span<const std::uint32_t> constants) {
    const auto shader_module = make_module(spirv);
    if (!shader_module) {
        return tl::unexpected(shader_module.error());
    }
    const auto entry = make_layout(bindings, {VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes});
    VkResult result = VK_SUCCESS;
    if (entry) {
        std::vector<VkSpecializationMapEntry> map;
        for (std::uint32_t i = 0; i < constants.size(); ++i) {
            map.push_back({i, i * 4, 4});
        }
        const VkSpecializationInfo specialization{static_cast<std::uint32_t>(map.size()), map.data(),
                                                  constants.size_bytes(), constants.data()};
        const VkComputePipelineCreateInfo info{
            .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
            .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                      .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                      .module = *shader_module,
                      .pName = "main",
                      .pSpecializationInfo = &specialization},
            .layout = (*entry)->program.layout,
        };
        result = device_.vk->CreateComputePipelines(device_.device, device_.cache, 1, &info, nullptr,
                                                    &(*entry)->program.pipeline);
    }
    device_.vk->DestroyShaderModule(device_.device, *shader_module, nullptr);
    if (!entry) {
        return tl::unexpected(entry.error());
    }
    if (result != VK_SUCCESS) {
        return tl::unexpected(vulkan_error("compute pipeline", result));
    }
    return (*entry)->program;
}

tl::expected<ParticleProgram, Error> ParticlePrograms::billboards(std::span<const std::uint32_t> vertex,
                                                                  std::span<const std::uint32_t> fragment,
                                                                  std::span<const ParticleBinding> bindings,
                                                                  VkFormat color_format, VkFormat depth_format) {
    const auto vertex_module = make_module(vertex);
    if (!vertex_module) {
        return tl::unexpected(vertex_module.error());
    }
    const auto fragment_module = make_module(fragment);
    if (!fragment_module) {
        device_.vk->DestroyShaderModule(device_.device, *vertex_module, nullptr);
        return tl::unexpected(fragment_module.error());
    }
    const auto entry = make_layout(bindings, {});
    VkResult result = VK_SUCCESS;
    if (entry) {
        const VkPipelineShaderStageCreateInfo stages[] = {
            {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
             .stage = VK_SHADER_STAGE_VERTEX_BIT,
             .module = *vertex_module,
             .pName = "main"},
            {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
             .stage = VK_SHADER_STAGE_FRAGMENT_BIT,
             .module = *fragment_module,
             .pName = "main"},
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
        const VkPipelineDepthStencilStateCreateInfo depth{
            .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
            .depthTestEnable = VK_TRUE,
            .depthCompareOp = VK_COMPARE_OP_GREATER_OR_EQUAL};
        const VkPipelineColorBlendAttachmentState attachment{.blendEnable = VK_TRUE,
                                                             .srcColorBlendFactor = VK_BLEND_FACTOR_ONE,
                                                             .dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
                                                             .colorBlendOp = VK_BLEND_OP_ADD,
                                                             .srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
                                                             .dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
                                                             .alphaBlendOp = VK_BLEND_OP_ADD,
                                                             .colorWriteMask =
                                                                 VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                                                                 VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT};
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
                                                      .pColorAttachmentFormats = &color_format,
                                                      .depthAttachmentFormat = depth_format};
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
            .pDepthStencilState = &depth,
            .pColorBlendState = &blend,
            .pDynamicState = &dynamic,
            .layout = (*entry)->program.layout,
        };
        result = device_.vk->CreateGraphicsPipelines(device_.device, device_.cache, 1, &info, nullptr,
                                                     &(*entry)->program.pipeline);
    }
    device_.vk->DestroyShaderModule(device_.device, *vertex_module, nullptr);
    device_.vk->DestroyShaderModule(device_.device, *fragment_module, nullptr);
    if (!entry) {
        return tl::unexpected(entry.error());
    }
    if (result != VK_SUCCESS) {
        return tl::unexpected(vulkan_error("graphics pipeline", result));
    }
    return (*entry)->program;
}

} // namespace tyndall::engine
