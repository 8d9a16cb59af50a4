#include "tests/engine/particles_fixture.hpp"

namespace tyndall::test {

void ParticleFrameTest::SetUp() {
    DeviceTest::SetUp();
    if (HasFatalFailure()) {
        return;
    }
    rg::ExecutorInfo info = device().executor_info(false);
    info.check_bindings = true;
    if (mode_from_environment() == Mode::semaphores) {
        info.queues.push_back(info.queues.front());
        info.queues.back().kind = rg::QueueKind::compute;
    }
    auto executor = rg::Executor::create(std::move(info));
    ASSERT_TRUE(executor.has_value()) << executor.error().message;
    executor_.emplace(std::move(*executor));
}

void ParticleFrameTest::TearDown() {
    executor_.reset();
    buffers_.clear();
    DeviceTest::TearDown();
}

void ParticleFrameTest::run(const rg::DeclaredGraph& graph, std::span<const rg::ImportBinding> imports) {
    rg::QueueTopology topology = executor_->topology();
    if (mode_from_environment() == Mode::folded) {
        topology = {{{rg::QueueKind::graphics, 0, rg::can_graphics | rg::can_compute | rg::can_transfer},
                     {rg::QueueKind::compute, 1, rg::can_compute | rg::can_transfer}}};
    }
    const auto plan = rg::compile(graph.desc, topology, executor_->memory_requirements(graph.desc));
    ASSERT_TRUE(plan.has_value()) << rg::to_text(plan.error());
    if (mode_from_environment() == Mode::single_command_buffer) {
        record_and_wait(graph, *plan, imports);
        return;
    }
    const auto frame = executor_->submit(graph.desc, *plan, graph.callbacks, imports);
    ASSERT_TRUE(frame.has_value()) << frame.error().message;
    const auto waited = executor_->wait(*frame);
    ASSERT_TRUE(waited.has_value()) << waited.error().message;
}

void ParticleFrameTest::record_and_wait(const rg::DeclaredGraph& graph, const rg::Plan& plan,
                                        std::span<const rg::ImportBinding> imports) {
    const rg::DeviceTable& vk = device().vk();
    const rg::DeviceQueue& queue = device().graphics_queue();
    const VkCommandPoolCreateInfo pool_info{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                            .queueFamilyIndex = queue.family};
    VkCommandPool pool = VK_NULL_HANDLE;
    ASSERT_EQ(vk.CreateCommandPool(device().handle(), &pool_info, nullptr, &pool), VK_SUCCESS);
    const VkCommandBufferAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                               .commandPool = pool,
                                               .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                               .commandBufferCount = 1};
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    ASSERT_EQ(vk.AllocateCommandBuffers(device().handle(), &allocate, &cmd), VK_SUCCESS);
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    ASSERT_EQ(vk.BeginCommandBuffer(cmd, &begin), VK_SUCCESS);
    const auto frame = executor_->record(cmd, graph.desc, plan, graph.callbacks, imports);
    ASSERT_EQ(vk.EndCommandBuffer(cmd), VK_SUCCESS);
    ASSERT_TRUE(frame.has_value()) << frame.error().message;
    const VkCommandBufferSubmitInfo buffer{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, .commandBuffer = cmd};
    const VkSubmitInfo2 submit{
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2, .commandBufferInfoCount = 1, .pCommandBufferInfos = &buffer};
    ASSERT_EQ(vk.QueueSubmit2(queue.queue, 1, &submit, VK_NULL_HANDLE), VK_SUCCESS);
    device().wait_idle();
    vk.DestroyCommandPool(device().handle(), pool, nullptr);
}

engine::Buffer& ParticleFrameTest::host_buffer(VkDeviceSize size_bytes) {
    auto made = engine::Buffer::create(device(), size_bytes,
                                       VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
                                           VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                       engine::MemoryUse::readback);
    EXPECT_TRUE(made.has_value()) << (made ? "" : made.error().message);
    return buffers_.emplace_back(made ? std::move(*made) : engine::Buffer());
}

engine::FrameView square_view(const glm::dvec3& origin_m, double time_s, double slope, std::uint32_t size) {
    engine::FrameView view{.origin_m = origin_m, .size = {size, size}, .time_s = time_s};
    view.clip_from_view = glm::dmat4(0.0);
    view.clip_from_view[0][0] = 1.0 / slope;
    view.clip_from_view[1][1] = -1.0 / slope;
    view.clip_from_view[2][3] = -1.0;
    view.clip_from_view[3][2] = 0.05; // the near plane, m
    return view;
}

} // namespace tyndall::test
