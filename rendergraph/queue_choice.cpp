// What each pass may run on, before anything is predicted.
// In: kinds, accesses, wishes, the topology. Out: a set of queues for each pass, and its home. Invariant: a pass never
// leaves the graphics queue unless every one of its commands can run elsewhere. O(accesses x queues).
#include <algorithm>
#include <bit>

#include "rendergraph/assign.hpp"
#include "rendergraph/plan_text.hpp"

namespace tyndall::rg::stages {
namespace {

struct Choice {
    std::uint32_t queue = 0;
    QueueReason reason = QueueReason::default_graphics;
};

/// Where a pass runs that asks for a queue.
Choice asked_queue(const PassDesc& pass, const QueueTopology& topology, bool async) {
    if (pass.wish == QueueWish::graphics) {
        return {0, QueueReason::asked_for};
    }
    if (!async) {
        return {0, QueueReason::async_switched_off};
    }
    const QueueKind wanted = pass.wish == QueueWish::transfer ? QueueKind::transfer : QueueKind::compute;
    for (std::uint32_t q = 0; q < topology.queues.size(); ++q) {
        if (topology.queues[q].kind == wanted) {
            return {q, QueueReason::asked_for};
        }
    }
    return {0, QueueReason::asked_for_but_no_such_queue};
}

/// Only the first queue comes after the host's last use of the import, or before its next one.
bool ordered_by_queue(const GraphDesc& graph, const ResourceDesc& resource) {
    if (resource.import == none) {
        return false;
    }
    const auto on_device = [](VkPipelineStageFlags2 stages) { return (stages & ~VK_PIPELINE_STAGE_2_HOST_BIT) != 0; };
    const ImportDesc& import = graph.imports[resource.import];
    return (!import.waits_semaphore && on_device(import.initial_stages)) ||
           (import.has_final && !import.signals_semaphore && on_device(import.final_stages));
}

bool touches_import_ordered_by_queue(const GraphDesc& graph, const PassDesc& pass) {
    const auto begin = graph.accesses.begin() + pass.first_access;
    return std::any_of(begin, begin + pass.access_count, [&](const AccessDesc& access) {
        return ordered_by_queue(graph, graph.resources[access.resource]);
    });
}

/// An import is EXCLUSIVE unless the host says that it shares it. Its passes then stay in one family: those that asked
/// for another queue go back to graphics if the import is used elsewhere too. Returns whether anything moved.
bool keep_unshared_imports_together(const GraphDesc& graph, const QueueTopology& topology, const Kept& kept,
                                    QueueChoices& choices) {
    const auto family = [&](std::uint32_t pass) { return topology.queues[choices.home[pass]].family; };
    Scratch<std::uint32_t> family_of(graph.resources.size(), none);
    Scratch<bool> torn(graph.resources.size(), false);
    for (const AccessDesc& access : graph.accesses) {
        const ResourceDesc& resource = graph.resources[access.resource];
        if (kept.pass[access.pass] && resource.import != none && !resource.concurrent) {
            std::uint32_t& known = family_of[access.resource];
            torn[access.resource] = torn[access.resource] || (known != none && known != family(access.pass));
            known = family(access.pass);
        }
    }
    bool moved = false;
    for (const AccessDesc& access : graph.accesses) {
        if (torn[access.resource] && choices.home[access.pass] != 0) {
            choices.home[access.pass] = 0;
            choices.reason[access.pass] = QueueReason::import_not_shared;
            moved = true;
        }
    }
    return moved;
}

/// Passes that are left no queue but one that they forbid.
Diagnostics broken_bans(const GraphDesc& graph, const QueueTopology& topology, const Kept& kept,
                        const QueueChoices& choices) {
    Diagnostics errors;
    for (std::uint32_t pass = 0; pass < graph.passes.size(); ++pass) {
        const PassDesc& desc = graph.passes[pass];
        const QueueKind kind = topology.queues[choices.home[pass]].kind;
        if (!kept.pass[pass] || desc.kind == PassKind::host || (desc.forbidden_queues & queue_bit(kind)) == 0) {
            continue;
        }
        const bool asked = choices.reason[pass] == QueueReason::asked_for;
        const bool by_import = choices.reason[pass] == QueueReason::import_ordered_by_queue ||
                               choices.reason[pass] == QueueReason::import_not_shared;
        std::string what = " is left no queue but one of the kind that it forbids, " + std::string(name_of(kind)) +
                           "; allow it, or plan for a queue that can run the pass";
        if (asked) {
            what = " asks for a queue of the kind that it forbids, " + std::string(name_of(kind)) + "; choose one";
        } else if (by_import) {
            what += ", since " + why_queue({.queue_reason = choices.reason[pass]});
        }
        errors.push_back({.code = DiagnosticCode::queue_cannot,
                          .pass = desc.name,
                          .message = "Pass '" + desc.name + "'" + what,
                          .where = desc.where,
                          .other_where = desc.where});
    }
    return errors;
}

/// The queues where every command of a pass can run, and what kept it from others.
class FreeChoice {
public:
    FreeChoice(const GraphDesc& graph, const QueueTopology& topology)
        : graph_(graph), topology_(topology),
          count_(std::min(static_cast<std::uint32_t>(topology.queues.size()), most_queues)) {}

