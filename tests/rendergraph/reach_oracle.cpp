#include "tests/rendergraph/reach_oracle.hpp"

#include <algorithm>

#include "tests/rendergraph/recorded_commands.hpp"

namespace tyndall::rg::test {
namespace {

class Oracle {
public:
    Oracle(const GraphDesc& graph, const Plan& plan)
        : graph_(graph), plan_(plan), commands_(recorded_commands(graph, plan)) {}

    std::vector<Reliance> run() {
        for (std::uint32_t r = 0; r < graph_.resources.size(); ++r) {
            const std::uint32_t import = graph_.resources[r].import;
            if (import != none && graph_.imports[import].initial_stages != 0) {
                follow_host(r, graph_.imports[import]);
            }
        }
        for (std::size_t c = 0; c < commands_.size(); ++c) {
            for (const Touch& touch : commands_[c].touches) {
                follow_parts(touch, c + 1, commands_[c].queue);
            }
            for (const Recorded& recorded : commands_[c].barriers) {
                if (recorded.acts) {
                    follow_parts(transition_of(graph_, plan_, recorded), c + 1, commands_[c].queue);
                }
            }
        }
        return std::move(found_);
    }

private:
    /// What it did on the device it submitted to the first queue; what it did itself came before everything.
    void follow_host(std::uint32_t resource, const ImportDesc& import) {
        const auto follow_stages = [&](VkPipelineStageFlags2 stages, std::uint32_t queue) {
            if (stages != 0) {
                const Touch touch{none,
                                  resource,
                                  part_of(graph_.resources[resource], {}, {}),
                                  stages,
                                  import.initial_access,
                                  (import.initial_access & writes_of_memory) != 0,
                                  none};
                follow_parts(touch, 0, queue);
            }
        };
        follow_stages(import.initial_stages & ~VK_PIPELINE_STAGE_2_HOST_BIT, 0);
        follow_stages(import.initial_stages & VK_PIPELINE_STAGE_2_HOST_BIT, none);
    }

    /// The parts of a touch that later touches and barriers tell apart.
    void follow_parts(const Touch& touch, std::size_t first, std::uint32_t queue) {
        for (const Part& piece : pieces_of(graph_, touch.resource, touch.part)) {
            Touch part = touch;
            part.part = piece;
            follow(part, first, queue);
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
            case CommandKind::wait:
                for (Track& track : tracks) {
                    if (track.signalled[command.signaller] != 0) {
                        track.reached[command.queue].ordered |= command.stages;
                        track.reached[command.queue].available |= command.stages;
                        track.sights.push_back({command.queue, command.stages, any_memory, Means::wait, command.batch});
                    }
                }
                break;
            case CommandKind::signal:
                for (Track& track : tracks) {
                    track.signalled[command.batch] =
                        queue == command.queue || track.reached[command.queue].ordered != 0 ? 1 : 0;
                }
                break;
            case CommandKind::barriers:
                if (!transitions_rely(touch, command, tracks, queue)) {
                    return; // overwritten
                }
                for (Track& track : tracks) {
                    cross(touch, command, track, queue);
                }
                break;
            case CommandKind::touches:
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
            const Touch later = transition_of(graph_, plan_, r);
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
