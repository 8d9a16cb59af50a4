#include "tests/gpu/gpu_fixture.hpp"

#include <cstdlib>

namespace tyndall::test {

Mode mode_from_environment() {
    const char* value = std::getenv("TYNDALL_TEST_MODE");
    const std::string name = value == nullptr ? "submit" : value;
    return name == "single_command_buffer" ? Mode::single_command_buffer
           : name == "folded"              ? Mode::folded
           : name == "semaphores"          ? Mode::semaphores
                                           : Mode::submit;
}

rg::ImportDesc read_by_host() {
    return {.has_final = true, .final_stages = VK_PIPELINE_STAGE_2_HOST_BIT, .final_access = VK_ACCESS_2_HOST_READ_BIT};
}

rg::ImportDesc written_by_host() {
    return {.read_only = true};
} // submission makes host writes visible

std::vector<rg::ReflectedBinding> reflected(std::initializer_list<std::span<const std::uint32_t>> shaders) {
    std::vector<rg::ReflectedBinding> out;
    for (const std::span<const std::uint32_t> spirv : shaders) {
        const auto bindings = rg::reflect_bindings(spirv);
        EXPECT_TRUE(bindings.has_value()) << (bindings ? "" : bindings.error());
        if (bindings) {
            out.insert(out.end(), bindings->begin(), bindings->end());
        }
    }
    return out;
}

void GpuTest::SetUp() {
    mode_ = mode_from_environment();
    std::string why;
    device_ = TestDevice::create(why);
    ASSERT_NE(device_, nullptr) << why;
    const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                       .queueFamilyIndex = device_->family};
    ASSERT_EQ(vk().CreateCommandPool(device_->device, &pool, nullptr, &pool_), VK_SUCCESS);
    const VkFenceCreateInfo fence{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    ASSERT_EQ(vk().CreateFence(device_->device, &fence, nullptr, &fence_), VK_SUCCESS);
    make_executor(executor_info());
}

void GpuTest::TearDown() {
    if (device_ == nullptr) {
        return;
    }
    executor_.reset();
    const VkDevice device = device_->device;
    for (const HostBuffer& buffer : buffers_) {
        vk().DestroyBuffer(device, buffer.buffer, nullptr);
        vk().FreeMemory(device, buffer.memory, nullptr);
    }
    for (const HostImage& image : images_) {
        vk().DestroyImage(device, image.image, nullptr);
        vk().FreeMemory(device, image.memory, nullptr);
    }
    for (const VkSampler sampler : samplers_) {
        vk().DestroySampler(device, sampler, nullptr);
    }
    for (const TestPipeline& pipeline : pipelines_) {
        vk().DestroyPipeline(device, pipeline.pipeline, nullptr);
        vk().DestroyPipelineLayout(device, pipeline.layout, nullptr);
    }
    for (const VkDescriptorSetLayout layout : set_layouts_) {
        vk().DestroyDescriptorSetLayout(device, layout, nullptr);
    }
    vk().DestroyFence(device, fence_, nullptr);
    vk().DestroyCommandPool(device, pool_, nullptr);
    for (const std::string& error : take_errors()) {
        ADD_FAILURE() << "validation: " << error;
    }
    device_.reset();
}

rg::ExecutorInfo GpuTest::executor_info() const {
    const rg::DeviceQueue queue{rg::QueueKind::graphics, device_->queue, device_->family,
                                device_->timestamp_valid_bits};
    rg::ExecutorInfo info{.get_device_proc_addr = vkGetDeviceProcAddr,
                          .device = device_->device,
                          .memory_properties = device_->memory_properties,
                          .buffer_image_granularity = device_->properties.limits.bufferImageGranularity,
                          .timestamp_period_ns = device_->properties.limits.timestampPeriod,
                          .queues = {queue},
                          .debug_labels = true,
                          .check_bindings = true};
    if (mode_ == Mode::semaphores) {
        info.queues.push_back(queue);
        info.queues.back().kind = rg::QueueKind::compute;
    }
    return info;
}

void GpuTest::make_executor(rg::ExecutorInfo info) {
    executor_.reset();
    tl::expected<rg::Executor, rg::ExecuteError> made = rg::Executor::create(std::move(info));
    ASSERT_TRUE(made.has_value()) << made.error().message;
    executor_.emplace(std::move(*made));
}

rg::QueueTopology GpuTest::topology() const {
    if (mode_ != Mode::folded) {
        return executor_->topology();
    }
    return {{{rg::QueueKind::graphics, 0, rg::can_graphics | rg::can_compute | rg::can_transfer},
             {rg::QueueKind::compute, 1, rg::can_compute | rg::can_transfer}}};
}

rg::Plan GpuTest::compile(const rg::GraphDesc& graph, const rg::CompileOptions& options) {
    tl::expected<rg::Plan, rg::Diagnostics> plan =
        rg::compile(graph, topology(), executor_->memory_requirements(graph), options);
    EXPECT_TRUE(plan.has_value()) << (plan ? "" : rg::to_text(plan.error()));
    return plan.value_or(rg::Plan{});
}

std::optional<rg::ExecuteError> GpuTest::execute(const rg::DeclaredGraph& graph, const rg::Plan& plan,
                                                 std::span<const rg::ImportBinding> imports) {
    if (mode_ != Mode::single_command_buffer) {
        const auto frame = executor_->submit(graph.desc, plan, graph.callbacks, imports);
        if (!frame) {
            return frame.error();
        }
        const auto waited = executor_->wait(*frame);
        return waited ? std::nullopt : std::optional(waited.error());
    }
    const VkDevice device = device_->device;
    EXPECT_EQ(vk().ResetCommandPool(device, pool_, 0), VK_SUCCESS);
    const VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                               .commandPool = pool_,
                                               .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                               .commandBufferCount = 1};
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    EXPECT_EQ(vk().AllocateCommandBuffers(device, &allocate, &cmd), VK_SUCCESS);
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    EXPECT_EQ(vk().BeginCommandBuffer(cmd, &begin), VK_SUCCESS);
    const auto frame = executor_->record(cmd, graph.desc, plan, graph.callbacks, imports);
    EXPECT_EQ(vk().EndCommandBuffer(cmd), VK_SUCCESS);
    std::optional<rg::ExecuteError> error;
    if (frame) {
        const VkCommandBufferSubmitInfo buffer{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                               .commandBuffer = cmd};
        const VkSubmitInfo2 submit{
            .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &buffer};
        EXPECT_EQ(vk().QueueSubmit2(device_->queue, 1, &submit, fence_), VK_SUCCESS);
        EXPECT_EQ(vk().WaitForFences(device, 1, &fence_, VK_TRUE, ~std::uint64_t{0}), VK_SUCCESS);
        EXPECT_EQ(vk().ResetFences(device, 1, &fence_), VK_SUCCESS);
    } else {
        error = frame.error();
    }
    vk().FreeCommandBuffers(device, pool_, 1, &cmd);
    return error;
}

