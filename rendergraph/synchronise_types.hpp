// What synchronise reasons about: groups of uses of one cell, what came before them, and the dependency between.
// Internal.
#pragma once

#include <algorithm>

#include "rendergraph/stages.hpp"

namespace tyndall::rg::stages {

inline constexpr VkAccessFlags2 any_write =
    VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT |
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT | VK_ACCESS_2_HOST_WRITE_BIT |
    VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR | VK_ACCESS_2_MEMORY_WRITE_BIT | VK_ACCESS_2_SHADER_WRITE_BIT;

/// Can a queue of these capabilities have all of these stages?
[[nodiscard]] inline bool queue_has(std::uint8_t capabilities, VkPipelineStageFlags2 stages) {
    constexpr VkPipelineStageFlags2 on_any_queue = VK_PIPELINE_STAGE_2_TOP_OF_PIPE_BIT | VK_PIPELINE_STAGE_2_HOST_BIT |
                                                   VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT |
                                                   VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT | VK_PIPELINE_STAGE_2_COPY_BIT;
    constexpr VkPipelineStageFlags2 of_compute =
        VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_2_CLEAR_BIT;
    const VkPipelineStageFlags2 there = (capabilities & can_compute) != 0 ? on_any_queue | of_compute : on_any_queue;
    return (capabilities & can_graphics) != 0 || (stages & ~there) == 0;
}

/// The stages, where the queue has them; else all commands, which what another queue does is chained to by a semaphore.
[[nodiscard]] inline VkPipelineStageFlags2 nameable(std::uint8_t capabilities, VkPipelineStageFlags2 stages) {
    return queue_has(capabilities, stages) ? stages : VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
}

/// Uses of one cell that need nothing of each other.
struct Group {
    Uses uses;
    bool writes = false;
    bool discards = false; ///< a write that does not read
    VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
};

/// The group that `uses` begins with.
[[nodiscard]] inline Group first_group(Uses uses) {
    const Use& first = *uses.front();
    std::size_t count = 1;
    while (count < uses.size() && !first.writes && !uses[count]->writes &&
           uses[count]->scope.layout == first.scope.layout) {
        ++count;
    }
    return {uses.first(count), first.writes, first.writes && !first.reads, first.scope.layout};
}

/// What came before a group: other uses, or the state on the way in.
struct Before {
    Uses uses;
    VkPipelineStageFlags2 host_stages = 0; ///< imports: the host's last use
    VkAccessFlags2 host_access = 0;
    std::uint32_t host_family = VK_QUEUE_FAMILY_IGNORED;
    VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
    Hazard entry = Hazard::frame_entry;
    bool in_frame = false; ///< `uses` are of this very resource
    bool written =
        false; ///< or moved to another layout or owner, in this frame; or by the host, ordered by barriers alone
    bool content = true; ///< there is content that a transition must keep
    std::uint32_t alias_of = none;
};

[[nodiscard]] inline Before state_after(const Group& group) {
    Before before;
    before.uses = group.uses;
    before.layout = group.layout;
    before.in_frame = true;
    return before;
}

[[nodiscard]] inline Hazard hazard_of(const Before& before, const Group& group) {
    if (!before.in_frame) {
        return before.entry;
    }
    const bool after_write = before.uses.front()->writes;
    if (group.writes) {
        return !after_write     ? Hazard::write_after_read
               : group.discards ? Hazard::write_after_write
                                : Hazard::read_after_write;
    }
    return after_write ? Hazard::read_after_write : Hazard::layout_change;
}

/// What made the content visible to the readers made it visible to such an access as well: the masks of a group are
/// one barrier's.
[[nodiscard]] inline bool sees_as_much(const Before& before, std::uint32_t queue, VkPipelineStageFlags2 stages,
                                       VkAccessFlags2 access) {
    for (const Use* use : before.uses) {
        if (use->writes || use->queue != queue) {
            return false;
        }
        stages &= ~use->scope.stages;
        access &= ~use->scope.access;
    }
    return stages == 0 && access == 0;
}

/// The host wants all of an import in its final state, also the parts that no pass touched.
[[nodiscard]] inline bool changes_untouched_parts(const GraphDesc& graph, std::uint32_t resource, bool concurrent) {
    const ResourceDesc& desc = graph.resources[resource];
    const ImportDesc import = desc.import == none ? ImportDesc{} : graph.imports[desc.import];
    const bool moves = !concurrent && import.initial_family != import.final_family &&
                       import.initial_family != VK_QUEUE_FAMILY_IGNORED &&
                       import.final_family != VK_QUEUE_FAMILY_IGNORED;
    const bool changes = desc.kind == ResourceKind::image && import.final_layout != import.initial_layout;
    return import.has_final && (moves || changes);
}

struct FoundDependency {
    Dependency dependency = {};
    std::uint32_t slot = 0; ///< of the consumer, the number of slots for exits
    std::uint32_t release_batch = none;
    bool only_at_release = false;   ///< recorded at the end of release_batch and nowhere else
    std::uint32_t after_passes = 0; ///< its producers of its own queue are among that queue's first so many passes
};

/// Nothing yet, before a slot.
[[nodiscard]] inline FoundDependency found_before(std::uint32_t slot) {
    static constexpr FoundDependency empty; // copying one is quicker than making one
    FoundDependency found = empty;
    found.slot = slot;
    return found;
}

/// Takes away what other barriers of the queue, recorded between producer and consumer, order anyway: from
/// dependencies that carry no memory, single stages; all of one where nothing of it is left, whose dst_stages are 0
/// then. `order` are indices into `found` by slot. O(found x stages), squared within a slot.
void leave_out_covered(std::span<const std::uint32_t> order, const Schedule& schedule,
                       std::span<FoundDependency> found);

[[nodiscard]] inline bool is_left_out(const FoundDependency& found) {
    return found.dependency.src_stages == 0 && found.dependency.dst_stages == 0 &&
           found.dependency.old_layout == found.dependency.new_layout && !found.dependency.transfers_ownership;
}

/// Fills the dependencies of `out`, whose `releases` has a list for each batch, in the order in which a frame records
/// them. Exits have as slot the number of slots. O(found) and leave_out_covered.
void collect(std::span<FoundDependency> found, const Schedule& schedule, Synchronised& out);

[[nodiscard]] inline bool same_but_range(const Dependency& a, const Dependency& b) {
    return a.producer == b.producer && a.consumer == b.consumer && a.hazard == b.hazard &&
           a.transfers_ownership == b.transfers_ownership && a.discards == b.discards && a.src_stages == b.src_stages &&
           a.src_access == b.src_access && a.local_stages == b.local_stages && a.local_access == b.local_access &&
           a.dst_stages == b.dst_stages && a.dst_access == b.dst_access && a.old_layout == b.old_layout &&
           a.new_layout == b.new_layout && a.src_queue == b.src_queue && a.dst_queue == b.dst_queue;
}

} // namespace tyndall::rg::stages
