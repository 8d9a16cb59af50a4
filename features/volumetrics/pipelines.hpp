// Pipelines of the feature's passes, made when a frame first needs them and kept.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <tl/expected.hpp>

#include "features/volumetrics/error.hpp"
#include "features/volumetrics/shaders.hpp"
#include "rendergraph/device_table.hpp"
#include "rendergraph/shader_bindings.hpp"

namespace tyndall::volumetrics {

/// What a pass binds to record itself.
struct Program {
    VkPipelineLayout layout = VK_NULL_HANDLE;
    VkPipeline pipeline = VK_NULL_HANDLE;
    std::span<const rg::ReflectedBinding>
        bindings; ///< of its shaders, where they are checked; valid as the pipeline is
};

using GroupShape = std::array<std::uint32_t, 3>;

class Pipelines {
public:
    /// `check_bindings`: as rg::ExecutorInfo::check_bindings.
    Pipelines(const rg::DeviceTable& vk, VkDevice device, VkPipelineCache cache, bool check_bindings);
    Pipelines(const Pipelines&) = delete;
    Pipelines& operator=(const Pipelines&) = delete;
    ~Pipelines(); ///< no frame that uses a program may be in flight

    /// `constants` are the specialization constants from id 3 on; 0 to 2 are the group shape.
    [[nodiscard]] tl::expected<Program, Error> compute(const ShaderCode& shader, const GroupShape& group,
                                                       std::span<const std::uint32_t> constants = {});
    /// A full-screen triangle whose fragments are blended into one colour target as source * 1 + target * source alpha,
    /// or, with a second source, as source * 1 + target * second source. `constants` are the fragment shader's
    /// specialization constants from id 0 on.
    [[nodiscard]] tl::expected<Program, Error> full_screen_blend(const ShaderCode& vertex, const ShaderCode& fragment,
                                                                 VkFormat color_format, bool second_source,
                                                                 std::span<const std::uint32_t> constants = {});

private:
    struct Entry {
        std::vector<std::uint32_t> key; ///< group shape or the colour format, and constants
        const std::uint32_t* code = nullptr;
        VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
        std::vector<rg::ReflectedBinding> bindings; ///< what `program` refers to
        Program program;
    };
    [[nodiscard]] const Entry* find(const ShaderCode& shader, const std::vector<std::uint32_t>& key) const;
    [[nodiscard]] tl::expected<void, Error> make_layout(const ShaderCode& shader, VkShaderStageFlags stages,
                                                        Entry& entry);
    [[nodiscard]] tl::expected<VkShaderModule, Error> make_module(const ShaderCode& shader);
    /// Notes in `entry` what `shader` binds, where bindings are checked.
    [[nodiscard]] tl::expected<void, Error> reflect(const ShaderCode& shader, Entry& entry) const;
    Program keep(Entry entry);
    void destroy(Entry& entry);

    const rg::DeviceTable* vk_;
    VkDevice device_;
    VkPipelineCache cache_;
    bool check_bindings_;
    std::vector<Entry> entries_;
};

} // namespace tyndall::volumetrics
