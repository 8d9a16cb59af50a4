// Plans, frame after frame, and how each frame ends.
#include "rendergraph/verify.hpp"

#include <algorithm>
#include <array>

#include "rendergraph/verify_replay.hpp"

namespace tyndall::rg {
namespace checker {

void Replay::check_end(std::uint32_t r) {
    const ResourceDesc& resource = graph_.resources[r];
    Object& object = memory_.of_resource(r);
    if (!object.touched) {
        return;
    }
    const auto say = [&](ViolationCode code, const char* what) {
        report(code, none, none, r, resource_name(r) + what);
    };
    const bool leaves = resource.import != none && graph_.imports[resource.import].has_final;
    if (leaves || resource.has_history) {
        const bool lacks = std::any_of(object.atoms.begin(), object.atoms.end(), [&](const Atom& atom) {
            const std::uint32_t last = expected_version(object, atom, none);
            return last != 0 && (!atom.defined || atom.version != last);
        });
        if (lacks) {
            say(ViolationCode::exit_state, " does not hold its last version when the frame ends");
        }
    }
    const bool kept_by_host = leaves && graph_.imports[resource.import].final_family != VK_QUEUE_FAMILY_IGNORED;
    if (object.exclusive && !kept_by_host &&
        std::any_of(object.atoms.begin(), object.atoms.end(),
                    [](const Atom& atom) { return atom.released && atom.released_to != VK_QUEUE_FAMILY_IGNORED; })) {
        say(ViolationCode::ownership, " is released and never acquired");
    }
    VkImageLayout wanted = VK_IMAGE_LAYOUT_UNDEFINED;
    if (leaves) {
        wanted = graph_.imports[resource.import].final_layout;
        check_import_end(object, graph_.imports[resource.import]);
    } else if (resource.has_history) {
        wanted = plan_.placements[r].resting_layout;
    }
    const bool left_as_agreed =
        resource.kind != ResourceKind::image || wanted == VK_IMAGE_LAYOUT_UNDEFINED ||
        std::all_of(object.atoms.begin(), object.atoms.end(), [&](const Atom& a) { return a.layout == wanted; });
    if (!left_as_agreed) {
        say(ViolationCode::exit_state, " is not left in the layout that was agreed");
    }
}

void Replay::check_import_end(Object& object, const ImportDesc& import) {
    const auto say = [&](std::uint32_t pass, const char* what) {
        report(ViolationCode::exit_state, pass, none, object.resource, resource_name(object.resource) + what);
    };
    if (import.signals_semaphore && object.host_signal.empty()) {
        say(none, " has a semaphore for the host that nothing signals");
        return;
    }
    for (const Atom& atom : object.atoms) {
        const Event& write = atom.last_write;
        const bool taken_to =
            atom.owner == import.final_family || (atom.released && atom.released_to == import.final_family);
        if (object.exclusive && import.final_family != VK_QUEUE_FAMILY_IGNORED &&
            atom.owner != VK_QUEUE_FAMILY_IGNORED && !taken_to) {
            say(write.pass, " is not left to the family that was agreed");
        }
        // Ours, or what the host wrote before and the frame passed on to its own readers.
        const bool passed_on = write.written != 0 && !atom.reads.empty();
        if (atom.written && (write.pass != none || passed_on) && import.final_stages != 0 &&
            !visible_to_host(write, import)) {
            say(write.pass, " is not visible to the host's next access when the frame ends");
        }
        const bool host_writes = (import.final_access & (writing | VK_ACCESS_2_MEMORY_WRITE_BIT)) != 0;
        if (host_writes && std::any_of(atom.reads.begin(), atom.reads.end(),
                                       [&](const Event& read) { return !before_host(read, import); })) {
            say(none, " is still read when the host writes it after the frame");
        }
        if (!import.signals_semaphore) {
            continue;
        }
        const auto late = [&](const Event& event) { return !covers(object.host_signal.data(), event.at); };
        if ((atom.written && late(write)) || std::any_of(atom.reads.begin(), atom.reads.end(), late)) {
            say(write.pass, " is still in use when the host's semaphore is signalled");
        }
    }
}

/// On whatever queue.
bool Replay::before_host(const Event& event, const ImportDesc& import) const {
    bool any = false;
    for (std::uint32_t queue = 0; queue < plan_.topology.queues.size(); ++queue) {
        any = any || order_.after(event.at, queue, destination_stages(import.final_stages));
    }
    return any;
}

/// On whatever queue.
bool Replay::visible_to_host(const Event& event, const ImportDesc& import) const {
    bool all = true;
    for_each_stage(destination_stages(import.final_stages), [&](std::uint32_t number) {
        const StageSet stage = 1U << number;
        VkAccessFlags2 seen = 0;
        bool by_semaphore = false;
        for (const Sight& sight : event.seen_by) {
            seen |= (sight.stages & stage) != 0 ? sight.access : VkAccessFlags2{0};
        }
        for (std::uint32_t queue = 0; queue < plan_.topology.queues.size(); ++queue) {
            by_semaphore = by_semaphore || order_.visible(event.at, queue, stage);
        }
        all = all && (by_semaphore || covers_access(seen, import.final_access));
    });
    return all;
}

} // namespace checker

std::vector<Violation> verify_sequence(std::span<const PlannedFrame> frames, BetweenFrames between) {
    std::vector<Violation> found;
    if (frames.empty()) {
        return found;
    }
    const std::size_t queues = frames.front().plan->topology.queues.size();
    checker::Order order(static_cast<std::uint32_t>(queues));
    checker::Memory memory;
    for (const PlannedFrame& frame : frames) {
        found = checker::check_form(*frame.graph, *frame.plan);
        if (frame.plan->topology.queues.size() != queues) {
            found.push_back(
                {.code = ViolationCode::malformed, .message = "the number of queues changes between frames"});
        }
        if (!found.empty()) {
            return found; // indices cannot be trusted
        }
        if (between == BetweenFrames::executor) {
            order.join();
        }
        memory.begin_frame(*frame.graph, *frame.plan, order);
        checker::Replay(*frame.graph, *frame.plan, order, memory, found).run();
        if (!found.empty()) {
            return found;
        }
    }
    return found;
}

std::vector<Violation> verify(const GraphDesc& graph, const Plan& plan) {
    constexpr std::size_t frames_in_flight = 2;
    std::array<PlannedFrame, frames_in_flight + 1> frames;
    frames.fill({&graph, &plan});
    return verify_sequence(frames);
}

} // namespace tyndall::rg
