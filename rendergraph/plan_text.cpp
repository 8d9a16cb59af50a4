#include "rendergraph/plan_text.hpp"

#include "rendergraph/vulkan_names.hpp"

namespace tyndall::rg {
namespace {

std::string quoted(const std::string& name) {
    return "'" + name + "'";
}

std::string pass_name(const GraphDesc& graph, std::uint32_t pass) {
    return pass == none ? std::string("the host") : quoted(graph.passes[pass].name);
}

std::string layout_name(VkImageLayout layout) {
    const std::optional<std::string_view> name = name_in(layout_names(), layout);
    return name ? std::string(*name) : std::to_string(layout);
}

std::string range_text(const GraphDesc& graph, const Dependency& d) {
    const ResourceDesc& resource = graph.resources[d.resource];
    if (resource.kind == ResourceKind::buffer) {
        return d.buffer_range == BufferRange{}
                   ? ""
                   : " bytes " + std::to_string(d.buffer_range.offset) + "+" + std::to_string(d.buffer_range.size);
    }
    if (d.image_range == ImageRange{}) {
        return "";
    }
    return " mips " + std::to_string(d.image_range.base_mip) + "+" + std::to_string(d.image_range.mip_count) +
           " layers " + std::to_string(d.image_range.base_layer) + "+" + std::to_string(d.image_range.layer_count);
}

std::string queue_name(const Plan& plan, std::uint32_t queue) {
    return std::string(name_of(plan.topology.queues[queue].kind));
}

/// "1.25" of 125.
std::string hundredths(std::int64_t value) {
    const std::int64_t size = value < 0 ? -value : value;
    const std::string digits = std::to_string(size % 100);
    return (value < 0 ? "-" : "") + std::to_string(size / 100) + (digits.size() == 1 ? ".0" : ".") + digits;
}

} // namespace

std::string_view name_of(Hazard hazard) {
    switch (hazard) {
    case Hazard::read_after_write: return "read after write";
    case Hazard::write_after_read: return "write after read";
    case Hazard::write_after_write: return "write after write";
    case Hazard::layout_change: return "layout change";
    case Hazard::aliased_memory: return "aliased memory";
    case Hazard::import_entry: return "import entry";
    case Hazard::import_exit: return "import exit";
    case Hazard::frame_entry: return "frame entry";
    case Hazard::history_rest: return "history rest";
    }
    return "";
}

std::string why_kept(const GraphDesc& graph, const PlannedPass& pass) {
    switch (pass.keep_reason) {
    case KeepReason::side_effect: {
        const std::string& effect = graph.passes[pass.pass].side_effect;
        return effect.empty() ? "a side effect without a name" : "side effect: " + effect;
    }
    case KeepReason::writes_import: return "writes " + quoted(graph.resources[pass.keep_for].name) + " for the host";
    case KeepReason::writes_history:
        return "writes " + quoted(graph.resources[pass.keep_for].name) + " for the next frame";
    case KeepReason::feeds_kept_pass:
        return pass.keep_for == none ? "culling is switched off" : "feeds " + pass_name(graph, pass.keep_for);
    }
    return "";
}

std::string why_culled(const GraphDesc& graph, const CulledPass& pass) {
    switch (pass.reason) {
    case CullReason::no_consumer:
        return pass.because_of == none ? "it writes nothing and has no side effect"
                                       : "nothing reads " + quoted(graph.resources[pass.because_of].name);
    case CullReason::consumer_culled: return "its consumer " + pass_name(graph, pass.because_of) + " is left out";
    case CullReason::all_passes_culled: return "all passes that touch it are left out";
    case CullReason::never_used: return "no pass touches it";
    case CullReason::other_form: return "another form of " + quoted(graph.variants[pass.because_of].name) + " is kept";
    }
    return "";
}

std::string why_queue(const PlannedPass& pass) {
    switch (pass.queue_reason) {
    case QueueReason::only_queue_that_can: return "only the graphics queue can";
    case QueueReason::asked_for: return "asked for";
    case QueueReason::default_graphics: return "no other queue asked for";
    case QueueReason::asked_for_but_no_such_queue: return "another queue asked for, but there is none";
    case QueueReason::async_switched_off: return "asynchronous queues are switched off";
    case QueueReason::import_ordered_by_queue:
        return "only the first queue is ordered with the host's use of an import that it touches";
    case QueueReason::import_not_shared: return "an import that it touches is not shared between families";
    case QueueReason::forbidden: return "other queues that could are forbidden";
    case QueueReason::overlap_pays: return "beside other work there, the frame is shorter";
    case QueueReason::earliest_here: return "no other queue finishes it earlier";
    }
    return "";
}

std::string describe(const GraphDesc& graph, const Dependency& d) {
    std::string text =
        std::string(name_of(d.hazard)) + " of " + quoted(graph.resources[d.resource].name) + range_text(graph, d);
    if (d.producer != none) {
        text += " after " + pass_name(graph, d.producer);
    }
    if (d.alias_of != none) {
        text += ", in the memory of " + quoted(graph.resources[d.alias_of].name);
    }
    if (d.orders_for != none) {
        text += ", and what " + quoted(graph.resources[d.orders_for].name) + " needs no other for";
    }
    text += ": " + mask_text(stage_names(), d.src_stages) + " (" + mask_text(access_names(), d.src_access) + ") -> " +
            mask_text(stage_names(), d.dst_stages) + " (" + mask_text(access_names(), d.dst_access) + ")";
    if (d.old_layout != d.new_layout) {
        text += ", " + layout_name(d.old_layout) + " -> " + layout_name(d.new_layout);
    }
    if (d.src_queue != d.dst_queue) {
        text += d.transfers_ownership ? ", ownership between families" : ", through another queue's semaphore";
    }
    return text;
}

std::string milliseconds_text(std::int64_t nanoseconds) {
    return hundredths((nanoseconds + (nanoseconds < 0 ? -5'000 : 5'000)) / 10'000) + " ms";
}

std::string mebibytes_text(VkDeviceSize bytes) {
    constexpr VkDeviceSize mebibyte = VkDeviceSize{1} << 20U;
    const VkDeviceSize rest = bytes % mebibyte;
    return hundredths(static_cast<std::int64_t>(bytes / mebibyte * 100 + (rest * 100 + mebibyte / 2) / mebibyte)) +
           " MiB";
}

std::string describe(const AsyncDecision& decision) {
    std::string text = "ceiling " + milliseconds_text(decision.ceiling_ns) + ", predicted " +
                       milliseconds_text(decision.serial_ns - decision.overlap_ns) + ", threshold " +
                       milliseconds_text(decision.threshold_ns) + (decision.overlaps ? ": overlap" : ": serial");
    switch (decision.reason) {
    case DecisionReason::one_queue: text += ", there is one queue"; break;
    case DecisionReason::switched_off: text += ", asynchronous queues are switched off"; break;
    case DecisionReason::nothing_async_capable: text += ", no pass that is free to choose can run elsewhere"; break;
    case DecisionReason::nothing_measured: text += ", no pass was measured"; break;
    case DecisionReason::ceiling_below_threshold: text += ", even a perfect schedule would gain less"; break;
    case DecisionReason::gain_below_threshold: text += ", the best schedule found gains less"; break;
    case DecisionReason::overlap_pays: break;
    case DecisionReason::forced: text += ", asked for by passes"; break;
    }
    return text + (decision.kept_by_hysteresis ? ", kept from the frame before" : "");
}

std::string to_text(const GraphDesc& graph, const Plan& plan) {
    std::string text;
    for (std::uint32_t b = 0; b < plan.batches.size(); ++b) {
        const Batch& batch = plan.batches[b];
        text += "batch " + std::to_string(b) + " on " + queue_name(plan, batch.queue);
        for (const BatchWait& wait : batch.waits) {
            text += ", waits for batch " + std::to_string(wait.batch);
        }
        for (const std::uint32_t resource : batch.waits_imports) {
            text += ", waits for the host's semaphore of " + quoted(graph.resources[resource].name);
        }
        text += "\n";
        for (std::uint32_t i = batch.first_pass; i < batch.first_pass + batch.pass_count; ++i) {
            const PlannedPass& planned = plan.passes[i];
            for (std::uint32_t d = planned.first_barrier; d < planned.first_barrier + planned.barrier_count; ++d) {
                text += "    " + describe(graph, plan.dependencies[d]) + "\n";
            }
            text += "  " + graph.passes[planned.pass].name + "  [" + why_kept(graph, planned) + "]\n";
        }
        for (const std::uint32_t d : batch.releases) {
            text += "    at the end: " + describe(graph, plan.dependencies[d]) + "\n";
        }
        for (const std::uint32_t resource : batch.signals_imports) {
            text += "    signals the host's semaphore of " + quoted(graph.resources[resource].name) + "\n";
        }
    }
    for (std::uint32_t d = plan.first_exit_barrier; d < plan.first_exit_barrier + plan.exit_barrier_count; ++d) {
        text += "leaving: " + describe(graph, plan.dependencies[d]) + "\n";
    }
    for (const CulledPass& pass : plan.culled_passes) {
        text += "left out: " + graph.passes[pass.pass].name + ", " + why_culled(graph, pass) + "\n";
    }
    for (const CulledResource& resource : plan.culled_resources) {
        text += "not created: " + graph.resources[resource.resource].name + ", " +
                (resource.reason == CullReason::never_used ? "no pass touches it"
                                                           : "only passes that are left out touch it") +
                "\n";
    }
    for (std::uint32_t r = 0; r < plan.placements.size(); ++r) {
        const Placement& placement = plan.placements[r];
        if (placement.kind == PlacementKind::heap) {
            text += "memory: " + graph.resources[r].name + " at " + std::to_string(placement.offset_bytes) + "+" +
                    std::to_string(placement.size_bytes) + " of heap " + std::to_string(placement.heap);
            if (placement.shares_with != none) {
                text += ", after " + quoted(graph.resources[placement.shares_with].name);
            }
            text += placement.concurrent ? ", concurrent\n" : "\n";
        } else if (placement.kind == PlacementKind::history) {
            text += "memory: " + graph.resources[r].name + ", one of two copies that swap each frame\n";
        }
    }
    text += "transient bytes " + std::to_string(plan.statistics.transient_bytes) + ", without sharing " +
            std::to_string(plan.statistics.transient_bytes_unaliased) + ", at least " +
            std::to_string(plan.statistics.transient_bound_bytes) + "\n";
    return text;
}

} // namespace tyndall::rg