void GpuTest::run(const rg::DeclaredGraph& graph, std::span<const rg::ImportBinding> imports) {
    const rg::Plan plan = compile(graph.desc);
    const std::optional<rg::ExecuteError> error = execute(graph, plan, imports);
    EXPECT_FALSE(error.has_value()) << (error ? error->message : "");
}

VkDeviceMemory GpuTest::allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags flags) {
    std::uint32_t type = 0;
    while (type < device_->memory_properties.memoryTypeCount &&
           ((needs.memoryTypeBits >> type & 1U) == 0 ||
            (device_->memory_properties.memoryTypes[type].propertyFlags & flags) != flags)) {
        ++type;
    }
    const VkMemoryAllocateInfo allocate{
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size, .memoryTypeIndex = type};
    VkDeviceMemory memory = VK_NULL_HANDLE;
    EXPECT_EQ(vk().AllocateMemory(device_->device, &allocate, nullptr, &memory), VK_SUCCESS);
    return memory;
}

HostBuffer GpuTest::host_buffer(VkDeviceSize size_bytes, VkBufferUsageFlags usage) {
    HostBuffer out{.size_bytes = size_bytes};
    const VkBufferCreateInfo create{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size_bytes, .usage = usage};
    EXPECT_EQ(vk().CreateBuffer(device_->device, &create, nullptr, &out.buffer), VK_SUCCESS);
    VkMemoryRequirements needs = {};
    vk().GetBufferMemoryRequirements(device_->device, out.buffer, &needs);
    out.memory = allocate(needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    EXPECT_EQ(vk().BindBufferMemory(device_->device, out.buffer, out.memory, 0), VK_SUCCESS);
    EXPECT_EQ(vk().MapMemory(device_->device, out.memory, 0, VK_WHOLE_SIZE, 0, &out.mapped), VK_SUCCESS);
    buffers_.push_back(out);
    return out;
}

HostImage GpuTest::host_image(const rg::ImageDesc& desc, VkImageUsageFlags usage) {
    HostImage out;
    const VkImageCreateInfo create{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                   .imageType = desc.type,
                                   .format = desc.format,
                                   .extent = desc.extent,
                                   .mipLevels = desc.mips,
                                   .arrayLayers = desc.layers,
                                   .samples = desc.samples,
                                   .usage = usage};
    EXPECT_EQ(vk().CreateImage(device_->device, &create, nullptr, &out.image), VK_SUCCESS);
    VkMemoryRequirements needs = {};
    vk().GetImageMemoryRequirements(device_->device, out.image, &needs);
    out.memory = allocate(needs, 0);
    EXPECT_EQ(vk().BindImageMemory(device_->device, out.image, out.memory, 0), VK_SUCCESS);
    images_.push_back(out);
    return out;
}

VkSampler GpuTest::nearest_sampler() {
    const VkSamplerCreateInfo create{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    VkSampler sampler = VK_NULL_HANDLE;
    EXPECT_EQ(vk().CreateSampler(device_->device, &create, nullptr, &sampler), VK_SUCCESS);
    samplers_.push_back(sampler);
    return sampler;
}

TestPipeline GpuTest::pipeline_layout(std::span<const VkDescriptorType> bindings, std::uint32_t push_bytes,
                                      VkShaderStageFlags stages) {
    std::vector<VkDescriptorSetLayoutBinding> slots;
    for (const VkDescriptorType type : bindings) {
        slots.push_back({.binding = static_cast<std::uint32_t>(slots.size()),
                         .descriptorType = type,
                         .descriptorCount = 1,
                         .stageFlags = stages});
    }
    const VkDescriptorSetLayoutCreateInfo set{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                              .flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR,
                                              .bindingCount = static_cast<std::uint32_t>(slots.size()),
                                              .pBindings = slots.data()};
    VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
    EXPECT_EQ(vk().CreateDescriptorSetLayout(device_->device, &set, nullptr, &set_layout), VK_SUCCESS);
    set_layouts_.push_back(set_layout);
    const VkPushConstantRange constants{stages, 0, push_bytes};
    const VkPipelineLayoutCreateInfo create{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                            .setLayoutCount = 1,
                                            .pSetLayouts = &set_layout,
                                            .pushConstantRangeCount = push_bytes > 0 ? 1U : 0U,
                                            .pPushConstantRanges = &constants};
    TestPipeline out;
    EXPECT_EQ(vk().CreatePipelineLayout(device_->device, &create, nullptr, &out.layout), VK_SUCCESS);
    return out;
}

VkShaderModule GpuTest::shader_module(std::span<const std::uint32_t> spirv) {
    const VkShaderModuleCreateInfo create{
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = spirv.size_bytes(), .pCode = spirv.data()};
    VkShaderModule module = VK_NULL_HANDLE;
    EXPECT_EQ(vk().CreateShaderModule(device_->device, &create, nullptr, &module), VK_SUCCESS);
    return module;
}

TestPipeline GpuTest::compute_pipeline(std::span<const std::uint32_t> spirv, std::span<const VkDescriptorType> bindings,
                                       std::uint32_t push_bytes) {
    TestPipeline out = pipeline_layout(bindings, push_bytes, VK_SHADER_STAGE_COMPUTE_BIT);
    const VkShaderModule module = shader_module(spirv);
    const VkComputePipelineCreateInfo create{.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
                                             .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                                                       .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                                                       .module = module,
                                                       .pName = "main"},
                                             .layout = out.layout};
    EXPECT_EQ(vk().CreateComputePipelines(device_->device, VK_NULL_HANDLE, 1, &create, nullptr, &out.pipeline),
              VK_SUCCESS);
    vk().DestroyShaderModule(device_->device, module, nullptr);
    out.bindings = reflected({spirv});
    pipelines_.push_back(out);
    return out;
}

TestPipeline GpuTest::graphics_pipeline(std::span<const std::uint32_t> vertex, std::span<const std::uint32_t> fragment,
                                        std::span<const VkDescriptorType> bindings, VkFormat color,
                                        VkSampleCountFlagBits samples) {
    TestPipeline out = pipeline_layout(bindings, 0, VK_SHADER_STAGE_FRAGMENT_BIT);
    const VkShaderModule modules[] = {shader_module(vertex), shader_module(fragment)};
    const VkPipelineShaderStageCreateInfo stages[] = {{.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                                                       .stage = VK_SHADER_STAGE_VERTEX_BIT,
                                                       .module = modules[0],
                                                       .pName = "main"},
                                                      {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                                                       .stage = VK_SHADER_STAGE_FRAGMENT_BIT,
                                                       .module = modules[1],
                                                       .pName = "main"}};
    const VkPipelineVertexInputStateCreateInfo input{.sType =
                                                         VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    const VkPipelineInputAssemblyStateCreateInfo assembly{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    const VkPipelineViewportStateCreateInfo viewport{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1, .scissorCount = 1};
    const VkPipelineRasterizationStateCreateInfo raster{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO, .lineWidth = 1.0F};
    const VkPipelineMultisampleStateCreateInfo multisample{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO, .rasterizationSamples = samples};
    const VkPipelineColorBlendAttachmentState writes_all{.colorWriteMask = 0xF};
    const VkPipelineColorBlendStateCreateInfo blend{.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                                                    .attachmentCount = 1,
                                                    .pAttachments = &writes_all};
    const VkDynamicState dynamics[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    const VkPipelineDynamicStateCreateInfo dynamic{.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
                                                   .dynamicStateCount = 2,
                                                   .pDynamicStates = dynamics};
    const VkPipelineRenderingCreateInfo rendering{.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
                                                  .colorAttachmentCount = 1,
                                                  .pColorAttachmentFormats = &color};
    const VkGraphicsPipelineCreateInfo create{.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                              .pNext = &rendering,
                                              .stageCount = 2,
                                              .pStages = stages,
                                              .pVertexInputState = &input,
                                              .pInputAssemblyState = &assembly,
                                              .pViewportState = &viewport,
                                              .pRasterizationState = &raster,
                                              .pMultisampleState = &multisample,
                                              .pColorBlendState = &blend,
                                              .pDynamicState = &dynamic,
                                              .layout = out.layout};
    EXPECT_EQ(vk().CreateGraphicsPipelines(device_->device, VK_NULL_HANDLE, 1, &create, nullptr, &out.pipeline),
              VK_SUCCESS);
    for (const VkShaderModule module : modules) {
        vk().DestroyShaderModule(device_->device, module, nullptr);
    }
    out.bindings = reflected({vertex, fragment});
    pipelines_.push_back(out);
    return out;
}

std::vector<std::string> GpuTest::take_errors() {
    return std::exchange(device_->errors, {});
}

} // namespace tyndall::test
