#include "engine/pipelines.hpp"

#include <array>
#include <initializer_list>
#include <string>
#include <utility>

namespace tyndall::engine {
namespace {

Error failed(const char* what, VkResult result) {
    return {std::string(what) + " could not be made (VkResult " + std::to_string(result) + ")"};
}

Error exceeded(const Device& device, const char* what, std::uint32_t limit, std::uint32_t needed) {
    return {"Device '" + device.info().name + "' has " + std::to_string(limit) + " " + what + ", and a pass needs " +
            std::to_string(needed)};
}

/// A module for the time of making a pipeline.
class ShaderModule {
public:
    ShaderModule(const Device& device, std::span<const std::uint32_t> spirv) : device_(device) {
        const VkShaderModuleCreateInfo info{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                            .codeSize = spirv.size_bytes(),
                                            .pCode = spirv.data()};
        result_ = device.vk().CreateShaderModule(device.handle(), &info, nullptr, &module_);
    }
    ShaderModule(const ShaderModule&) = delete;
    ShaderModule& operator=(const ShaderModule&) = delete;
    ~ShaderModule() { device_.vk().DestroyShaderModule(device_.handle(), module_, nullptr); }
    [[nodiscard]] VkResult result() const { return result_; }
    [[nodiscard]] VkPipelineShaderStageCreateInfo stage(VkShaderStageFlagBits stage,
                                                        const VkSpecializationInfo& constants) const {
        return {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                .stage = stage,
                .module = module_,
                .pName = "main",
                .pSpecializationInfo = &constants};
    }

private:
    const Device& device_;
    VkShaderModule module_ = VK_NULL_HANDLE;
    VkResult result_ = VK_SUCCESS;
};

/// What the shaders of a pipeline bind.
tl::expected<std::vector<rg::ReflectedBinding>, Error>
reflect(std::initializer_list<std::span<const std::uint32_t>> shaders) {
    std::vector<rg::ReflectedBinding> bindings;
    for (const std::span<const std::uint32_t> spirv : shaders) {
        const auto reflected = rg::reflect_bindings(spirv);
        if (!reflected) {
            return tl::unexpected(Error{"A shader module cannot be read: " + reflected.error()});
        }
        rg::merge_bindings(bindings, *reflected);
    }
    return bindings;
}

/// Constants in the shape that Vulkan wants; points into itself and into `constants`.
struct Specialization {
    explicit Specialization(std::span<const SpecializationConstant> constants) {
        for (std::uint32_t i = 0; i < constants.size(); ++i) {
            const auto offset = static_cast<std::uint32_t>(i * sizeof(SpecializationConstant) +
                                                           offsetof(SpecializationConstant, value));
            entries.push_back({constants[i].id, offset, sizeof(std::uint32_t)});
        }
        info = {static_cast<std::uint32_t>(entries.size()), entries.data(), constants.size_bytes(), constants.data()};
    }
    Specialization(const Specialization&) = delete;
    Specialization& operator=(const Specialization&) = delete;
    std::vector<VkSpecializationMapEntry> entries;
    VkSpecializationInfo info = {};
};

} // namespace

tl::expected<DescriptorSetLayout, Error>
create_set_layout(const Device& device, std::span<const VkDescriptorSetLayoutBinding> bindings, bool push) {
    std::uint32_t descriptors = 0;
    for (const VkDescriptorSetLayoutBinding& binding : bindings) {
        descriptors += binding.descriptorCount;
    }
    if (push && descriptors > device.info().max_push_descriptors) {
        return tl::unexpected(exceeded(device, "push descriptors", device.info().max_push_descriptors, descriptors));
    }
    const VkDescriptorSetLayoutCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .flags = push ? VkDescriptorSetLayoutCreateFlags{VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR} : 0,
        .bindingCount = static_cast<std::uint32_t>(bindings.size()),
        .pBindings = bindings.data()};
    VkDescriptorSetLayout layout = VK_NULL_HANDLE;
    const VkResult result = device.vk().CreateDescriptorSetLayout(device.handle(), &info, nullptr, &layout);
    if (result != VK_SUCCESS) {
        return tl::unexpected(failed("A descriptor set layout", result));
    }
    return DescriptorSetLayout(device, layout);
}

