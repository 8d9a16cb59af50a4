#include "tests/rendergraph/reach_oracle.hpp"

#include <algorithm>

namespace tyndall::rg::test {
namespace {

constexpr VkPipelineStageFlags2 all_commands = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
constexpr VkPipelineStageFlags2 host = VK_PIPELINE_STAGE_2_HOST_BIT;
constexpr VkAccessFlags2 any_memory = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
constexpr VkAccessFlags2 writes_of_memory =
    VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT |
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT | VK_ACCESS_2_HOST_WRITE_BIT |
    VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR | VK_ACCESS_2_SHADER_WRITE_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;

VkPipelineStageFlags2 expanded(VkPipelineStageFlags2 mask) {
    return (mask & all_commands) != 0 ? mask | ~host : mask;
}
bool includes(VkAccessFlags2 mask, VkAccessFlags2 wanted) {
    const VkAccessFlags2 reads = (mask & VK_ACCESS_2_MEMORY_READ_BIT) != 0 ? ~writes_of_memory : 0;
    const VkAccessFlags2 writes = (mask & VK_ACCESS_2_MEMORY_WRITE_BIT) != 0 ? writes_of_memory : 0;
    return (wanted & ~(mask | reads | writes)) == 0;
}

/// Bytes, or mips x layers, of a resource.
struct Part {
    std::uint64_t a0, a1, b0, b1;
    [[nodiscard]] bool meets(const Part& o) const { return a0 < o.a1 && o.a0 < a1 && b0 < o.b1 && o.b0 < b1; }
    [[nodiscard]] bool holds(const Part& o) const { return a0 <= o.a0 && o.a1 <= a1 && b0 <= o.b0 && o.b1 <= b1; }
};
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

bool share_bytes(const Plan& plan, std::uint32_t a, std::uint32_t b) {
    const Placement& x = plan.placements[a];
    const Placement& y = plan.placements[b];
    return a != b && x.kind == PlacementKind::heap && y.kind == PlacementKind::heap && x.heap == y.heap &&
           x.offset_bytes < y.offset_bytes + y.size_bytes && y.offset_bytes < x.offset_bytes + x.size_bytes;
}

/// Something that touches memory.
struct Touch {
    std::uint32_t pass = none;
    std::uint32_t resource = none;
    Part part{};
    VkPipelineStageFlags2 stages = 0; ///< for transitions: what comes after them
    VkAccessFlags2 access = 0;
    bool writes = false;
    std::uint32_t transition = none; ///< the dependency that makes it
};
struct Recorded {
    std::uint32_t dependency = none;
    VkPipelineStageFlags2 src = 0, dst = 0;
    VkAccessFlags2 src_access = 0, dst_access = 0;
    bool acts = false; ///< changes layout or owner
};
enum class Kind : std::uint8_t { wait, barriers, touches, signal };
struct Command {
    Kind kind;
    std::uint32_t queue;
    std::uint32_t batch;
    std::uint32_t signaller = none;   ///< of a wait
    VkPipelineStageFlags2 stages = 0; ///< of a wait
    std::vector<Recorded> barriers = {};
    std::vector<Touch> touches = {};
};

class Oracle {
public:
    Oracle(const GraphDesc& graph, const Plan& plan) : graph_(graph), plan_(plan) { list_commands(); }

