// A device, an executor and a validation log for tests that run on a driver. Any validation error fails the test.
//
// TYNDALL_TEST_MODE chooses how frames run:
//   submit                 the executor submits to the device's queues (default)
//   single_command_buffer  Executor::record into one command buffer: what synchronisation validation sees best
//   folded                 the plan is compiled for a graphics and an async compute queue of different families and
//   folded
//                          onto the one real queue
//   semaphores             the device's queue is given twice, as graphics and as compute queue, so that the plan's
//   waits
//                          are real semaphores
#pragma once

#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "rendergraph/compile.hpp"
#include "rendergraph/executor.hpp"
#include "rendergraph/graph.hpp"
#include "tests/gpu/test_device.hpp"

namespace tyndall::test {

enum class Mode : std::uint8_t { submit, single_command_buffer, folded, semaphores };
[[nodiscard]] Mode mode_from_environment();

/// A mapped buffer for uploads and read-back; freed with the fixture.
struct HostBuffer {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    void* mapped = nullptr;
    VkDeviceSize size_bytes = 0;

    template <typename T>
    [[nodiscard]] std::span<T> as() const {
        return {static_cast<T*>(mapped), static_cast<std::size_t>(size_bytes / sizeof(T))};
    }
};
/// An image of the host, in layout UNDEFINED; freed with the fixture.
struct HostImage {
    VkImage image = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
};
struct TestPipeline {
    VkPipeline pipeline = VK_NULL_HANDLE;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    std::vector<rg::ReflectedBinding> bindings; ///< of its shaders
};

/// What the shaders of one pipeline bind; one that is no module fails the test.
[[nodiscard]] std::vector<rg::ReflectedBinding>
reflected(std::initializer_list<std::span<const std::uint32_t>> shaders);

/// Imports of buffers that the host reads after the frame, and of those that it wrote before.
[[nodiscard]] rg::ImportDesc read_by_host();
[[nodiscard]] rg::ImportDesc written_by_host();

class GpuTest : public testing::Test {
protected:
    void SetUp() override;
    void TearDown() override; ///< fails on validation errors that take_errors has not taken

    [[nodiscard]] rg::ExecutorInfo executor_info() const;
    void make_executor(rg::ExecutorInfo info);
    [[nodiscard]] rg::Executor& executor() { return *executor_; }
    [[nodiscard]] TestDevice& gpu() { return *device_; }
    [[nodiscard]] const rg::DeviceTable& vk() const { return device_->table; }
    [[nodiscard]] Mode mode() const { return mode_; }
    [[nodiscard]] rg::QueueTopology topology() const;

    /// The plan of this mode; a failed compile fails the test.
    [[nodiscard]] rg::Plan compile(const rg::GraphDesc& graph, const rg::CompileOptions& options = {});
    /// Runs one frame to its end. Empty on success.
    [[nodiscard]] std::optional<rg::ExecuteError> execute(const rg::DeclaredGraph& graph, const rg::Plan& plan,
                                                          std::span<const rg::ImportBinding> imports);
    /// Compiles and executes; any error fails the test.
    void run(const rg::DeclaredGraph& graph, std::span<const rg::ImportBinding> imports);

    [[nodiscard]] HostBuffer host_buffer(VkDeviceSize size_bytes, VkBufferUsageFlags usage);
    [[nodiscard]] HostImage host_image(const rg::ImageDesc& desc, VkImageUsageFlags usage);
    [[nodiscard]] VkSampler nearest_sampler();
    /// Push descriptors in set 0; `push_bytes` of push constants for all stages.
    [[nodiscard]] TestPipeline compute_pipeline(std::span<const std::uint32_t> spirv,
                                                std::span<const VkDescriptorType> bindings, std::uint32_t push_bytes);
    /// A triangle that covers everything, no vertex input, one colour attachment.
    [[nodiscard]] TestPipeline graphics_pipeline(std::span<const std::uint32_t> vertex,
                                                 std::span<const std::uint32_t> fragment,
                                                 std::span<const VkDescriptorType> bindings, VkFormat color,
                                                 VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT);

    /// The validation errors so far, which then no longer fail the test.
    [[nodiscard]] std::vector<std::string> take_errors();

private:
    [[nodiscard]] TestPipeline pipeline_layout(std::span<const VkDescriptorType> bindings, std::uint32_t push_bytes,
                                               VkShaderStageFlags stages);
    [[nodiscard]] VkShaderModule shader_module(std::span<const std::uint32_t> spirv);
    [[nodiscard]] VkDeviceMemory allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags flags);

    Mode mode_ = Mode::submit;
    std::unique_ptr<TestDevice> device_;
    std::optional<rg::Executor> executor_;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkFence fence_ = VK_NULL_HANDLE;
    std::vector<HostBuffer> buffers_;
    std::vector<HostImage> images_;
    std::vector<VkSampler> samplers_;
    std::vector<TestPipeline> pipelines_;
    std::vector<VkDescriptorSetLayout> set_layouts_;
};

} // namespace tyndall::test
