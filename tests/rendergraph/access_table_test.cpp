// The access table against a hand transcription of the Vulkan 1.3 specification: which stages each access flag goes
// with ("Supported access types"), which queues have each stage ("Supported pipeline stage flags"), the layout and
// usage that each way of access needs ("Image Layouts", VkImageUsageFlagBits, VkBufferUsageFlagBits).
#include <gtest/gtest.h>

#include "rendergraph/access.hpp"

namespace tyndall::rg::test {
namespace {

constexpr VkPipelineStageFlags2 shader_stages =
    VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT |
    VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR |
    VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR; // which may read with SHADER_READ
constexpr VkPipelineStageFlags2 fragment_tests =
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT;

struct SupportedAccess {
    VkAccessFlags2 access;
    VkPipelineStageFlags2 stages;
};
constexpr SupportedAccess supported_accesses[] = {
    {VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT, VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT},
    {VK_ACCESS_2_INDEX_READ_BIT, VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT},
    {VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT, VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT},
    {VK_ACCESS_2_UNIFORM_READ_BIT, shader_stages},
    {VK_ACCESS_2_SHADER_READ_BIT, shader_stages},
    {VK_ACCESS_2_SHADER_SAMPLED_READ_BIT, shader_stages},
    {VK_ACCESS_2_SHADER_STORAGE_READ_BIT, shader_stages},
    {VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT, shader_stages},
    {VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT},
    {VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT},
    {VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT, fragment_tests},
    {VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT, fragment_tests},
    {VK_ACCESS_2_TRANSFER_READ_BIT, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT},
    {VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT},
    {VK_ACCESS_2_HOST_READ_BIT, VK_PIPELINE_STAGE_2_HOST_BIT},
    {VK_ACCESS_2_HOST_WRITE_BIT, VK_PIPELINE_STAGE_2_HOST_BIT},
    {VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR, shader_stages},
    {VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR, VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR},
};

struct SupportedStage {
    VkPipelineStageFlags2 stage;
    std::uint8_t queues; ///< capabilities, any of which is enough
};
constexpr SupportedStage supported_stages[] = {
    {VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, can_graphics | can_compute},
    {VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT, can_graphics},
    {VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT, can_graphics},
    {VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT, can_graphics},
    {VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, can_graphics},
    {VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT, can_graphics},
    {VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT, can_graphics},
    {VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT, can_graphics},
    {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, can_compute},
    {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, can_graphics | can_compute | can_transfer},
    {VK_PIPELINE_STAGE_2_HOST_BIT, can_host},
    {VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR, can_compute},
    {VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR, can_compute},
};

/// Layouts that the specification lets an image be in for one way of access, besides GENERAL, and the usages of which
/// it needs one.
struct Binding {
    Access access;
    VkImageLayout color, depth, depth_read_only;
    VkImageUsageFlags image;
    VkBufferUsageFlags buffer;
};
constexpr VkImageLayout general = VK_IMAGE_LAYOUT_GENERAL;
constexpr VkImageLayout none_of_them = VK_IMAGE_LAYOUT_UNDEFINED;
constexpr VkImageLayout sampled = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
constexpr VkImageLayout depth_read = VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL; // sampled, input or tested
constexpr VkImageLayout depth_write = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
constexpr VkImageLayout color = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
constexpr VkImageLayout source = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
constexpr VkImageLayout destination = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
constexpr VkBufferUsageFlags texels = VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
constexpr VkBufferUsageFlags structure = VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR;
constexpr Binding bindings[] = {
    {Access::indirect_argument, none_of_them, none_of_them, none_of_them, 0, VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT},
    {Access::index_buffer, none_of_them, none_of_them, none_of_them, 0, VK_BUFFER_USAGE_INDEX_BUFFER_BIT},
    {Access::vertex_buffer, none_of_them, none_of_them, none_of_them, 0, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT},
    {Access::uniform_graphics, none_of_them, none_of_them, none_of_them, 0, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT},
    {Access::uniform_compute, none_of_them, none_of_them, none_of_them, 0, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT},
    {Access::sampled_graphics, sampled, depth_read, depth_read, VK_IMAGE_USAGE_SAMPLED_BIT, texels},
    {Access::sampled_fragment, sampled, depth_read, depth_read, VK_IMAGE_USAGE_SAMPLED_BIT, texels},
    {Access::sampled_compute, sampled, depth_read, depth_read, VK_IMAGE_USAGE_SAMPLED_BIT, texels},
    {Access::storage_graphics, general, general, general, VK_IMAGE_USAGE_STORAGE_BIT,
     VK_BUFFER_USAGE_STORAGE_BUFFER_BIT},
    {Access::storage_fragment, general, general, general, VK_IMAGE_USAGE_STORAGE_BIT,
     VK_BUFFER_USAGE_STORAGE_BUFFER_BIT},
    {Access::storage_compute, general, general, general, VK_IMAGE_USAGE_STORAGE_BIT,
     VK_BUFFER_USAGE_STORAGE_BUFFER_BIT},
    {Access::color_attachment, color, none_of_them, none_of_them, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT, 0},
    {Access::depth_attachment, none_of_them, depth_write, depth_read, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, 0},
    {Access::resolve_attachment, color, none_of_them, none_of_them, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT, 0},
    {Access::transfer_source, source, source, source, VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
     VK_BUFFER_USAGE_TRANSFER_SRC_BIT},
    {Access::transfer_destination, destination, destination, destination, VK_IMAGE_USAGE_TRANSFER_DST_BIT,
     VK_BUFFER_USAGE_TRANSFER_DST_BIT},
    {Access::host, general, general, general, 0, VK_BUFFER_USAGE_TRANSFER_DST_BIT},
    {Access::acceleration_structure_build, none_of_them, none_of_them, none_of_them, 0, structure},
    {Access::acceleration_structure_trace, none_of_them, none_of_them, none_of_them, 0, structure},
    {Access::present, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, none_of_them, none_of_them, 0, 0},
};

/// The stages and masks by which the commands of each row touch memory, by the specification's words on each command.
struct Commands {
    Access access;
    VkPipelineStageFlags2 stages;
    VkAccessFlags2 reads, writes;
};
constexpr VkPipelineStageFlags2 drawing =
    VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT;
constexpr VkPipelineStageFlags2 fragment = VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT;
constexpr VkPipelineStageFlags2 compute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
constexpr VkPipelineStageFlags2 output = VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT;
constexpr VkPipelineStageFlags2 transfer = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
constexpr VkAccessFlags2 storage_read = VK_ACCESS_2_SHADER_STORAGE_READ_BIT;
constexpr VkAccessFlags2 storage_write = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
constexpr Commands commands[] = {
    {Access::indirect_argument, VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT, 0},
    {Access::index_buffer, VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT, VK_ACCESS_2_INDEX_READ_BIT, 0},
    {Access::vertex_buffer, VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT, VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT, 0},
    {Access::uniform_graphics, drawing, VK_ACCESS_2_UNIFORM_READ_BIT, 0},
    {Access::uniform_compute, compute, VK_ACCESS_2_UNIFORM_READ_BIT, 0},
    {Access::sampled_graphics, drawing, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT, 0},
    {Access::sampled_fragment, fragment, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT, 0},
    {Access::sampled_compute, compute, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT, 0},
    {Access::storage_graphics, drawing, storage_read, storage_write},
    {Access::storage_fragment, fragment, storage_read, storage_write},
    {Access::storage_compute, compute, storage_read, storage_write},
    {Access::color_attachment, output, VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT, VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT},
    {Access::depth_attachment, fragment_tests, VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT,
     VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT},
    {Access::resolve_attachment, output, 0, VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT},
    {Access::transfer_source, transfer, VK_ACCESS_2_TRANSFER_READ_BIT, 0},
    {Access::transfer_destination, transfer, 0, VK_ACCESS_2_TRANSFER_WRITE_BIT},
    {Access::host, VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT, VK_ACCESS_2_HOST_WRITE_BIT},
    {Access::acceleration_structure_build, VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
     VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR | VK_ACCESS_2_SHADER_READ_BIT,
     VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR},
    {Access::acceleration_structure_trace, VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR | compute,
     VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR, 0},
    {Access::present, 0, 0, 0},
};
static_assert(std::size(bindings) == access_count && std::size(commands) == access_count);

TEST(AccessTable, StagesAndMasksAreThoseOfTheCommands) {
    for (const Commands& row : commands) {
        const AccessInfo& info = access_info(row.access);
        EXPECT_EQ(info.stages, row.stages) << info.name;
        EXPECT_EQ(info.read_mask, row.reads) << info.name;
        EXPECT_EQ(info.write_mask, row.writes) << info.name;
    }
}

TEST(AccessTable, LayoutsAndUsagesAreThoseOfTheBinding) {
    for (const Binding& row : bindings) {
        const AccessInfo& info = access_info(row.access);
        EXPECT_EQ(info.color_layout, row.color) << info.name;
        EXPECT_EQ(info.depth_layout, row.depth) << info.name;
        EXPECT_EQ(info.depth_read_only_layout, row.depth_read_only) << info.name;
        EXPECT_EQ(info.image_usage, row.image) << info.name;
        EXPECT_EQ(info.buffer_usage, row.buffer) << info.name;
    }
}

TEST(AccessTable, EveryMaskGoesWithItsStages) {
    for (std::size_t i = 0; i < access_count; ++i) {
        const AccessInfo& info = access_info(static_cast<Access>(i));
        VkPipelineStageFlags2 of_masks = 0;
        VkAccessFlags2 known = 0;
        for (const SupportedAccess& row : supported_accesses) {
            if (((info.read_mask | info.write_mask) & row.access) != 0) {
                known |= row.access;
                of_masks |= row.stages;
                EXPECT_NE(row.stages & info.stages, 0U) << info.name << " has a mask that none of its stages can do";
            }
        }
        EXPECT_EQ(known, info.read_mask | info.write_mask) << info.name;
        EXPECT_EQ(info.stages & ~of_masks, 0U) << info.name << " has a stage that does none of its accesses";
    }
}

TEST(AccessTable, EveryQueueThatMayDoItHasItsStages) {
    for (std::size_t i = 0; i < access_count; ++i) {
        const AccessInfo& info = access_info(static_cast<Access>(i));
        VkPipelineStageFlags2 known = 0;
        for (const SupportedStage& row : supported_stages) {
            if ((info.stages & row.stage) == 0) {
                continue;
            }
            known |= row.stage;
            EXPECT_EQ(info.needs & ~row.queues, 0) << info.name << " is let onto a queue that lacks one of its stages";
        }
        EXPECT_EQ(known, info.stages) << info.name;
        EXPECT_NE(info.needs, 0) << info.name;
    }
}

} // namespace
} // namespace tyndall::rg::test