    QueueMask operator()(const PassDesc& pass, QueueReason& reason) const {
        if (pass.kind != PassKind::compute && pass.kind != PassKind::transfer) {
            return 1;
        }
        const QueueMask capable = capable_queues(pass);
        if (capable == 1) {
            reason = QueueReason::only_queue_that_can;
            return capable;
        }
        if (touches_import_ordered_by_queue(graph_, pass)) {
            reason = QueueReason::import_ordered_by_queue;
            return 1;
        }
        const QueueMask shared = capable & queues_of_imports(pass);
        if (shared == 1) {
            reason = QueueReason::import_not_shared;
            return shared;
        }
        QueueMask open = shared;
        for (std::uint32_t q = 0; q < count_; ++q) {
            if ((pass.forbidden_queues & queue_bit(topology_.queues[q].kind)) != 0) {
                open &= ~(QueueMask{1} << q);
            }
        }
        if (open == 0) {
            return 1; // which is forbidden too
        }
        const bool home_forbidden = (open & 1U) == 0;
        if (home_forbidden || open == 1) {
            reason = QueueReason::forbidden;
        }
        return open;
    }

private:
    [[nodiscard]] QueueMask capable_queues(const PassDesc& pass) const {
        const std::uint8_t kind_needs = pass.kind == PassKind::compute ? can_compute : can_transfer;
        QueueMask capable = 1;
        for (std::uint32_t q = 1; q < count_; ++q) {
            const std::uint8_t can = topology_.queues[q].capabilities;
            bool all = (can & kind_needs) != 0;
            for (std::uint32_t i = pass.first_access; i < pass.first_access + pass.access_count && all; ++i) {
                const AccessDesc& access = graph_.accesses[i];
                all = (access_info(access.access).needs & can) != 0 && (can_be_anything(access) || can_graphics_on(q));
            }
            capable |= all ? QueueMask{1} << q : 0;
        }
        return capable;
    }
    /// Image copies may be blits or resolves, which want a queue that draws; only the pass itself knows.
    [[nodiscard]] bool can_be_anything(const AccessDesc& access) const {
        const bool copies = access.access == Access::transfer_source || access.access == Access::transfer_destination;
        return !copies || graph_.resources[access.resource].kind == ResourceKind::buffer;
    }
    [[nodiscard]] bool can_graphics_on(std::uint32_t q) const {
        return (topology_.queues[q].capabilities & can_graphics) != 0;
    }
    /// An import that the host does not share stays in the family of the graphics queue: what the scheduler decides may
    /// differ from frame to frame, and nobody would hand over the ownership.
    [[nodiscard]] QueueMask queues_of_imports(const PassDesc& pass) const {
        for (std::uint32_t i = pass.first_access; i < pass.first_access + pass.access_count; ++i) {
            const ResourceDesc& resource = graph_.resources[graph_.accesses[i].resource];
            if (resource.import != none && !resource.concurrent) {
                QueueMask same_family = 0;
                for (std::uint32_t q = 0; q < count_; ++q) {
                    same_family |= topology_.queues[q].family == topology_.queues[0].family ? QueueMask{1} << q : 0;
                }
                return same_family;
            }
        }
        return ~QueueMask{0};
    }

    const GraphDesc& graph_;
    const QueueTopology& topology_;
    std::uint32_t count_;
};

} // namespace

QueueChoices choose_queues(const GraphDesc& graph, const QueueTopology& topology, const Kept& kept, bool async) {
    const auto count = static_cast<std::uint32_t>(graph.passes.size());
    const bool several = async && topology.queues.size() > 1;
    const FreeChoice free_choice(graph, topology);
    QueueChoices choices;
    choices.allowed.assign(count, 1);
    choices.home.assign(count, 0);
    choices.reason.assign(count, QueueReason::default_graphics);
    bool any_asked_away = false;
    for (std::uint32_t pass = 0; pass < count; ++pass) {
        const PassDesc& desc = graph.passes[pass];
        if (desc.kind == PassKind::graphics) {
            choices.reason[pass] = QueueReason::only_queue_that_can;
        } else if (desc.wish != QueueWish::automatic) {
            Choice asked = asked_queue(desc, topology, async);
            if (asked.queue != 0 && touches_import_ordered_by_queue(graph, desc)) {
                asked = {0, QueueReason::import_ordered_by_queue};
            }
            choices.home[pass] = asked.queue;
            choices.reason[pass] = asked.reason;
            any_asked_away = any_asked_away || asked.queue != 0;
        } else if (!async && (desc.forbidden_queues & queue_bit(topology.queues[0].kind)) != 0) {
            choices.reason[pass] = QueueReason::async_switched_off;
        } else if (several && kept.pass[pass]) {
            choices.allowed[pass] = free_choice(desc, choices.reason[pass]);
            choices.home[pass] = static_cast<std::uint32_t>(std::countr_zero(choices.allowed[pass]));
        }
    }
    // Moving a pass may tear another import that it shares with a pass still elsewhere: again, until nothing moves.
    // Each round moves at least one pass to graphics, so it ends.
    while (any_asked_away && keep_unshared_imports_together(graph, topology, kept, choices)) {
    }
    for (std::uint32_t pass = 0; pass < count; ++pass) {
        if (is_one_queue(choices.allowed[pass])) {
            choices.allowed[pass] = QueueMask{1} << choices.home[pass];
        }
        choices.any_free = choices.any_free || !is_one_queue(choices.allowed[pass]);
        choices.any_away = choices.any_away || (kept.pass[pass] && choices.home[pass] != 0);
    }
    if (async) { // switched off, all runs on the first queue, whatever was asked for or forbidden
        choices.errors = broken_bans(graph, topology, kept, choices);
    }
    return choices;
}

} // namespace tyndall::rg::stages
