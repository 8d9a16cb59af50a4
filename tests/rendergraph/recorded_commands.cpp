#include "tests/rendergraph/recorded_commands.hpp"

#include <algorithm>

namespace tyndall::rg::test {

VkPipelineStageFlags2 expanded(VkPipelineStageFlags2 mask) {
    return (mask & all_commands) != 0 ? mask | ~VkPipelineStageFlags2{VK_PIPELINE_STAGE_2_HOST_BIT} : mask;
}
bool includes(VkAccessFlags2 mask, VkAccessFlags2 wanted) {
    const VkAccessFlags2 reads = (mask & VK_ACCESS_2_MEMORY_READ_BIT) != 0 ? ~writes_of_memory : 0;
    const VkAccessFlags2 writes = (mask & VK_ACCESS_2_MEMORY_WRITE_BIT) != 0 ? writes_of_memory : 0;
    return (wanted & ~(mask | reads | writes)) == 0;
}

Part part_of(const ResourceDesc& r, const ImageRange& image, const BufferRange& buffer) {
    if (r.kind == ResourceKind::buffer) {
        return {buffer.offset, buffer.size == whole_buffer ? r.buffer.size_bytes : buffer.offset + buffer.size, 0, 1};
    }
    const auto end = [](std::uint32_t base, std::uint32_t count, std::uint32_t all) {
        return count == all_remaining ? std::uint64_t{all} : std::uint64_t{base} + count;
    };
    return {image.base_mip, end(image.base_mip, image.mip_count, r.image.mips), image.base_layer,
            end(image.base_layer, image.layer_count, r.image.layers)};
}

std::vector<Part> pieces_of(const GraphDesc& graph, std::uint32_t resource, const Part& part) {
    std::vector<std::uint64_t> as{part.a0, part.a1};
    std::vector<std::uint64_t> bs{part.b0, part.b1};
    for (const AccessDesc& access : graph.accesses) {
        if (access.resource == resource) {
            const Part p = part_of(graph.resources[resource], access.image_range, access.buffer_range);
            as.insert(as.end(), {p.a0, p.a1});
            bs.insert(bs.end(), {p.b0, p.b1});
        }
    }
    for (auto* cuts : {&as, &bs}) {
        std::sort(cuts->begin(), cuts->end());
        cuts->erase(std::unique(cuts->begin(), cuts->end()), cuts->end());
    }
    std::vector<Part> pieces;
    for (std::size_t a = 0; a + 1 < as.size(); ++a) {
        for (std::size_t b = 0; b + 1 < bs.size(); ++b) {
            const Part piece{as[a], as[a + 1], bs[b], bs[b + 1]};
            if (part.holds(piece)) {
                pieces.push_back(piece);
            }
        }
    }
    return pieces;
}

bool share_bytes(const Plan& plan, std::uint32_t a, std::uint32_t b) {
    const Placement& x = plan.placements[a];
    const Placement& y = plan.placements[b];
    return a != b && x.kind == PlacementKind::heap && y.kind == PlacementKind::heap && x.heap == y.heap &&
           x.offset_bytes < y.offset_bytes + y.size_bytes && y.offset_bytes < x.offset_bytes + x.size_bytes;
}

namespace {

/// What a queue without these abilities cannot name; it says all commands for what other queues did.
bool has_stages(std::uint8_t capabilities, VkPipelineStageFlags2 stages) {
    constexpr VkPipelineStageFlags2 drawing =
        VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT | VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT |
        VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT |
        VK_PIPELINE_STAGE_2_PRE_RASTERIZATION_SHADERS_BIT | VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT |
        VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT |
        VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT | VK_PIPELINE_STAGE_2_ALL_GRAPHICS_BIT |
        VK_PIPELINE_STAGE_2_RESOLVE_BIT | VK_PIPELINE_STAGE_2_BLIT_BIT;
    constexpr VkPipelineStageFlags2 computing =
        VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_2_CLEAR_BIT |
        VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR | VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR;
    const bool draws = (capabilities & can_graphics) != 0;
    const bool computes = draws || (capabilities & can_compute) != 0;
    return (draws || (stages & drawing) == 0) && (computes || (stages & computing) == 0);
}

class Lister {
public:
    Lister(const GraphDesc& graph, const Plan& plan) : graph_(graph), plan_(plan) {}

