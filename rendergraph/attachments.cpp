// Load and store operations of attachments.
// In: uses in schedule order. Out: operations by slot. Invariant: content that a later use, the host or the next frame
// reads is stored; nothing else is. O(uses x cells of each).
#include <algorithm>

#include "rendergraph/stages.hpp"

namespace tyndall::rg::stages {
namespace {

bool is_attachment(Access access) {
    return access == Access::color_attachment || access == Access::depth_attachment ||
           access == Access::resolve_attachment;
}

/// By use: some cell that it writes is read later.
Scratch<bool> needed_later(const GraphDesc& graph, const Cells& cells, const Schedule& schedule) {
    Scratch<bool> needed(schedule.uses.size(), false);
    Scratch<bool> read_next; // by cell: the next use reads
    for (std::uint32_t resource = 0; resource < graph.resources.size(); ++resource) {
        const ResourceDesc& desc = graph.resources[resource];
        const bool leaves_frame = desc.has_history || desc.lifetime == ResourceLifetime::imported;
        read_next.assign(cells.of_resource[resource].count(), leaves_frame);
        for (std::uint32_t i = schedule.first_use[resource + 1]; i-- > schedule.first_use[resource];) {
            const Use& use = schedule.uses[i];
            for_each_cell(cells.of_resource[resource], use.cells, [&](std::uint32_t cell) {
                needed[i] = needed[i] || (use.writes && read_next[cell]);
                read_next[cell] = use.reads || (read_next[cell] && !use.writes);
            });
        }
    }
    return needed;
}

} // namespace

Attachments choose_attachment_operations(const GraphDesc& graph, const Cells& cells, const Schedule& schedule) {
    const bool any = std::any_of(graph.accesses.begin(), graph.accesses.end(),
                                 [](const AccessDesc& access) { return is_attachment(access.access); });
    const Scratch<bool> needed = any ? needed_later(graph, cells, schedule) : Scratch<bool>{};
    const auto stored = [&](const AccessDesc& access) {
        bool read_later = false;
        for (std::uint32_t i = schedule.first_use[access.resource]; i < schedule.first_use[access.resource + 1]; ++i) {
            read_later = read_later || (schedule.uses[i].pass == access.pass && needed[i]);
        }
        return read_later;
    };
    Attachments out;
    out.first_of_slot.reserve(schedule.order.size() + 1);
    out.first_of_slot.assign(1, 0);
    for (const std::uint32_t pass_index : schedule.order) {
        const PassDesc& pass = graph.passes[pass_index];
        for (std::uint32_t i = pass.first_access; i < pass.first_access + pass.access_count; ++i) {
            const AccessDesc& access = graph.accesses[i];
            if (!is_attachment(access.access)) {
                continue;
            }
            AttachmentOps ops{i};
            ops.load = access.clears               ? VK_ATTACHMENT_LOAD_OP_CLEAR
                       : is_read(access.direction) ? VK_ATTACHMENT_LOAD_OP_LOAD
                                                   : VK_ATTACHMENT_LOAD_OP_DONT_CARE;
            ops.store = !is_write(access.direction) ? VK_ATTACHMENT_STORE_OP_NONE
                        : stored(access)            ? VK_ATTACHMENT_STORE_OP_STORE
                                                    : VK_ATTACHMENT_STORE_OP_DONT_CARE;
            out.operations.push_back(ops);
        }
        out.first_of_slot.push_back(static_cast<std::uint32_t>(out.operations.size()));
    }
    return out;
}

} // namespace tyndall::rg::stages
