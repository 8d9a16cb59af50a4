#include "rendergraph/reasons.hpp"

#include <algorithm>
#include <optional>

#include "rendergraph/plan_text.hpp"

namespace tyndall::rg {
namespace {

constexpr std::size_t bits_of_word = 64;

std::string quoted(const std::string& name) {
    return "'" + name + "'";
}

bool share_bytes(const Placement& a, const Placement& b) {
    return a.kind == PlacementKind::heap && b.kind == PlacementKind::heap && a.heap == b.heap &&
           a.offset_bytes < b.offset_bytes + b.size_bytes && b.offset_bytes < a.offset_bytes + a.size_bytes;
}

/// A wait orders all up to the producer's batch on its queue before all from the consumer's batch on.
class Across {
public:
    Across(const GraphDesc& graph, const Plan& plan, const PlanOrder& order, std::uint32_t producer,
           std::uint32_t consumer)
        : graph_(graph), plan_(plan), order_(order), producer_(producer), consumer_(consumer) {}

    /// The first pair of uses of common bytes that the wait orders; nothing where there is none.
    [[nodiscard]] std::optional<std::string> reason() const {
        for (std::uint32_t to = 0; to < plan_.placements.size(); ++to) {
            for (std::uint32_t from = 0; from < plan_.placements.size(); ++from) {
                if (from != to && !share_bytes(plan_.placements[from], plan_.placements[to])) {
                    continue;
                }
                const std::uint32_t earlier = user(from, true);
                const std::uint32_t later = user(to, false);
                if (earlier == none || later == none) {
                    continue;
                }
                const std::string who = pass_name(later) + " comes after " + pass_name(earlier);
                return from == to ? who + ", which uses " + quoted(graph_.resources[to].name) + " too"
                                  : who + ": " + quoted(graph_.resources[to].name) + " takes over the memory of " +
                                        quoted(graph_.resources[from].name);
            }
        }
        return std::nullopt;
    }

private:
    [[nodiscard]] std::string pass_name(std::uint32_t place) const {
        return quoted(graph_.passes[plan_.passes[place].pass].name);
    }
    /// The last user up to the producer's batch, or the first from the consumer's on.
    [[nodiscard]] std::uint32_t user(std::uint32_t resource, bool earlier) const {
        const std::uint32_t end = earlier ? producer_ : consumer_;
        std::uint32_t found = none;
        for (const std::uint32_t place : order_.users(resource)) {
            const PlannedPass& pass = plan_.passes[place];
            const bool inside =
                pass.queue == plan_.batches[end].queue && (earlier ? pass.batch <= end : pass.batch >= end);
            if (inside && (earlier || found == none)) {
                found = place;
            }
        }
        return found;
    }

