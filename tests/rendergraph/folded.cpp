#include "tests/rendergraph/folded.hpp"

namespace tyndall::rg::test {

FoldedFrame folded(const GraphDesc& graph, const Plan& plan) {
    constexpr VkPipelineStageFlags2 everything = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    constexpr VkAccessFlags2 any_access = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    const bool several = plan.topology.queues.size() > 1;
    FoldedFrame out{graph, plan};
    for (ImportDesc& import : out.graph.imports) {
        import.initial_family = import.final_family = VK_QUEUE_FAMILY_IGNORED;
    }
    QueueInfo queue = plan.topology.queues.front();
    queue.capabilities = can_graphics | can_compute | can_transfer;
    out.plan.topology.queues = {queue};
    for (Batch& batch : out.plan.batches) {
        batch.queue = 0;
        batch.waits.clear();
        batch.signals = false;
        std::erase_if(batch.releases, [&](std::uint32_t d) {
            return plan.dependencies[d].transfers_ownership &&
                   plan.dependencies[d].src_queue != plan.dependencies[d].dst_queue;
        });
    }
    for (std::uint32_t i = 0; i < out.plan.passes.size(); ++i) {
        out.plan.passes[i].queue = 0;
        out.plan.passes[i].slot = i;
    }
    for (Placement& placement : out.plan.placements) {
        placement.concurrent = false;
        placement.families.assign(placement.families.empty() ? 0 : 1, queue.family);
    }
    for (Dependency& d : out.plan.dependencies) {
        d.src_queue = d.dst_queue = 0;
        d.local_stages = d.src_stages;
        d.local_access = d.src_access;
        d.transfers_ownership = false;
        d.src_family = d.dst_family = VK_QUEUE_FAMILY_IGNORED;
        if (d.producer == none && several) {
            d.dst_stages |= everything;
            d.dst_access |= any_access;
        }
        if (d.hazard == Hazard::history_rest) {
            d.dst_stages = everything;
        }
    }
    return out;
}

} // namespace tyndall::rg::test
