#include "rendergraph/access.hpp"

#include <array>

namespace tyndall::rg {
namespace {

constexpr VkPipelineStageFlags2 graphics_shaders =
    VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT;
constexpr VkPipelineStageFlags2 fragment_tests =
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT;

constexpr VkImageLayout no_image = VK_IMAGE_LAYOUT_UNDEFINED;
constexpr VkImageLayout general = VK_IMAGE_LAYOUT_GENERAL;
constexpr VkImageLayout shader_read = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
constexpr VkImageLayout depth_read = VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL;
constexpr VkImageLayout depth_write = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
constexpr VkImageLayout color_write = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
constexpr VkImageLayout copy_source = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
constexpr VkImageLayout copy_destination = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;

// In the order of the enumeration. Sampling a depth image uses the read-only attachment layout, so that the same pass,
// and the passes around it, can test against it without a transition.
constexpr std::array<AccessInfo, access_count> table = {{
    {"indirect_argument", VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT, 0, no_image,
     no_image, no_image, 0, VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT, can_graphics | can_compute},
    {"index_buffer", VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT, VK_ACCESS_2_INDEX_READ_BIT, 0, no_image, no_image, no_image,
     0, VK_BUFFER_USAGE_INDEX_BUFFER_BIT, can_graphics},
    {"vertex_buffer", VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT, VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT, 0,
     no_image, no_image, no_image, 0, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, can_graphics},
    {"uniform_graphics", graphics_shaders, VK_ACCESS_2_UNIFORM_READ_BIT, 0, no_image, no_image, no_image, 0,
     VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, can_graphics},
    {"uniform_compute", VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_UNIFORM_READ_BIT, 0, no_image, no_image,
     no_image, 0, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, can_compute},
    {"sampled_graphics", graphics_shaders, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT, 0, shader_read, depth_read, depth_read,
     VK_IMAGE_USAGE_SAMPLED_BIT, VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT, can_graphics},
    {"sampled_fragment", VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT, 0, shader_read,
     depth_read, depth_read, VK_IMAGE_USAGE_SAMPLED_BIT, VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT, can_graphics},
    {"sampled_compute", VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT, 0, shader_read,
     depth_read, depth_read, VK_IMAGE_USAGE_SAMPLED_BIT, VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT, can_compute},
    {"storage_graphics", graphics_shaders, VK_ACCESS_2_SHADER_STORAGE_READ_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
     general, general, general, VK_IMAGE_USAGE_STORAGE_BIT, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, can_graphics},
    {"storage_fragment", VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_READ_BIT,
     VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT, general, general, general, VK_IMAGE_USAGE_STORAGE_BIT,
     VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, can_graphics},
    {"storage_compute", VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_READ_BIT,
     VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT, general, general, general, VK_IMAGE_USAGE_STORAGE_BIT,
     VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, can_compute},
    {"color_attachment", VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT, VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT,
     VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT, color_write, no_image, no_image, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT, 0,
     can_graphics},
    {"depth_attachment", fragment_tests, VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT,
     VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT, no_image, depth_write, depth_read,
     VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, 0, can_graphics},
    {"resolve_attachment", VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT, 0, VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
     color_write, no_image, no_image, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT, 0, can_graphics},
    {"transfer_source", VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT, 0, copy_source,
     copy_source, copy_source, VK_IMAGE_USAGE_TRANSFER_SRC_BIT, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, can_transfer},
    {"transfer_destination", VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, 0, VK_ACCESS_2_TRANSFER_WRITE_BIT, copy_destination,
     copy_destination, copy_destination, VK_IMAGE_USAGE_TRANSFER_DST_BIT, VK_BUFFER_USAGE_TRANSFER_DST_BIT,
     can_transfer},
    {"host", VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT, VK_ACCESS_2_HOST_WRITE_BIT, general, general,
     general, 0, VK_BUFFER_USAGE_TRANSFER_DST_BIT, can_host},
    {"acceleration_structure_build", VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
     VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR | VK_ACCESS_2_SHADER_READ_BIT,
     VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR, no_image, no_image, no_image, 0,
     VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR, can_compute},
    {"acceleration_structure_trace",
     VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
     VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR, 0, no_image, no_image, no_image, 0,
     VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR, can_compute},
    {"present", VK_PIPELINE_STAGE_2_NONE, VK_ACCESS_2_NONE, VK_ACCESS_2_NONE, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, no_image,
     no_image, 0, 0, can_graphics | can_compute | can_transfer},
}};
static_assert(table[static_cast<std::size_t>(Access::present)].name == "present");
static_assert(table[static_cast<std::size_t>(Access::color_attachment)].name == "color_attachment");

} // namespace

const AccessInfo& access_info(Access access) {
    return table[static_cast<std::size_t>(access)];
}

std::optional<Access> access_from_name(std::string_view name) {
    for (std::size_t i = 0; i < table.size(); ++i) {
        if (table[i].name == name) {
            return static_cast<Access>(i);
        }
    }
    return std::nullopt;
}

VkImageAspectFlags format_aspects(VkFormat format) {
    switch (format) {
    case VK_FORMAT_D16_UNORM:
    case VK_FORMAT_X8_D24_UNORM_PACK32:
    case VK_FORMAT_D32_SFLOAT: return VK_IMAGE_ASPECT_DEPTH_BIT;
    case VK_FORMAT_S8_UINT: return VK_IMAGE_ASPECT_STENCIL_BIT;
    case VK_FORMAT_D16_UNORM_S8_UINT:
    case VK_FORMAT_D24_UNORM_S8_UINT:
    case VK_FORMAT_D32_SFLOAT_S8_UINT: return VK_IMAGE_ASPECT_DEPTH_BIT | VK_IMAGE_ASPECT_STENCIL_BIT;
    default: return VK_IMAGE_ASPECT_COLOR_BIT;
    }
}

bool is_depth_or_stencil(VkFormat format) {
    return (format_aspects(format) & VK_IMAGE_ASPECT_COLOR_BIT) == 0;
}

} // namespace tyndall::rg
