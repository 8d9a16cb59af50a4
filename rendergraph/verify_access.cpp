// Accesses of passes, and what they and transitions conflict with.
#include <algorithm>

#include "rendergraph/verify_replay.hpp"

namespace tyndall::rg::checker {

void Replay::check_access(const AccessDesc& access, const Toucher& toucher, const AttachmentOps* ops) {
    const ResourceDesc& resource = graph_.resources[access.resource];
    memory_.take_bytes(access.resource);
    Object& object = memory_.of_resource(access.resource);
    if (object.awaits_host) {
        report(ViolationCode::race, access.pass, none, access.resource,
               pass_name(access.pass) + " touches " + resource_name(access.resource) +
                   " before its host's semaphore was waited for");
    }
    const bool attachment = access.access == Access::color_attachment || access.access == Access::depth_attachment;
    if (attachment && ops == nullptr) {
        report(ViolationCode::malformed, access.pass, none, access.resource,
               resource_name(access.resource) + " has no load and store operations in " + pass_name(access.pass));
    }
    const std::uint8_t can = plan_.topology.queues[toucher.queue].capabilities | can_host;
    if ((access_info(access.access).needs & can) == 0) {
        report(ViolationCode::queue_cannot, access.pass, none, access.resource,
               pass_name(access.pass) + " touches " + resource_name(access.resource) +
                   " in a way that its queue cannot");
    }
    const Region region = region_of(resource, access.image_range, access.buffer_range);
    for_atoms(object, atoms_meeting(object, region), [&](Atom& atom) {
        check_conflicts(object, atom, toucher);
        check_state(access, toucher, atom, ops);
    });
}

/// Layout, content and owner.
void Replay::check_state(const AccessDesc& access, const Toucher& toucher, const Atom& atom, const AttachmentOps* ops) {
    const ResourceDesc& resource = graph_.resources[access.resource];
    const bool image = resource.kind == ResourceKind::image;
    const auto say = [&](ViolationCode code, const char* verb, const char* what) {
        report(code, access.pass, none, access.resource,
               pass_name(access.pass) + verb + resource_name(access.resource) + what);
    };
    if (image && atom.layout != access_scope(access.access, access.direction, resource.image.format).layout) {
        say(ViolationCode::wrong_layout, " finds ", " in another layout than it needs");
    }
    if (is_read(access.direction)) {
        const Object& object = memory_.of_resource(access.resource);
        const std::uint32_t named = access.direction == Direction::read ? access.version : access.version - 1;
        if (!atom.defined) {
            say(ViolationCode::undefined_content, " reads undefined content of ", "");
        } else if (atom.version != expected_version(object, atom, named)) {
            say(ViolationCode::wrong_version, " reads ", " where it holds another version than the pass names");
        }
        if (ops != nullptr && ops->load != VK_ATTACHMENT_LOAD_OP_LOAD) {
            say(ViolationCode::undefined_content, " does not load ", ", though it uses what it holds");
        }
    } else if (ops != nullptr && access.clears && ops->load != VK_ATTACHMENT_LOAD_OP_CLEAR) {
        say(ViolationCode::undefined_content, " does not clear ", ", though it says so");
    }
    const std::uint32_t family = plan_.topology.queues[toucher.queue].family;
    const bool foreign = atom.owner != VK_QUEUE_FAMILY_IGNORED && atom.owner != family;
    const bool given_away = atom.released && atom.released_to != VK_QUEUE_FAMILY_IGNORED;
    if (memory_.of_resource(access.resource).exclusive && is_read(access.direction) && (foreign || given_away)) {
        say(ViolationCode::ownership, " reads ", ", which another family owns");
    }
}

std::uint32_t Replay::expected_version(const Object& object, const Atom& atom, std::uint32_t version) const {
    auto it =
        std::upper_bound(object.writers.begin(), object.writers.end(), version,
                         [&](std::uint32_t v, std::uint32_t writer) { return v < graph_.accesses[writer].version; });
    while (it != object.writers.begin()) {
        const AccessDesc& writer = graph_.accesses[*--it];
        const Region r = region_of(graph_.resources[writer.resource], writer.image_range, writer.buffer_range);
        const Region& a = atom.region;
        if (r.first_a <= a.first_a && a.end_a <= r.end_a && r.first_b <= a.first_b && a.end_b <= r.end_b) {
            return writer.version;
        }
    }
    return 0;
}

void Replay::record_access(const AccessDesc& access, const Toucher& toucher, const AttachmentOps* ops) {
    const ResourceDesc& resource = graph_.resources[access.resource];
    Object& object = memory_.of_resource(access.resource);
    if (!object.holds_bytes) {
        report(ViolationCode::race, access.pass, access.pass, access.resource,
               pass_name(access.pass) + " touches " + resource_name(access.resource) +
                   " and another resource in the same bytes");
    }
    Event event;
    event.pass = access.pass;
    event.at = {toucher.queue, toucher.sequence, toucher.stages, false};
    event.written = toucher.writes ? toucher.access & writing : VkAccessFlags2{0};
    const bool dropped = ops != nullptr && ops->store == VK_ATTACHMENT_STORE_OP_DONT_CARE;
    const Region region = region_of(resource, access.image_range, access.buffer_range);
    for_atoms(object, atoms_meeting(object, region), [&](Atom& atom) {
        atom.owner = plan_.topology.queues[toucher.queue].family;
        atom.released = false;
        atom.defined = (atom.defined || toucher.writes) && !dropped;
        if (toucher.writes) {
            atom.version = access.version;
            atom.last_write = event;
            atom.written = true;
            atom.reads.clear();
            memory_.begin(object, atom);
            return;
        }
        const auto same = std::find_if(atom.reads.begin(), atom.reads.end(), [&](const Event& read) {
            return read.at.queue == event.at.queue && read.at.stages == event.at.stages;
        });
        if (same == atom.reads.end()) {
            atom.reads.push_back(event);
        } else { // what comes after the later of two comes after both
            *same = event;
        }
    });
}

bool Replay::ordered(const Event& event, const Toucher& toucher) const {
    return toucher.source != nullptr ? covers(toucher.source->ordered.data(), event.at)
                                     : order_.after(event.at, toucher.queue, toucher.stages);
}

bool Replay::available_in(const Event& event, const SourceScope& source) const {
    return event.written == 0 || covers(source.available.data(), event.at) ||
           std::any_of(event.available_from.begin(), event.available_from.end(),
                       [&](const Point& point) { return covers(source.ordered.data(), point); });
}

bool Replay::available(const Event& event, const Toucher& toucher, bool same_content) const {
    if (toucher.source != nullptr) {
        // A barrier of a resource reaches what was written through that resource; of shared memory, all of it.
        const bool reaches = same_content || toucher.effect->d->hazard == Hazard::aliased_memory;
        return available_in(event, *toucher.source) ||
               (reaches && event.written != 0 && covers_access(toucher.effect->src_access, event.written));
    }
    return event.written == 0 || order_.available(event.at, toucher.queue, toucher.stages) ||
           std::any_of(event.available_from.begin(), event.available_from.end(),
                       [&](const Point& point) { return order_.after(point, toucher.queue, toucher.stages); });
}

bool Replay::visible(const Event& event, const Toucher& toucher) const {
    bool all = true;
    for_each_stage(toucher.stages, [&](std::uint32_t number) {
        const StageSet stage = 1U << number;
        VkAccessFlags2 seen = 0;
        for (const Sight& sight : event.seen_by) {
            seen |= sight.queue == toucher.queue && (sight.stages & stage) != 0 ? sight.access : VkAccessFlags2{0};
        }
        all = all && (covers_access(seen, toucher.access) || order_.visible(event.at, toucher.queue, stage));
    });
    return all;
}

/// One earlier event. `same_content`: it is of the bytes' present tenant, whose content the toucher may use.
void Replay::check_against(const Event& event, std::uint32_t frame, const Toucher& toucher, std::uint32_t resource,
                           bool same_content) {
    // Passes of other frames have their own names.
    const std::uint32_t other = frame == frame_ ? event.pass : none;
    const auto who = [&] { return frame == frame_ ? pass_name(event.pass) : std::string("the frame before"); };
    const auto what = [&] {
        return (toucher.source != nullptr ? "the layout transition or change of owner of " + resource_name(resource) +
                                                " before " + pass_name(toucher.pass)
                                          : pass_name(toucher.pass) + " touches " + resource_name(resource));
    };
    if (!ordered(event, toucher)) {
        report(ViolationCode::race, toucher.pass, other, resource,
               what() + (toucher.source != nullptr ? " is not" : " without being") + " ordered after " + who());
    } else if (toucher.writes && !available(event, toucher, same_content)) {
        report(ViolationCode::not_visible, toucher.pass, other, resource,
               what() + ", but what " + who() + " wrote to these bytes is not available before");
    } else if (same_content && toucher.source == nullptr && !visible(event, toucher)) {
        report(ViolationCode::not_visible, toucher.pass, other, resource,
               "what " + who() + " wrote is not visible to the access of " + pass_name(toucher.pass) + " to " +
                   resource_name(resource));
    }
}

void Replay::check_conflicts(Object& object, const Atom& atom, const Toucher& toucher) {
    const auto check_reads = [&](const Atom& of, std::uint32_t frame) {
        for (const Event& read : of.reads) {
            if (!ordered(read, toucher)) {
                report(ViolationCode::race, toucher.pass, frame == frame_ ? read.pass : none, object.resource,
                       (toucher.source != nullptr
                            ? "the layout transition or change of owner of " + resource_name(object.resource) +
                                  " before " + pass_name(toucher.pass) + " is not ordered after "
                            : pass_name(toucher.pass) + " writes " + resource_name(object.resource) +
                                  " without being ordered after ") +
                           (frame == frame_ ? pass_name(read.pass) : "the frame before") + ", which reads it");
            }
        }
    };
    if (atom.written) {
        check_against(atom.last_write, object.frame, toucher, object.resource, true);
    }
    if (toucher.writes) {
        check_reads(atom, object.frame);
    }
    if (atom.begun) {
        return;
    }
    for (const std::uint32_t index : object.displaced) {
        const Object& other = memory_.at(index);
        for (const Atom& theirs : other.atoms) {
            if (theirs.written) {
                check_against(theirs.last_write, other.frame, toucher, object.resource, false);
            }
            if (toucher.writes) {
                check_reads(theirs, other.frame);
            }
        }
    }
}

} // namespace tyndall::rg::checker
