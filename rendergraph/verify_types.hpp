// What the checker reasons about: masks, regions of resources, and what recording a dependency does. Internal; it
// shares nothing with the stages of compile.
#pragma once

#include <optional>

#include "rendergraph/verify.hpp"

namespace tyndall::rg::checker {

/// Indices inside their tables, ranges inside their resources, every pass planned or left out once, batches in order,
/// placements inside their heaps.
[[nodiscard]] std::vector<Violation> check_form(const GraphDesc& graph, const Plan& plan);

/// Whether the plan keeps the form of its variant to which a pass belongs; passes of other forms do not exist for it.
[[nodiscard]] bool of_kept_form(const GraphDesc& graph, const Plan& plan, std::uint32_t pass);

inline constexpr VkPipelineStageFlags2 all_commands = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
inline constexpr VkAccessFlags2 writing =
    VK_ACCESS_2_SHADER_WRITE_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT |
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT | VK_ACCESS_2_HOST_WRITE_BIT |
    VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR;

/// `mask` names each kind of access in `access`.
[[nodiscard]] inline bool covers_access(VkAccessFlags2 mask, VkAccessFlags2 access) {
    const bool all_reads = (mask & VK_ACCESS_2_MEMORY_READ_BIT) != 0;
    const bool all_writes = (mask & VK_ACCESS_2_MEMORY_WRITE_BIT) != 0;
    access &= ~mask;
    access &= all_reads ? writing : ~VkAccessFlags2{0};
    access &= all_writes ? ~writing : ~VkAccessFlags2{0};
    return access == 0;
}

/// What a queue of such capabilities cannot name in a stage mask.
[[nodiscard]] VkPipelineStageFlags2 stages_it_lacks(VkPipelineStageFlags2 stages, std::uint8_t capabilities);

/// A part of a resource: mips x layers of an image, or bytes of a buffer.
struct Region {
    std::uint64_t first_a = 0, end_a = 1; ///< mips, or bytes
    std::uint64_t first_b = 0, end_b = 1; ///< layers
};
[[nodiscard]] Region region_of(const ResourceDesc& resource, const ImageRange& image, const BufferRange& buffer);

/// What recording one dependency does.
struct Effect {
    VkPipelineStageFlags2 src, dst;
    VkAccessFlags2 src_access, dst_access;
    const Dependency* d;
    bool changes_layout;
    bool changes_owner;
};
enum class Recorded : std::uint8_t { before_consumer, at_batch_end, at_exit };
/// What it does in such a place; nothing where a semaphore is all that it needs.
[[nodiscard]] std::optional<Effect> effect_of(const Dependency& d, Recorded place, std::uint8_t capabilities);

} // namespace tyndall::rg::checker
