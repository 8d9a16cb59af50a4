#include "tests/rendergraph/mutations.hpp"

#include <algorithm>

#include "tests/rendergraph/reach_oracle.hpp"

namespace tyndall::rg::test {
namespace {

class Breaker {
public:
    Breaker(const Plan& plan, Fault fault) : plan_(plan), fault_(fault) {}

    std::vector<Mutant> run() {
        switch (fault_) {
        case Fault::drop_barrier: dependencies([](Dependency& d) { return drop(d); }); break;
        case Fault::narrow_source_stages:
            bits([](Dependency& d) { return &d.src_stages; }, [](Dependency& d) { return &d.local_stages; });
            break;
        case Fault::narrow_destination_stages: bits([](Dependency& d) { return &d.dst_stages; }, nullptr); break;
        case Fault::narrow_source_access:
            bits([](Dependency& d) { return &d.src_access; }, [](Dependency& d) { return &d.local_access; });
            break;
        case Fault::narrow_destination_access: bits([](Dependency& d) { return &d.dst_access; }, nullptr); break;
        case Fault::drop_wait:
        case Fault::renumber_wait: waits(); break;
        case Fault::wrong_old_layout:
            dependencies([](Dependency& d) {
                const bool moves = d.old_layout != d.new_layout;
                d.old_layout = foreign_layout;
                return moves;
            });
            break;
        case Fault::wrong_new_layout:
            dependencies([](Dependency& d) {
                const bool moves = d.old_layout != d.new_layout;
                d.new_layout = foreign_layout;
                return moves;
            });
            break;
        case Fault::drop_release: releases(); break;
        case Fault::drop_acquire: acquires(); break;
        case Fault::overlap_bytes: overlaps(); break;
        case Fault::swap_passes: swaps(); break;
        case Fault::retarget_queue: retargets(); break;
        }
        return std::move(made_);
    }

private:
    Mutant& add(std::uint32_t dependency = none, std::uint32_t batch = none) {
        made_.push_back({fault_, static_cast<std::uint32_t>(made_.size()), dependency, batch, {none, none}, plan_});
        return made_.back();
    }

    static bool drop(Dependency& d) {
        d.src_stages = d.dst_stages = d.local_stages = 0;
        d.src_access = d.dst_access = d.local_access = 0;
        d.new_layout = d.old_layout;
        d.transfers_ownership = false;
        return true;
    }

    /// No access of the table asks for it, so no image is ever in it.
    static constexpr VkImageLayout foreign_layout = VK_IMAGE_LAYOUT_ATTACHMENT_OPTIMAL;

    template <typename F>
    void dependencies(F&& break_it) {
        for (std::uint32_t i = 0; i < plan_.dependencies.size(); ++i) {
            Dependency broken = plan_.dependencies[i];
            if (break_it(broken)) {
                add(i).plan.dependencies[i] = broken;
            }
        }
    }

    template <typename Mask, typename Local>
    void bits(Mask&& mask, Local&& local) {
        for (std::uint32_t i = 0; i < plan_.dependencies.size(); ++i) {
            Dependency whole = plan_.dependencies[i];
            for (auto left = *mask(whole); left != 0; left &= left - 1) {
                const auto bit = left & ~(left - 1);
                Dependency& d = add(i).plan.dependencies[i];
                *mask(d) &= ~bit;
                if constexpr (!std::is_same_v<std::decay_t<Local>, std::nullptr_t>) {
                    *local(d) &= ~bit;
                }
            }
        }
    }

    void waits() {
        for (std::uint32_t b = 0; b < plan_.batches.size(); ++b) {
            for (std::uint32_t w = 0; w < plan_.batches[b].waits.size(); ++w) {
                const auto at = [w](Plan& plan, std::uint32_t batch) { return plan.batches[batch].waits.begin() + w; };
                if (fault_ == Fault::drop_wait) {
                    Plan& broken = add(none, b).plan;
                    broken.batches[b].waits.erase(at(broken, b));
                    continue;
                }
                for (std::uint32_t other = 0; other < plan_.batches.size(); ++other) {
                    if (other != plan_.batches[b].waits[w].batch) {
                        at(add(none, b).plan, b)->batch = other;
                    }
                }
            }
        }
    }

    void releases() {
        for (std::uint32_t b = 0; b < plan_.batches.size(); ++b) {
            for (std::uint32_t i = 0; i < plan_.batches[b].releases.size(); ++i) {
                std::vector<std::uint32_t>& list = add(plan_.batches[b].releases[i], b).plan.batches[b].releases;
                list.erase(list.begin() + i);
            }
        }
    }