tl::expected<PipelineLayout, Error> create_pipeline_layout(const Device& device,
                                                           std::span<const VkDescriptorSetLayout> sets,
                                                           std::uint32_t push_constant_bytes,
                                                           VkShaderStageFlags push_constant_stages) {
    if (const std::uint32_t limit = device.properties().limits.maxPushConstantsSize; push_constant_bytes > limit) {
        return tl::unexpected(exceeded(device, "bytes of push constants", limit, push_constant_bytes));
    }
    const VkPushConstantRange range{push_constant_stages, 0, push_constant_bytes};
    const VkPipelineLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                          .setLayoutCount = static_cast<std::uint32_t>(sets.size()),
                                          .pSetLayouts = sets.data(),
                                          .pushConstantRangeCount = push_constant_bytes == 0 ? 0U : 1U,
                                          .pPushConstantRanges = &range};
    VkPipelineLayout layout = VK_NULL_HANDLE;
    const VkResult result = device.vk().CreatePipelineLayout(device.handle(), &info, nullptr, &layout);
    if (result != VK_SUCCESS) {
        return tl::unexpected(failed("A pipeline layout", result));
    }
    return PipelineLayout(device, layout);
}

tl::expected<Pipeline, Error> create_compute_pipeline(const Device& device, VkPipelineCache cache,
                                                      VkPipelineLayout layout, std::span<const std::uint32_t> spirv,
                                                      std::span<const SpecializationConstant> constants) {
    auto bindings = reflect({spirv});
    if (!bindings) {
        return tl::unexpected(bindings.error());
    }
    const ShaderModule module(device, spirv);
    if (module.result() != VK_SUCCESS) {
        return tl::unexpected(failed("A shader module", module.result()));
    }
    const Specialization specialization(constants);
    const VkComputePipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
                                           .stage = module.stage(VK_SHADER_STAGE_COMPUTE_BIT, specialization.info),
                                           .layout = layout};
    VkPipeline pipeline = VK_NULL_HANDLE;
    const VkResult result = device.vk().CreateComputePipelines(device.handle(), cache, 1, &info, nullptr, &pipeline);
    if (result != VK_SUCCESS) {
        return tl::unexpected(failed("A compute pipeline", result));
    }
    return Pipeline(device, pipeline, std::move(*bindings));
}

VkPipelineColorBlendAttachmentState laid_over(bool two_sources) {
    return {.blendEnable = VK_TRUE,
            .srcColorBlendFactor = VK_BLEND_FACTOR_ONE,
            .dstColorBlendFactor = two_sources ? VK_BLEND_FACTOR_SRC1_COLOR : VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
            .colorBlendOp = VK_BLEND_OP_ADD,
            .srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
            .dstAlphaBlendFactor = two_sources ? VK_BLEND_FACTOR_SRC1_ALPHA : VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
            .alphaBlendOp = VK_BLEND_OP_ADD,
            .colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT |
                              VK_COLOR_COMPONENT_A_BIT};
}

