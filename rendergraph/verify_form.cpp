// The plan's form, before anything is replayed: indices inside their tables, ranges inside their resources, everything
// there once; and what its records mean to a queue. O(size of the plan).
#include <algorithm>

#include "rendergraph/verify_types.hpp"

namespace tyndall::rg {
namespace checker {
namespace {

bool inside(const ResourceDesc& resource, const Region& region) {
    const bool image = resource.kind == ResourceKind::image;
    const std::uint64_t end_a = image ? resource.image.mips : resource.buffer.size_bytes;
    const std::uint64_t end_b = image ? resource.image.layers : 1;
    return region.first_a < region.end_a && region.end_a <= end_a && region.first_b < region.end_b &&
           region.end_b <= end_b;
}

template <typename T>
bool is_run_of(const std::vector<T>& table, std::uint32_t first, std::uint32_t count) {
    return first <= table.size() && count <= table.size() - first;
}

std::string pass_mistake(const GraphDesc& graph, const Plan& plan) {
    if (plan.variants.size() != graph.variants.size()) {
        return "the plan does not say which form of each variant it has";
    }
    std::vector<std::uint32_t> seen(graph.passes.size(), 0);
    for (const PlannedPass& planned : plan.passes) {
        if (planned.pass >= graph.passes.size() || planned.queue >= plan.topology.queues.size() ||
            !is_run_of(plan.dependencies, planned.first_barrier, planned.barrier_count) ||
            !is_run_of(plan.attachments, planned.first_attachment, planned.attachment_count)) {
            return "a planned pass points outside the graph, the queues, the dependencies or the attachments";
        }
        if (!of_kept_form(graph, plan, planned.pass)) {
            return "a pass of a form that is not kept is planned";
        }
        ++seen[planned.pass];
    }
    for (const CulledPass& culled : plan.culled_passes) {
        if (culled.pass >= graph.passes.size()) {
            return "a pass that is left out is not in the graph";
        }
        if (graph.passes[culled.pass].has_side_effect && of_kept_form(graph, plan, culled.pass)) {
            return "a pass with a side effect is left out";
        }
        ++seen[culled.pass];
    }
    if (std::any_of(seen.begin(), seen.end(), [](std::uint32_t n) { return n != 1; })) {
        return "some pass is neither planned nor left out, or both, or twice";
    }
    return {};
}

std::string batch_mistake(const Plan& plan) {
    std::uint32_t next = 0;
    for (const Batch& b : plan.batches) {
        if (b.first_pass != next || !is_run_of(plan.passes, b.first_pass, b.pass_count) ||
            b.queue >= plan.topology.queues.size()) {
            return "the batches do not follow the passes";
        }
        next += b.pass_count;
        for (const std::uint32_t d : b.releases) {
            if (d >= plan.dependencies.size()) {
                return "a batch releases a dependency that does not exist";
            }
        }
        for (const std::vector<std::uint32_t>* imports : {&b.waits_imports, &b.signals_imports}) {
            if (std::any_of(imports->begin(), imports->end(),
                            [&](std::uint32_t r) { return r >= plan.placements.size(); })) {
                return "a batch waits for or signals an import that does not exist";
            }
        }
    }
    return next == plan.passes.size() ? "" : "the batches do not hold all passes";
}

/// What is wrong with the plan's indices; empty when they can be trusted.
std::string index_mistake(const GraphDesc& graph, const Plan& plan) {
    if (plan.placements.size() != graph.resources.size() ||
        !is_run_of(plan.dependencies, plan.first_exit_barrier, plan.exit_barrier_count)) {
        return "the placements do not hold all resources, or the exits are no dependencies";
    }
    for (const Dependency& d : plan.dependencies) {
        if (d.resource >= graph.resources.size() || d.src_queue >= plan.topology.queues.size() ||
            d.dst_queue >= plan.topology.queues.size() || (d.producer != none && d.producer >= graph.passes.size()) ||
            (d.consumer != none && d.consumer >= graph.passes.size())) {
            return "a dependency points outside the resources, the passes or the queues";
        }
        const ResourceDesc& resource = graph.resources[d.resource];
        if (!inside(resource, region_of(resource, d.image_range, d.buffer_range))) {
            return "a dependency covers parts that its resource does not have";
        }
    }
    for (const Placement& placement : plan.placements) {
        if (placement.kind == PlacementKind::heap && placement.size_bytes == 0) {
            return "a placement has no bytes";
        }
    }
    if (std::any_of(plan.attachments.begin(), plan.attachments.end(),
                    [&](const AttachmentOps& ops) { return ops.access >= graph.accesses.size(); })) {
        return "an attachment is no access of the graph";
    }
    std::string mistake = pass_mistake(graph, plan);
    return mistake.empty() ? batch_mistake(plan) : mistake;
}

} // namespace

bool of_kept_form(const GraphDesc& graph, const Plan& plan, std::uint32_t pass) {
    const PassDesc& desc = graph.passes[pass];
    return desc.variant == none || plan.variants[desc.variant].form == desc.form;
}

std::vector<Violation> check_form(const GraphDesc& graph, const Plan& plan) {
    std::vector<Violation> found;
    if (std::string mistake = index_mistake(graph, plan); !mistake.empty()) {
        found.push_back({.code = ViolationCode::malformed, .message = std::move(mistake)});
        return found;
    }
    for (std::uint32_t r = 0; r < plan.placements.size(); ++r) {
        const Placement& p = plan.placements[r];
        const VkDeviceSize heap_bytes = p.heap < plan.heaps.size() ? plan.heaps[p.heap].size_bytes : 0;
        if (p.kind == PlacementKind::heap &&
            (p.offset_bytes > heap_bytes || p.size_bytes > heap_bytes - p.offset_bytes)) {
            found.push_back({.code = ViolationCode::memory_overlap,
                             .resource = r,
                             .message = "'" + graph.resources[r].name + "' lies outside its heap"});
        }
    }
    return found;
}

Region region_of(const ResourceDesc& resource, const ImageRange& image, const BufferRange& buffer) {
    if (resource.kind == ResourceKind::buffer) {
        const std::uint64_t end =
            buffer.size == whole_buffer ? resource.buffer.size_bytes : buffer.offset + buffer.size;
        return {buffer.offset, end, 0, 1};
    }
    const std::uint64_t end_mip =
        image.mip_count == all_remaining ? resource.image.mips : std::uint64_t{image.base_mip} + image.mip_count;
    const std::uint64_t end_layer = image.layer_count == all_remaining
                                        ? resource.image.layers
                                        : std::uint64_t{image.base_layer} + image.layer_count;
    return {image.base_mip, end_mip, image.base_layer, end_layer};
}

VkPipelineStageFlags2 stages_it_lacks(VkPipelineStageFlags2 stages, std::uint8_t capabilities) {
    constexpr VkPipelineStageFlags2 any_queue =
        all_commands | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT | VK_PIPELINE_STAGE_2_COPY_BIT |
        VK_PIPELINE_STAGE_2_HOST_BIT | VK_PIPELINE_STAGE_2_TOP_OF_PIPE_BIT | VK_PIPELINE_STAGE_2_BOTTOM_OF_PIPE_BIT;
    constexpr VkPipelineStageFlags2 compute =
        any_queue | VK_PIPELINE_STAGE_2_CLEAR_BIT | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT |
        VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR |
        VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR;
    constexpr VkPipelineStageFlags2 only_compute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT |
                                                   VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR |
                                                   VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR;
    const bool graphics = (capabilities & can_graphics) != 0;
    const bool computes = (capabilities & can_compute) != 0;
    const VkPipelineStageFlags2 offered = graphics   ? ~(computes ? VkPipelineStageFlags2{0} : only_compute)
                                          : computes ? compute
                                                     : any_queue;
    return stages & ~offered;
}

std::optional<Effect> effect_of(const Dependency& d, Recorded place, std::uint8_t capabilities) {
    const bool release_half = place == Recorded::at_batch_end && d.transfers_ownership && d.consumer != none;
    const bool changes_layout = d.old_layout != d.new_layout && !release_half;
    Effect effect{d.src_stages, d.dst_stages, d.src_access, d.dst_access, &d, changes_layout, d.transfers_ownership};
    if (d.src_queue != d.dst_queue && place == Recorded::before_consumer) {
        effect.src = d.local_stages;
        effect.src_access = d.local_access;
        if (changes_layout || d.transfers_ownership) {
            effect.src = all_commands; // chained to the semaphore wait
        } else if (effect.src == 0) {
            return std::nullopt;
        }
    }
    if (release_half) {
        effect.dst = 0;
        effect.dst_access = 0;
    }
    if (place == Recorded::at_exit && stages_it_lacks(effect.src, capabilities) != 0) {
        // Stages that ran on other queues were waited for by the last use; this queue names them as all commands.
        effect.src = all_commands;
        effect.src_access = VK_ACCESS_2_MEMORY_WRITE_BIT;
    }
    return effect;
}

} // namespace checker

std::string_view name_of(ViolationCode code) {
    switch (code) {
    case ViolationCode::malformed: return "malformed";
    case ViolationCode::race: return "race";
    case ViolationCode::not_visible: return "not visible";
    case ViolationCode::wrong_layout: return "wrong layout";
    case ViolationCode::undefined_content: return "undefined content";
    case ViolationCode::wrong_version: return "wrong version";
    case ViolationCode::ownership: return "ownership";
    case ViolationCode::queue_cannot: return "queue cannot";
    case ViolationCode::never_signalled: return "never signalled";
    case ViolationCode::memory_overlap: return "memory overlap";
    case ViolationCode::exit_state: return "exit state";
    }
    return "";
}

} // namespace tyndall::rg