    /// The release half stays, as a record of its own.
    void acquires() {
        for (std::uint32_t b = 0; b < plan_.batches.size(); ++b) {
            for (std::uint32_t i = 0; i < plan_.batches[b].releases.size(); ++i) {
                const std::uint32_t d = plan_.batches[b].releases[i];
                if (!plan_.dependencies[d].transfers_ownership) {
                    continue;
                }
                Plan& broken = add(d, b).plan;
                broken.batches[b].releases[i] = static_cast<std::uint32_t>(broken.dependencies.size());
                broken.dependencies.push_back(plan_.dependencies[d]);
                broken.dependencies[d].transfers_ownership = false;
            }
        }
    }

    /// Lays a resource over another of its heap that it shared no bytes with.
    void overlaps() {
        for (std::uint32_t a = 0; a < plan_.placements.size(); ++a) {
            for (std::uint32_t b = 0; b < plan_.placements.size(); ++b) {
                const Placement& pa = plan_.placements[a];
                const Placement& pb = plan_.placements[b];
                const bool both =
                    pa.kind == PlacementKind::heap && pb.kind == PlacementKind::heap && pa.heap == pb.heap;
                const bool apart = pa.offset_bytes + pa.size_bytes <= pb.offset_bytes ||
                                   pb.offset_bytes + pb.size_bytes <= pa.offset_bytes;
                if (a != b && both && apart && pb.size_bytes <= pa.size_bytes) {
                    Mutant& mutant = add();
                    mutant.two = {a, b};
                    mutant.plan.placements[b].offset_bytes = pa.offset_bytes;
                }
            }
        }
    }

    /// Neighbours in one batch; each keeps its barriers.
    void swaps() {
        for (const Batch& batch : plan_.batches) {
            for (std::uint32_t i = batch.first_pass; i + 1 < batch.first_pass + batch.pass_count; ++i) {
                Mutant& mutant = add();
                mutant.two = {plan_.passes[i].pass, plan_.passes[i + 1].pass};
                std::swap(mutant.plan.passes[i], mutant.plan.passes[i + 1]);
                std::swap(mutant.plan.passes[i].slot, mutant.plan.passes[i + 1].slot);
            }
        }
    }

    void retargets() {
        for (std::uint32_t b = 0; b < plan_.batches.size(); ++b) {
            for (std::uint32_t queue = 0; queue < plan_.topology.queues.size(); ++queue) {
                if (queue == plan_.batches[b].queue) {
                    continue;
                }
                Plan& broken = add(none, b).plan;
                Batch& batch = broken.batches[b];
                batch.queue = queue;
                for (std::uint32_t i = batch.first_pass; i < batch.first_pass + batch.pass_count; ++i) {
                    broken.passes[i].queue = queue;
                }
            }
        }
    }