    const GraphDesc& graph_;
    const Plan& plan_;
    const PlanOrder& order_;
    std::uint32_t producer_;
    std::uint32_t consumer_;
};

std::string with_whom(const GraphDesc& graph, const Plan& plan, const PlanOrder& order, std::uint32_t resource) {
    std::string after;
    std::string until;
    for (const std::uint32_t other : order.sharers(plan, resource)) {
        std::string& list = order.resource_before(other, resource) ? after : until;
        list += (list.empty() ? "" : ", ") + quoted(graph.resources[other].name);
    }
    return "shares its bytes: every use of it comes" + (after.empty() ? "" : " after those of " + after) +
           (after.empty() || until.empty() ? "" : " and") + (until.empty() ? "" : " before those of " + until);
}

} // namespace

PlanOrder::PlanOrder(const GraphDesc& graph, const Plan& plan) : users_(graph.resources.size()) {
    const std::size_t count = plan.passes.size();
    predecessors_.assign(count, std::vector<std::uint64_t>((count + bits_of_word - 1) / bits_of_word, 0));
    std::vector<std::uint32_t> last_on_queue(plan.topology.queues.size(), none);
    const auto follow = [&](std::uint32_t place, std::uint32_t earlier) {
        for (std::size_t word = 0; word < predecessors_[place].size(); ++word) {
            predecessors_[place][word] |= predecessors_[earlier][word];
        }
        predecessors_[place][earlier / bits_of_word] |= std::uint64_t{1} << (earlier % bits_of_word);
    };
    for (std::uint32_t place = 0; place < count; ++place) {
        const PlannedPass& planned = plan.passes[place];
        const Batch& batch = plan.batches[planned.batch];
        if (last_on_queue[planned.queue] != none) {
            follow(place, last_on_queue[planned.queue]);
        }
        if (place == batch.first_pass) {
            for (const BatchWait& wait : batch.waits) {
                const Batch& producer = plan.batches[wait.batch];
                if (producer.pass_count > 0 && producer.first_pass + producer.pass_count <= place) {
                    follow(place, producer.first_pass + producer.pass_count - 1);
                }
            }
        }
        last_on_queue[planned.queue] = place;
        const PassDesc& pass = graph.passes[planned.pass];
        for (std::uint32_t i = pass.first_access; i < pass.first_access + pass.access_count; ++i) {
            std::vector<std::uint32_t>& users = users_[graph.accesses[i].resource];
            if (users.empty() || users.back() != place) {
                users.push_back(place);
            }
        }
    }
}

bool PlanOrder::before(std::uint32_t first, std::uint32_t second) const {
    return (predecessors_[second][first / bits_of_word] >> (first % bits_of_word) & 1U) != 0;
}

bool PlanOrder::resource_before(std::uint32_t first, std::uint32_t second) const {
    return std::all_of(users_[first].begin(), users_[first].end(), [&](std::uint32_t a) {
        return std::all_of(users_[second].begin(), users_[second].end(), [&](std::uint32_t b) { return before(a, b); });
    });
}

std::vector<std::uint32_t> PlanOrder::sharers(const Plan& plan, std::uint32_t resource) const {
    std::vector<std::uint32_t> out;
    for (std::uint32_t other = 0; other < plan.placements.size(); ++other) {
        if (other != resource && share_bytes(plan.placements[other], plan.placements[resource])) {
            out.push_back(other);
        }
    }
    std::stable_sort(out.begin(), out.end(), [&](std::uint32_t a, std::uint32_t b) {
        return !users_[a].empty() && !users_[b].empty() && users_[a].front() < users_[b].front();
    });
    return out;
}

std::string why_wait(const GraphDesc& graph, const Plan& plan, const PlanOrder& order, std::uint32_t batch,
                     const BatchWait& wait) {
    if (wait.first_dependency != none) {
        return describe(graph, plan.dependencies[wait.first_dependency]);
    }
    if (std::optional<std::string> uses = Across(graph, plan, order, wait.batch, batch).reason()) {
        return *std::move(uses);
    }
    return "later passes of this queue need what ran there before";
}

std::string why_memory(const GraphDesc& graph, const Plan& plan, const PlanOrder& order, std::uint32_t resource) {
    const Placement& placement = plan.placements[resource];
    switch (placement.reason) {
    case MemoryReason::not_created: return "not created";
    case MemoryReason::host_owns: return "the host owns it";
    case MemoryReason::outlives_frame:
        return "one of two copies that swap each frame, since its content outlives the frame";
    case MemoryReason::never_idle:
        return "alone: no other transient of its kind of memory is sure to be idle while it is in use";
    case MemoryReason::sharing_off: return "alone: sharing memory is switched off";
    case MemoryReason::takes_over:
    case MemoryReason::is_taken_over: return with_whom(graph, plan, order, resource);
    case MemoryReason::better_apart: break;
    }
    std::uint32_t candidate = 0;
    const auto could_share = [&](std::uint32_t other) {
        const Placement& its = plan.placements[other];
        return other != resource && its.kind == PlacementKind::heap && its.heap == placement.heap &&
               (order.resource_before(other, resource) || order.resource_before(resource, other));
    };
    while (candidate < plan.placements.size() && !could_share(candidate)) {
        ++candidate;
    }
    const std::string who = candidate < plan.placements.size() ? quoted(graph.resources[candidate].name) : "another";
    return "alone: " + who +
           (placement.could_share == 1 ? "" : " and " + std::to_string(placement.could_share - 1) + " more") +
           " could have its bytes at another time, but in the placement that was chosen have others";
}

std::string why_omitted(const CulledResource& resource) {
    return resource.reason == CullReason::never_used ? "no pass touches it" : "only passes that are left out touch it";
}

std::string why_form(const GraphDesc& graph, const Plan& plan, std::uint32_t variant) {
    const VariantDesc& desc = graph.variants[variant];
    const VariantDecision& decision = plan.variants[variant];
    std::string text = "form " + quoted(desc.forms[decision.form]) + " of " + quoted(desc.name) + " is kept: ";
    switch (decision.reason) {
    case VariantReason::shortest_frame: text += "with it the frame is shortest"; break;
    case VariantReason::kept_by_hysteresis: text += "as before, since no other gains more than the threshold"; break;
    case VariantReason::nothing_measured:
        text +=
            decision.form == 0 ? "no pass was measured, so it is the first" : "as before, since no pass was measured";
        break;
    }
    for (std::size_t form = 0; form < decision.predicted_ns.size(); ++form) {
        text += (form == 0 ? " (" : ", ") + desc.forms[form] + " " + milliseconds_text(decision.predicted_ns[form]);
    }
    return text + (decision.predicted_ns.empty() ? "" : ")");
}

} // namespace tyndall::rg