tl::expected<Pipeline, Error> create_graphics_pipeline(const Device& device, VkPipelineCache cache,
                                                       const GraphicsPipelineInfo& info) {
    const bool has_fragment = !info.fragment_spirv.empty();
    const std::span<const std::uint32_t> last_spirv = has_fragment ? info.fragment_spirv : info.vertex_spirv;
    auto bindings = has_fragment ? reflect({info.vertex_spirv, info.fragment_spirv}) : reflect({info.vertex_spirv});
    if (!bindings) {
        return tl::unexpected(bindings.error());
    }
    const ShaderModule vertex(device, info.vertex_spirv);
    const ShaderModule fragment(device, last_spirv);
    if (vertex.result() != VK_SUCCESS || fragment.result() != VK_SUCCESS) {
        return tl::unexpected(
            failed("A shader module", vertex.result() != VK_SUCCESS ? vertex.result() : fragment.result()));
    }
    const Specialization specialization(info.constants);
    const std::array stages = {vertex.stage(VK_SHADER_STAGE_VERTEX_BIT, specialization.info),
                               fragment.stage(VK_SHADER_STAGE_FRAGMENT_BIT, specialization.info)};
    const VkPipelineVertexInputStateCreateInfo input{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = static_cast<std::uint32_t>(info.vertex_bindings.size()),
        .pVertexBindingDescriptions = info.vertex_bindings.data(),
        .vertexAttributeDescriptionCount = static_cast<std::uint32_t>(info.vertex_attributes.size()),
        .pVertexAttributeDescriptions = info.vertex_attributes.data()};
    const VkPipelineInputAssemblyStateCreateInfo assembly{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO, .topology = info.topology};
    const VkPipelineViewportStateCreateInfo viewport{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1, .scissorCount = 1};
    const VkPipelineRasterizationStateCreateInfo rasterization{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .depthClampEnable = info.depth_clamp ? VK_TRUE : VK_FALSE,
        .polygonMode = VK_POLYGON_MODE_FILL,
        .cullMode = info.cull,
        .frontFace = info.front,
        .depthBiasEnable = info.dynamic_depth_bias ? VK_TRUE : VK_FALSE,
        .lineWidth = 1.0F};
    const VkPipelineMultisampleStateCreateInfo multisample{.sType =
                                                               VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
                                                           .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    const VkPipelineDepthStencilStateCreateInfo depth{.sType =
                                                          VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
                                                      .depthTestEnable = info.depth_test ? VK_TRUE : VK_FALSE,
                                                      .depthWriteEnable = info.depth_write ? VK_TRUE : VK_FALSE,
                                                      .depthCompareOp = info.depth_compare};
    constexpr VkColorComponentFlags rgba =
        VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
    std::vector<VkPipelineColorBlendAttachmentState> blends(info.blends.begin(), info.blends.end());
    blends.resize(info.color_formats.size(), {.colorWriteMask = rgba});
    const VkPipelineColorBlendStateCreateInfo blend{.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                                                    .attachmentCount = static_cast<std::uint32_t>(blends.size()),
                                                    .pAttachments = blends.data()};
    std::vector<VkDynamicState> dynamic = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    if (info.dynamic_culling) {
        dynamic.insert(dynamic.end(), {VK_DYNAMIC_STATE_CULL_MODE, VK_DYNAMIC_STATE_FRONT_FACE});
    }
    if (info.dynamic_depth_bias) {
        dynamic.push_back(VK_DYNAMIC_STATE_DEPTH_BIAS);
    }
    const VkPipelineDynamicStateCreateInfo dynamic_state{.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
                                                         .dynamicStateCount =
                                                             static_cast<std::uint32_t>(dynamic.size()),
                                                         .pDynamicStates = dynamic.data()};
    const VkPipelineRenderingCreateInfo rendering{.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
                                                  .colorAttachmentCount =
                                                      static_cast<std::uint32_t>(info.color_formats.size()),
                                                  .pColorAttachmentFormats = info.color_formats.data(),
                                                  .depthAttachmentFormat = info.depth_format};
    const VkGraphicsPipelineCreateInfo create{.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                              .pNext = &rendering,
                                              .stageCount = has_fragment ? 2U : 1U,
                                              .pStages = stages.data(),
                                              .pVertexInputState = &input,
                                              .pInputAssemblyState = &assembly,
                                              .pViewportState = &viewport,
                                              .pRasterizationState = &rasterization,
                                              .pMultisampleState = &multisample,
                                              .pDepthStencilState = &depth,
                                              .pColorBlendState = &blend,
                                              .pDynamicState = &dynamic_state,
                                              .layout = info.layout};
    VkPipeline pipeline = VK_NULL_HANDLE;
    const VkResult result = device.vk().CreateGraphicsPipelines(device.handle(), cache, 1, &create, nullptr, &pipeline);
    if (result != VK_SUCCESS) {
        return tl::unexpected(failed("A graphics pipeline", result));
    }
    return Pipeline(device, pipeline, std::move(*bindings));
}

tl::expected<DeviceSampler, Error> create_sampler(const Device& device, const VkSamplerCreateInfo& info) {
    VkSampler sampler = VK_NULL_HANDLE;
    const VkResult result = device.vk().CreateSampler(device.handle(), &info, nullptr, &sampler);
    if (result != VK_SUCCESS) {
        return tl::unexpected(failed("A sampler", result));
    }
    return DeviceSampler(device, sampler);
}

} // namespace tyndall::engine