    const Plan& plan_;
    Fault fault_;
    std::vector<Mutant> made_;
};

/// Some other planned pass, or who comes after the frame, may use what the bytes of a write hold from a version on.
bool is_read_later(const GraphDesc& graph, const Plan& plan, const AccessDesc& write, std::uint32_t version) {
    const ResourceDesc& resource = graph.resources[write.resource];
    if (resource.lifetime != ResourceLifetime::transient || resource.has_history) {
        return true;
    }
    return std::any_of(graph.accesses.begin(), graph.accesses.end(), [&](const AccessDesc& a) {
        const bool planned = std::any_of(plan.passes.begin(), plan.passes.end(),
                                         [&](const PlannedPass& pass) { return pass.pass == a.pass; });
        return planned && a.resource == write.resource && is_read(a.direction) && a.pass != write.pass &&
               a.version >= version && have_common_bytes(graph, plan, a, write);
    });
}

/// Why two neighbours can change places, looking at what they touch alone.
std::optional<Harmless> why_swappable(const GraphDesc& graph, const Plan& plan, std::uint32_t a, std::uint32_t b) {
    const PassDesc& pa = graph.passes[a];
    const PassDesc& pb = graph.passes[b];
    Harmless reason = Harmless::unordered_passes;
    for (std::uint32_t i = pa.first_access; i < pa.first_access + pa.access_count; ++i) {
        for (std::uint32_t k = pb.first_access; k < pb.first_access + pb.access_count; ++k) {
            const AccessDesc& x = graph.accesses[i];
            const AccessDesc& y = graph.accesses[k];
            if (!have_common_bytes(graph, plan, x, y) || (!is_write(x.direction) && !is_write(y.direction))) {
                continue;
            }
            const bool both_replace = x.direction == Direction::replace && y.direction == Direction::replace;
            const bool same = x.resource == y.resource;
            const std::uint32_t first = std::min(x.version, y.version);
            if (!both_replace || is_read_later(graph, plan, x, same ? first : x.version) ||
                is_read_later(graph, plan, y, same ? first : y.version)) {
                return std::nullopt;
            }
            reason = Harmless::dead_content;
        }
    }
    return reason;
}

/// A semaphore does all of it: no command is recorded.
bool is_only_explanation(const Plan& plan, std::uint32_t dependency) {
    const Dependency& d = plan.dependencies[dependency];
    const bool released = std::any_of(plan.batches.begin(), plan.batches.end(), [&](const Batch& batch) {
        return std::find(batch.releases.begin(), batch.releases.end(), dependency) != batch.releases.end();
    });
    return d.src_queue != d.dst_queue && d.local_stages == 0 && d.old_layout == d.new_layout &&
           !d.transfers_ownership && !released;
}

/// Every queue's passes, and their resources, belong to a family that may have them.
bool families_fit(const GraphDesc& graph, const Plan& before, const Mutant& mutant) {
    const std::uint32_t from = before.batches[mutant.batch].queue;
    const std::uint32_t to = mutant.plan.batches[mutant.batch].queue;
    const QueueInfo& a = before.topology.queues[from];
    const QueueInfo& b = before.topology.queues[to];
    if ((b.capabilities & a.capabilities) == a.capabilities && a.family == b.family) {
        return true;
    }
    const Batch& batch = before.batches[mutant.batch];
    for (std::uint32_t i = batch.first_pass; i < batch.first_pass + batch.pass_count; ++i) {
        const PassDesc& pass = graph.passes[before.passes[i].pass];
        const int needs = pass.kind == PassKind::graphics   ? can_graphics
                          : pass.kind == PassKind::compute  ? can_compute
                          : pass.kind == PassKind::transfer ? can_transfer
                                                            : 0;
        if ((b.capabilities & needs) != needs) {
            return false;
        }
    }
    return true; // owners are followed by the checker alone; what it accepts is moved or discarded
}

} // namespace

std::vector<Mutant> mutants(const Plan& plan, Fault fault) {
    return Breaker(plan, fault).run();
}

std::optional<Harmless> why_harmless(const GraphDesc& graph, const Plan& plan, const Mutant& mutant) {
    const std::vector<Reliance> after = reliances(graph, mutant.plan);
    if (std::any_of(after.begin(), after.end(), [](const Reliance& r) { return r.means == Means::nothing; })) {
        return std::nullopt;
    }
    switch (mutant.fault) {
    case Fault::wrong_old_layout:
    case Fault::wrong_new_layout:
    case Fault::drop_release:
    case Fault::drop_acquire: return std::nullopt; // must always be seen
    case Fault::overlap_bytes: return Harmless::apart_in_time;
    case Fault::swap_passes: return why_swappable(graph, plan, mutant.two[0], mutant.two[1]);
    case Fault::retarget_queue:
        return families_fit(graph, plan, mutant) ? std::optional(Harmless::same_work_elsewhere) : std::nullopt;
    default: break;
    }
    if (mutant.dependency != none && is_only_explanation(plan, mutant.dependency)) {
        return Harmless::never_recorded;
    }
    // Who relied on what was broken, and what do they rely on now?
    const std::vector<Reliance> before = reliances(graph, plan);
    Harmless reason = Harmless::nothing_relied_on_it;
    for (const Reliance& r : before) {
        const bool used = mutant.dependency != none ? r.means == Means::barrier && r.by == mutant.dependency
                                                    : r.means == Means::wait && r.by == mutant.batch;
        if (!used) {
            continue;
        }
        const auto now = std::find_if(after.begin(), after.end(), [&](const Reliance& other) {
            return other.earlier == r.earlier && other.later == r.later && other.resource == r.resource;
        });
        if (now == after.end()) {
            continue; // another access comes between
        }
        const Harmless found = now->means == Means::wait            ? Harmless::a_wait_covers
                               : now->means == Means::other_barrier ? Harmless::a_chain_orders
                                                                    : Harmless::another_barrier_covers;
        reason = std::max(reason, found);
    }
    return reason;
}

std::string_view name_of(Fault fault) {
    constexpr std::array<std::string_view, fault_count> names = {
        "drop a barrier",       "narrow source stages",      "narrow destination stages",
        "narrow source access", "narrow destination access", "drop a wait",
        "renumber a wait",      "wrong old layout",          "wrong new layout",
        "drop a release",       "drop an acquire",           "overlap bytes",
        "swap two passes",      "retarget a queue"};
    return names[static_cast<std::size_t>(fault)];
}

std::string_view name_of(Harmless reason) {
    constexpr std::array<std::string_view, harmless_count> names = {
        "nothing recorded", "nothing relied on it", "a wait covers", "another barrier covers",    "a chain orders",
        "unordered passes", "dead content",         "apart in time", "same work on another queue"};
    return names[static_cast<std::size_t>(reason)];
}

} // namespace tyndall::rg::test
