#include "rendergraph/vulkan_names.hpp"

namespace tyndall::rg {
namespace {

constexpr VulkanName layouts[] = {
    {VK_IMAGE_LAYOUT_UNDEFINED, "undefined"},
    {VK_IMAGE_LAYOUT_GENERAL, "general"},
    {VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, "color attachment"},
    {VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, "depth attachment"},
    {VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL, "depth read-only"},
    {VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, "shader read-only"},
    {VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, "transfer source"},
    {VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, "transfer destination"},
    {VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, "present"},
};

// In the order of the pipeline, then those that only hosts name.
constexpr VulkanName stages[] = {
    {VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, "indirect"},
    {VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT, "index input"},
    {VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT, "vertex input"},
    {VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT, "vertex"},
    {VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, "fragment"},
    {VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT, "early tests"},
    {VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT, "late tests"},
    {VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT, "color output"},
    {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, "compute"},
    {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, "transfer"},
    {VK_PIPELINE_STAGE_2_HOST_BIT, "host"},
    {VK_PIPELINE_STAGE_2_ALL_GRAPHICS_BIT, "all graphics"},
    {VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, "all commands"},
    {VK_PIPELINE_STAGE_2_COPY_BIT, "copy"},
    {VK_PIPELINE_STAGE_2_BLIT_BIT, "blit"},
    {VK_PIPELINE_STAGE_2_CLEAR_BIT, "clear"},
    {VK_PIPELINE_STAGE_2_RESOLVE_BIT, "resolve"},
    {VK_PIPELINE_STAGE_2_TOP_OF_PIPE_BIT, "top of pipe"},
    {VK_PIPELINE_STAGE_2_BOTTOM_OF_PIPE_BIT, "bottom of pipe"},
    {VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR, "acceleration structure build"},
    {VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR, "ray tracing"},
};

constexpr VulkanName accesses[] = {
    {VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT, "indirect read"},
    {VK_ACCESS_2_INDEX_READ_BIT, "index read"},
    {VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT, "vertex read"},
    {VK_ACCESS_2_UNIFORM_READ_BIT, "uniform read"},
    {VK_ACCESS_2_SHADER_READ_BIT, "shader read"},
    {VK_ACCESS_2_SHADER_WRITE_BIT, "shader write"},
    {VK_ACCESS_2_SHADER_SAMPLED_READ_BIT, "sampled read"},
    {VK_ACCESS_2_SHADER_STORAGE_READ_BIT, "storage read"},
    {VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT, "storage write"},
    {VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT, "color read"},
    {VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT, "color write"},
    {VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT, "depth read"},
    {VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT, "depth write"},
    {VK_ACCESS_2_TRANSFER_READ_BIT, "transfer read"},
    {VK_ACCESS_2_TRANSFER_WRITE_BIT, "transfer write"},
    {VK_ACCESS_2_HOST_READ_BIT, "host read"},
    {VK_ACCESS_2_HOST_WRITE_BIT, "host write"},
    {VK_ACCESS_2_MEMORY_READ_BIT, "memory read"},
    {VK_ACCESS_2_MEMORY_WRITE_BIT, "memory write"},
    {VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR, "acceleration structure read"},
    {VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR, "acceleration structure write"},
};

constexpr VulkanName aspects[] = {
    {VK_IMAGE_ASPECT_COLOR_BIT, "color"},
    {VK_IMAGE_ASPECT_DEPTH_BIT, "depth"},
    {VK_IMAGE_ASPECT_STENCIL_BIT, "stencil"},
};

constexpr VulkanName image_usages[] = {
    {VK_IMAGE_USAGE_TRANSFER_SRC_BIT, "transfer source"},
    {VK_IMAGE_USAGE_TRANSFER_DST_BIT, "transfer destination"},
    {VK_IMAGE_USAGE_SAMPLED_BIT, "sampled"},
    {VK_IMAGE_USAGE_STORAGE_BIT, "storage"},
    {VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT, "color attachment"},
    {VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, "depth attachment"},
    {VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT, "transient attachment"},
    {VK_IMAGE_USAGE_INPUT_ATTACHMENT_BIT, "input attachment"},
};

constexpr VulkanName buffer_usages[] = {
    {VK_BUFFER_USAGE_TRANSFER_SRC_BIT, "transfer source"},
    {VK_BUFFER_USAGE_TRANSFER_DST_BIT, "transfer destination"},
    {VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT, "uniform texel"},
    {VK_BUFFER_USAGE_STORAGE_TEXEL_BUFFER_BIT, "storage texel"},
    {VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, "uniform"},
    {VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, "storage"},
    {VK_BUFFER_USAGE_INDEX_BUFFER_BIT, "index"},
    {VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, "vertex"},
    {VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT, "indirect"},
    {VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT, "device address"},
};

constexpr VulkanName image_flags[] = {
    {VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT, "mutable format"},
    {VK_IMAGE_CREATE_CUBE_COMPATIBLE_BIT, "cube compatible"},
    {VK_IMAGE_CREATE_ALIAS_BIT, "alias"},
    {VK_IMAGE_CREATE_2D_ARRAY_COMPATIBLE_BIT, "2D array compatible"},
};

} // namespace

VulkanNames layout_names() {
    return layouts;
}
VulkanNames stage_names() {
    return stages;
}
VulkanNames access_names() {
    return accesses;
}
VulkanNames aspect_names() {
    return aspects;
}
VulkanNames image_usage_names() {
    return image_usages;
}
VulkanNames buffer_usage_names() {
    return buffer_usages;
}
VulkanNames image_flag_names() {
    return image_flags;
}

std::optional<std::string_view> name_in(VulkanNames names, std::uint64_t value) {
    for (const VulkanName& entry : names) {
        if (entry.value == value) {
            return entry.name;
        }
    }
    return std::nullopt;
}

std::optional<std::uint64_t> value_in(VulkanNames names, std::string_view name) {
    for (const VulkanName& entry : names) {
        if (entry.name == name) {
            return entry.value;
        }
    }
    return std::nullopt;
}

std::string mask_text(VulkanNames names, std::uint64_t mask) {
    std::string text;
    for (const VulkanName& entry : names) {
        if ((mask & entry.value) == entry.value) {
            text += (text.empty() ? "" : "|") + std::string(entry.name);
            mask &= ~entry.value;
        }
    }
    if (mask != 0) {
        text += (text.empty() ? "" : "|") + std::to_string(mask);
    }
    return text.empty() ? "none" : text;
}

} // namespace tyndall::rg