    std::vector<Reliance> run() {
        for (std::uint32_t r = 0; r < graph_.resources.size(); ++r) {
            const std::uint32_t import = graph_.resources[r].import;
            if (import != none && graph_.imports[import].initial_stages != 0) {
                const ImportDesc& desc = graph_.imports[import];
                const Touch touch{none,
                                  r,
                                  part_of(graph_.resources[r], {}, {}),
                                  desc.initial_stages,
                                  desc.initial_access,
                                  (desc.initial_access & writes_of_memory) != 0,
                                  none};
                follow_parts(touch, 0, none);
            }
        }
        for (std::size_t c = 0; c < commands_.size(); ++c) {
            for (const Touch& touch : commands_[c].touches) {
                follow_parts(touch, c + 1, commands_[c].queue);
            }
            for (const Recorded& recorded : commands_[c].barriers) {
                if (recorded.acts) {
                    follow_parts(transition_of(recorded), c + 1, commands_[c].queue);
                }
            }
        }
        return std::move(found_);
    }

private:
    void list_commands() {
        for (std::uint32_t b = 0; b < plan_.batches.size(); ++b) {
            const Batch& batch = plan_.batches[b];
            for (const BatchWait& wait : batch.waits) {
                commands_.push_back({Kind::wait, batch.queue, b, wait.batch, expanded(wait.stages)});
            }
            for (std::uint32_t i = batch.first_pass; i < batch.first_pass + batch.pass_count; ++i) {
                const PlannedPass& planned = plan_.passes[i];
                Command before{Kind::barriers, batch.queue, b};
                for (std::uint32_t d = planned.first_barrier; d < planned.first_barrier + planned.barrier_count; ++d) {
                    add_before(before, d);
                }
                commands_.push_back(std::move(before));
                Command touches{Kind::touches, batch.queue, b};
                const PassDesc& pass = graph_.passes[planned.pass];
                for (std::uint32_t k = pass.first_access; k < pass.first_access + pass.access_count; ++k) {
                    touches.touches.push_back(touch_of(graph_.accesses[k]));
                }
                commands_.push_back(std::move(touches));
            }
            Command after{Kind::barriers, batch.queue, b};
            for (const std::uint32_t d : batch.releases) {
                const Dependency& r = plan_.dependencies[d];
                const bool half = r.transfers_ownership && r.consumer != none;
                after.barriers.push_back({d, r.src_stages, half ? 0 : r.dst_stages, r.src_access,
                                          half ? 0 : r.dst_access, half || r.old_layout != r.new_layout});
            }
            commands_.push_back(std::move(after));
            if (batch.signals) {
                commands_.push_back({Kind::signal, batch.queue, b});
            }
        }
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

    Touch touch_of(const AccessDesc& a) const {
        const ResourceDesc& r = graph_.resources[a.resource];
        const AccessScope scope =
            access_scope(a.access, a.direction, r.kind == ResourceKind::image ? r.image.format : VK_FORMAT_UNDEFINED);
        return {a.pass,       a.resource,   part_of(r, a.image_range, a.buffer_range),
                scope.stages, scope.access, is_write(a.direction),
                none};
    }
    Touch transition_of(const Recorded& recorded) const {
        const Dependency& d = plan_.dependencies[recorded.dependency];
        const ResourceDesc& r = graph_.resources[d.resource];
        return {d.consumer != none ? d.consumer : d.producer,
                d.resource,
                part_of(r, d.image_range, d.buffer_range),
                recorded.dst,
                recorded.dst_access,
                true,
                recorded.dependency};
    }

    /// The parts of a touch that later touches and barriers tell apart.
    void follow_parts(const Touch& touch, std::size_t first, std::uint32_t queue) {
        std::vector<std::uint64_t> as{touch.part.a0, touch.part.a1};
        std::vector<std::uint64_t> bs{touch.part.b0, touch.part.b1};
        for (const AccessDesc& access : graph_.accesses) {
            if (access.resource == touch.resource) {
                const Part p = part_of(graph_.resources[touch.resource], access.image_range, access.buffer_range);
                as.insert(as.end(), {p.a0, p.a1});
                bs.insert(bs.end(), {p.b0, p.b1});
            }
        }
        for (auto* cuts : {&as, &bs}) {
            std::sort(cuts->begin(), cuts->end());
            cuts->erase(std::unique(cuts->begin(), cuts->end()), cuts->end());
        }
        for (std::size_t a = 0; a + 1 < as.size(); ++a) {
            for (std::size_t b = 0; b + 1 < bs.size(); ++b) {
                Touch part = touch;
                part.part = {as[a], as[a + 1], bs[b], bs[b + 1]};
                if (touch.part.holds(part.part)) {
                    follow(part, first, queue);
                }
            }
        }
    }

    /// How far it is known to have got, on one queue.
    struct Reached {
        VkPipelineStageFlags2 ordered = 0;
        VkPipelineStageFlags2 available = 0;
    };
    struct Sight {
        std::uint32_t queue;
        VkPipelineStageFlags2 stages;
        VkAccessFlags2 access;
        Means means;
        std::uint32_t by;
    };
    /// One stage of the touch at hand.
    struct Track {
        VkPipelineStageFlags2 stage = 0;
        std::vector<Reached> reached;
        std::vector<Sight> sights;
        std::vector<std::uint8_t> signalled; ///< by batch
    };

    void follow(const Touch& touch, std::size_t first, std::uint32_t queue) {
        std::vector<Track> tracks;
        const auto add = [&](VkPipelineStageFlags2 stage) {
            tracks.push_back({stage,
                              std::vector<Reached>(plan_.topology.queues.size()),
                              {},
                              std::vector<std::uint8_t>(plan_.batches.size(), 0)});
        };
        if (touch.transition != none) {
            add(0);
            const VkPipelineStageFlags2 after = expanded(touch.stages);
            tracks[0].reached[queue] = {after, after};
            tracks[0].sights.push_back({queue, after, touch.access, Means::barrier, touch.transition});
        } else {
            for (VkPipelineStageFlags2 left = touch.stages; left != 0; left &= left - 1) {
                add(left & ~(left - 1));
            }
        }
        for (std::size_t c = first; c < commands_.size(); ++c) {
            const Command& command = commands_[c];
            switch (command.kind) {
            case Kind::wait:
                for (Track& track : tracks) {
                    if (track.signalled[command.signaller] != 0) {
                        track.reached[command.queue].ordered |= command.stages;
                        track.reached[command.queue].available |= command.stages;
                        track.sights.push_back({command.queue, command.stages, any_memory, Means::wait, command.batch});
                    }
                }
                break;
            case Kind::signal:
                for (Track& track : tracks) {
                    track.signalled[command.batch] =
                        queue == command.queue || track.reached[command.queue].ordered != 0 ? 1 : 0;
                }
                break;
            case Kind::barriers:
                if (!transitions_rely(touch, command, tracks, queue)) {
                    return; // overwritten
                }
                for (Track& track : tracks) {
                    cross(touch, command, track, queue);
                }
                break;
            case Kind::touches:
                bool overwritten = false;
                for (const Touch& later : command.touches) {
                    rely(touch, later, command, tracks);
                    overwritten = overwritten ||
                                  (later.resource == touch.resource && later.writes && later.part.holds(touch.part));
                }
                if (overwritten) {
                    return;
                }
            }
        }
    }

    [[nodiscard]] bool in_source(const Touch& touch, const Track& track, const Recorded& r, const Command& command,
                                 std::uint32_t queue) const {
        const VkPipelineStageFlags2 src = expanded(r.src);
        const bool own = touch.transition == none && (queue == none || queue == command.queue) &&
                         ((track.stage == all_commands ? r.src & all_commands : src & track.stage) != 0);
        return own || (track.reached[command.queue].ordered & src) != 0;
    }
    [[nodiscard]] bool made_available(const Touch& touch, const Track& track, const Recorded& r,
                                      const Command& command) const {
        const VkAccessFlags2 written = touch.access & writes_of_memory;
        return (touch.transition == none && written != 0 && includes(r.src_access, written)) ||
               (track.reached[command.queue].available & expanded(r.src)) != 0;
    }
    /// Passes the barriers of one command; none of them comes after another.
    void cross(const Touch& touch, const Command& command, Track& track, std::uint32_t queue) const {
        const Reached before = track.reached[command.queue];
        Reached grown = before;
        for (const Recorded& r : command.barriers) {
            if (!in_source(touch, track, r, command, queue)) {
                continue;
            }
            const Dependency& d = plan_.dependencies[r.dependency];
            const VkPipelineStageFlags2 dst = expanded(r.dst);
            grown.ordered |= dst;
            const bool same = d.resource == touch.resource &&
                              part_of(graph_.resources[d.resource], d.image_range, d.buffer_range).holds(touch.part);
            const bool shared = d.hazard == Hazard::aliased_memory && share_bytes(plan_, d.resource, touch.resource);
            const bool chained = (before.available & expanded(r.src)) != 0;
            if (chained || ((same || shared) && made_available(touch, track, r, command))) {
                grown.available |= dst;
            }
            if (same && made_available(touch, track, r, command)) {
                track.sights.push_back({command.queue, dst, r.dst_access, Means::barrier, r.dependency});
            }
        }
        track.reached[command.queue] = grown;
    }

    /// Transitions of the same bytes; false if one of them overwrites the touch.
    bool transitions_rely(const Touch& touch, const Command& command, const std::vector<Track>& tracks,
                          std::uint32_t queue) {
        bool goes_on = true;
        for (const Recorded& r : command.barriers) {
            const Dependency& d = plan_.dependencies[r.dependency];
            if (!r.acts) {
                continue;
            }
            const Touch later = transition_of(r);
            const bool same = later.resource == touch.resource && later.part.meets(touch.part);
            if (!same && !share_bytes(plan_, later.resource, touch.resource)) {
                continue;
            }
            const bool takes_over = d.hazard == Hazard::aliased_memory || same;
            const bool safe = std::all_of(tracks.begin(), tracks.end(), [&](const Track& track) {
                const bool flushed = (track.reached[command.queue].available & expanded(r.src)) != 0 ||
                                     (takes_over && made_available(touch, track, r, command));
                return in_source(touch, track, r, command, queue) && (!touch.writes || flushed);
            });
            found_.push_back({touch.pass, later.pass, later.resource, safe ? Means::barrier : Means::nothing,
                              safe ? r.dependency : none});
            goes_on = goes_on && !(same && later.part.holds(touch.part));
        }
        return goes_on;
    }

    void rely(const Touch& touch, const Touch& later, const Command& command, const std::vector<Track>& tracks) {
        const bool same = later.resource == touch.resource;
        const bool meet = same ? later.part.meets(touch.part) : share_bytes(plan_, later.resource, touch.resource);
        if (!meet || (!touch.writes && !later.writes)) {
            return;
        }
        Reliance reliance{touch.pass, later.pass, later.resource, Means::other_barrier, none};
        for (const Track& track : tracks) {
            for (VkPipelineStageFlags2 left = later.stages; left != 0; left &= left - 1) {
                const VkPipelineStageFlags2 stage = left & ~(left - 1);
                const Reached& reached = track.reached[command.queue];
                VkAccessFlags2 seen = 0;
                const Sight* first = nullptr;
                for (const Sight& sight : track.sights) {
                    if (sight.queue == command.queue && (sight.stages & stage) != 0) {
                        seen |= sight.access;
                        first = first == nullptr || sight.means == Means::wait ? &sight : first;
                    }
                }
                const bool enough = !touch.writes ? true
                                    : same        ? includes(seen, later.access)
                                                  : !later.writes || (reached.available & stage) != 0;
                if ((reached.ordered & stage) == 0 || !enough) {
                    found_.push_back({touch.pass, later.pass, later.resource, Means::nothing, none});
                    return;
                }
                if (first != nullptr && reliance.by == none) {
                    reliance.means = first->means;
                    reliance.by = first->by;
                }
            }
        }
        found_.push_back(reliance);
    }

    const GraphDesc& graph_;
    const Plan& plan_;
    std::vector<Command> commands_;
    std::vector<Reliance> found_;
};

} // namespace

std::vector<Reliance> reliances(const GraphDesc& graph, const Plan& plan) {
    return Oracle(graph, plan).run();
}

bool have_common_bytes(const GraphDesc& graph, const Plan& plan, const AccessDesc& a, const AccessDesc& b) {
    const ResourceDesc& r = graph.resources[a.resource];
    return a.resource == b.resource
               ? part_of(r, a.image_range, a.buffer_range).meets(part_of(r, b.image_range, b.buffer_range))
               : share_bytes(plan, a.resource, b.resource);
}

} // namespace tyndall::rg::test