    std::vector<Command> run() {
        for (std::uint32_t b = 0; b < plan_.batches.size(); ++b) {
            const Batch& batch = plan_.batches[b];
            for (const BatchWait& wait : batch.waits) {
                commands_.push_back({CommandKind::wait, batch.queue, b, wait.batch, expanded(wait.stages)});
            }
            for (std::uint32_t i = batch.first_pass; i < batch.first_pass + batch.pass_count; ++i) {
                const PlannedPass& planned = plan_.passes[i];
                Command before{CommandKind::barriers, batch.queue, b};
                for (std::uint32_t d = planned.first_barrier; d < planned.first_barrier + planned.barrier_count; ++d) {
                    add_before(before, d);
                }
                commands_.push_back(std::move(before));
                Command touches{CommandKind::touches, batch.queue, b};
                const PassDesc& pass = graph_.passes[planned.pass];
                for (std::uint32_t k = pass.first_access; k < pass.first_access + pass.access_count; ++k) {
                    touches.touches.push_back(touch_of(k));
                }
                commands_.push_back(std::move(touches));
            }
            Command after{CommandKind::barriers, batch.queue, b};
            for (const std::uint32_t d : batch.releases) {
                const Dependency& r = plan_.dependencies[d];
                const bool half = r.transfers_ownership && r.consumer != none;
                after.barriers.push_back({d, r.src_stages, half ? 0 : r.dst_stages, r.src_access,
                                          half ? 0 : r.dst_access, half || r.old_layout != r.new_layout});
            }
            for (const std::uint32_t d : exits_of(b)) {
                const Dependency& r = plan_.dependencies[d];
                const bool named = has_stages(plan_.topology.queues[batch.queue].capabilities, r.src_stages);
                after.barriers.push_back({d, named ? r.src_stages : all_commands, r.dst_stages,
                                          named ? r.src_access : VK_ACCESS_2_MEMORY_WRITE_BIT, r.dst_access,
                                          r.transfers_ownership || r.old_layout != r.new_layout});
            }
            commands_.push_back(std::move(after));
            if (batch.signals) {
                commands_.push_back({CommandKind::signal, batch.queue, b});
            }
        }
        return std::move(commands_);
    }

private:
    /// The host's final state is set in the batch of the last use.
    std::vector<std::uint32_t> exits_of(std::uint32_t batch) const {
        std::vector<std::uint32_t> out;
        for (std::uint32_t d = plan_.first_exit_barrier; d < plan_.first_exit_barrier + plan_.exit_barrier_count; ++d) {
            const Batch& b = plan_.batches[batch];
            const auto first = plan_.passes.begin() + b.first_pass;
            const bool here = std::any_of(first, first + b.pass_count, [&](const PlannedPass& planned) {
                return planned.pass == plan_.dependencies[d].producer;
            });
            if (here) {
                out.push_back(d);
            }
        }
        return out;
    }

    void add_before(Command& command, std::uint32_t index) const {
        const Dependency& d = plan_.dependencies[index];
        const bool across = d.src_queue != d.dst_queue;
        Recorded r{index,        d.src_stages, d.dst_stages,
                   d.src_access, d.dst_access, d.transfers_ownership || d.old_layout != d.new_layout};
        if (across) {
            r.src = r.acts ? all_commands : d.local_stages; // chained to the wait
            r.src_access = d.local_access;
        }
        if (r.src != 0 || !across) {
            command.barriers.push_back(r);
        }
    }

    Touch touch_of(std::uint32_t index) const {
        const AccessDesc& a = graph_.accesses[index];
        const ResourceDesc& r = graph_.resources[a.resource];
        const AccessScope scope =
            access_scope(a.access, a.direction, r.kind == ResourceKind::image ? r.image.format : VK_FORMAT_UNDEFINED);
        return {a.pass,       a.resource,   part_of(r, a.image_range, a.buffer_range),
                scope.stages, scope.access, is_write(a.direction),
                none,         index};
    }

    const GraphDesc& graph_;
    const Plan& plan_;
    std::vector<Command> commands_;
};

} // namespace

Touch transition_of(const GraphDesc& graph, const Plan& plan, const Recorded& recorded) {
    const Dependency& d = plan.dependencies[recorded.dependency];
    const ResourceDesc& r = graph.resources[d.resource];
    return {d.consumer != none ? d.consumer : d.producer,
            d.resource,
            part_of(r, d.image_range, d.buffer_range),
            recorded.dst,
            recorded.dst_access,
            true,
            recorded.dependency};
}

std::vector<Command> recorded_commands(const GraphDesc& graph, const Plan& plan) {
    return Lister(graph, plan).run();
}

} // namespace tyndall::rg::test
