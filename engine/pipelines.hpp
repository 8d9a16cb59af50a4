// Pipelines, their layouts, and the cache that outlives the process.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include <tl/expected.hpp>
#include <vulkan/vulkan.h>

#include "engine/device.hpp"
#include "engine/error.hpp"
#include "rendergraph/shader_bindings.hpp"

namespace tyndall::engine {

/// A device object that is destroyed with its holder. `destroy` is the member of DeviceTable that does it.
template <typename T, auto destroy>
class Unique {
public:
    Unique() = default;
    Unique(const Device& device, T handle) : device_(&device), handle_(handle) {}
    Unique(Unique&& other) noexcept { *this = std::move(other); }
    Unique& operator=(Unique&& other) noexcept {
        std::swap(device_, other.device_);
        std::swap(handle_, other.handle_);
        return *this;
    }
    Unique(const Unique&) = delete;
    Unique& operator=(const Unique&) = delete;
    ~Unique() {
        if (device_ != nullptr) {
            (device_->vk().*destroy)(device_->handle(), handle_, nullptr);
        }
    }
    [[nodiscard]] T get() const { return handle_; }
    [[nodiscard]] explicit operator bool() const { return handle_ != VK_NULL_HANDLE; }

private:
    const Device* device_ = nullptr;
    T handle_ = VK_NULL_HANDLE;
};
using PipelineLayout = Unique<VkPipelineLayout, &rg::DeviceTable::DestroyPipelineLayout>;
using DescriptorSetLayout = Unique<VkDescriptorSetLayout, &rg::DeviceTable::DestroyDescriptorSetLayout>;
using DescriptorPool = Unique<VkDescriptorPool, &rg::DeviceTable::DestroyDescriptorPool>;
using DeviceSampler = Unique<VkSampler, &rg::DeviceTable::DestroySampler>;

/// A pipeline and what its shaders bind, for PassContext::push.
class Pipeline {
public:
    Pipeline() = default;
    Pipeline(const Device& device, VkPipeline handle, std::vector<rg::ReflectedBinding> bindings)
        : pipeline_(device, handle), bindings_(std::move(bindings)) {}
    [[nodiscard]] VkPipeline get() const { return pipeline_.get(); }
    /// Of all its stages, as rg::merge_bindings has them. They stay where they are when the pipeline is moved.
    [[nodiscard]] std::span<const rg::ReflectedBinding> bindings() const { return bindings_; }

private:
    Unique<VkPipeline, &rg::DeviceTable::DestroyPipeline> pipeline_;
    std::vector<rg::ReflectedBinding> bindings_;
};

/// VkPipelineCache kept in a file between runs. A file that is broken, or of another device or driver, is ignored.
class PipelineCache {
public:
    /// `folder` empty: $XDG_CACHE_HOME/tyndall or ~/.cache/tyndall; without either, nothing is kept.
    [[nodiscard]] static tl::expected<PipelineCache, Error> create(const Device& device,
                                                                   const std::filesystem::path& folder = {});
    PipelineCache(PipelineCache&& other) noexcept;
    PipelineCache& operator=(PipelineCache&&) = delete;
    PipelineCache(const PipelineCache&) = delete;
    PipelineCache& operator=(const PipelineCache&) = delete;
    ~PipelineCache(); ///< saves

    [[nodiscard]] VkPipelineCache handle() const { return cache_; }
    [[nodiscard]] const std::filesystem::path& file() const { return file_; }
    [[nodiscard]] std::size_t loaded_bytes() const { return loaded_bytes_; } ///< 0: started empty
    /// Written beside the old file and renamed over it; false when that could not be done.
    bool save() const;

private:
    PipelineCache() = default;
    const Device* device_ = nullptr;
    VkPipelineCache cache_ = VK_NULL_HANDLE;
    std::filesystem::path file_;
    std::size_t loaded_bytes_ = 0;
};

/// With `push`, for vkCmdPushDescriptorSetKHR: at most DeviceInfo::max_push_descriptors descriptors.
[[nodiscard]] tl::expected<DescriptorSetLayout, Error>
create_set_layout(const Device& device, std::span<const VkDescriptorSetLayoutBinding> bindings, bool push);
[[nodiscard]] tl::expected<PipelineLayout, Error> create_pipeline_layout(const Device& device,
                                                                         std::span<const VkDescriptorSetLayout> sets,
                                                                         std::uint32_t push_constant_bytes = 0,
                                                                         VkShaderStageFlags push_constant_stages = 0);

/// A 32-bit specialization constant.
struct SpecializationConstant {
    std::uint32_t id = 0;
    std::uint32_t value = 0;
};

/// Refuses words that rg::reflect_bindings cannot read, as create_graphics_pipeline does.
[[nodiscard]] tl::expected<Pipeline, Error>
create_compute_pipeline(const Device& device, VkPipelineCache cache, VkPipelineLayout layout,
                        std::span<const std::uint32_t> spirv, std::span<const SpecializationConstant> constants = {});

/// source + (1 - source alpha) * destination; with two sources source + second source * destination.
[[nodiscard]] VkPipelineColorBlendAttachmentState laid_over(bool two_sources);

struct GraphicsPipelineInfo {
    VkPipelineLayout layout = VK_NULL_HANDLE;
    std::span<const std::uint32_t> vertex_spirv;
    std::span<const std::uint32_t> fragment_spirv; ///< may be empty: depth only
    std::span<const SpecializationConstant> constants;
    std::span<const VkVertexInputBindingDescription> vertex_bindings;
    std::span<const VkVertexInputAttributeDescription> vertex_attributes;
    std::span<const VkFormat> color_formats;
    VkFormat depth_format = VK_FORMAT_UNDEFINED;
    std::span<const VkPipelineColorBlendAttachmentState> blends; ///< as many as colour formats; empty: no blending
    bool depth_test = false;
    bool depth_write = false;
    VkCompareOp depth_compare = VK_COMPARE_OP_GREATER;
    bool depth_clamp = false;
    VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    VkCullModeFlags cull = VK_CULL_MODE_NONE;
    VkFrontFace front = VK_FRONT_FACE_COUNTER_CLOCKWISE;
    /// Cull mode and front face are set while recording instead (vkCmdSetCullMode, vkCmdSetFrontFace).
    bool dynamic_culling = false;
    bool dynamic_depth_bias = false;
};
/// For dynamic rendering; viewport and scissor are dynamic.
[[nodiscard]] tl::expected<Pipeline, Error> create_graphics_pipeline(const Device& device, VkPipelineCache cache,
                                                                     const GraphicsPipelineInfo& info);

[[nodiscard]] tl::expected<DeviceSampler, Error> create_sampler(const Device& device, const VkSamplerCreateInfo& info);

} // namespace tyndall::engine
