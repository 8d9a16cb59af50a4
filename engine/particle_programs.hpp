// Pipelines of the particle passes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <tl/expected.hpp>

#include "engine/error.hpp"
#include "rendergraph/device_table.hpp"

namespace tyndall::engine {

/// What particles are made with. Everything outlives what is made.
struct ParticleDevice {
    const rg::DeviceTable* vk = nullptr;
    VkDevice device = VK_NULL_HANDLE;
    VkPipelineCache cache = VK_NULL_HANDLE;
    VkPhysicalDeviceMemoryProperties memory = {};
};

/// What a pass binds to record itself.
struct ParticleProgram {
    VkPipelineLayout layout = VK_NULL_HANDLE;
    VkPipeline pipeline = VK_NULL_HANDLE;
};

/// A descriptor of set 0, which is pushed.
struct ParticleBinding {
    std::uint32_t binding;
    VkDescriptorType type;
    VkShaderStageFlags stages;
};

/// Makes programs and keeps them until it is destroyed; no frame that uses one may be in flight then.
class ParticlePrograms {
public:
    explicit ParticlePrograms(const ParticleDevice& device) : device_(device) {}
    ParticlePrograms(const ParticlePrograms&) = delete;
    ParticlePrograms& operator=(const ParticlePrograms&) = delete;
    ~ParticlePrograms();

    /// `constants` are the specialization constants from id 0 on.
    [[nodiscard]] tl::expected<ParticleProgram, Error> compute(std::span<const std::uint32_t> spirv,
                                                               std::span<const ParticleBinding> bindings,
                                                               std::uint32_t push_bytes,
                                                               std::span<const std::uint32_t> constants);

    /// Triangles without vertex input, blended as premultiplied colour, tested against a reverse-z depth that they do
    /// not write.
    [[nodiscard]] tl::expected<ParticleProgram, Error> billboards(std::span<const std::uint32_t> vertex,
                                                                  std::span<const std::uint32_t> fragment,
                                                                  std::span<const ParticleBinding> bindings,
                                                                  VkFormat color_format, VkFormat depth_format);

private:
    struct Entry {
        VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
        ParticleProgram program;
    };
    /// A new entry with its layout; the pipeline is still to be made.
    [[nodiscard]] tl::expected<Entry*, Error> make_layout(std::span<const ParticleBinding> bindings,
                                                          const VkPushConstantRange& push);
    [[nodiscard]] tl::expected<VkShaderModule, Error> make_module(std::span<const std::uint32_t> spirv);

    ParticleDevice device_;
    std::vector<Entry> entries_;
};

} // namespace tyndall::engine
