#include "rendergraph/json_types.hpp"
#include "rendergraph/report.hpp"

namespace tyndall::rg {
namespace {

using json::Json;

constexpr int predicted_process = 1;
constexpr int measured_process = 2;

Json microseconds(std::int64_t nanoseconds) {
    return nanoseconds % 1'000 == 0 ? Json(nanoseconds / 1'000) : Json(static_cast<double>(nanoseconds) / 1'000.0);
}

void name_process(Json& events, const Plan& plan, int process, const char* name) {
    events.push_back({{"ph", "M"}, {"pid", process}, {"name", "process_name"}, {"args", {{"name", name}}}});
    for (std::size_t queue = 0; queue < plan.topology.queues.size(); ++queue) {
        events.push_back({{"ph", "M"},
                          {"pid", process},
                          {"tid", queue},
                          {"name", "thread_name"},
                          {"args", {{"name", name_of(plan.topology.queues[queue].kind)}}}});
    }
}

void add_passes(Json& events, const GraphDesc& graph, int process, std::span<const TimelinePass> passes) {
    for (const TimelinePass& pass : passes) {
        events.push_back({{"ph", "X"},
                          {"pid", process},
                          {"tid", pass.queue},
                          {"name", graph.passes[pass.pass].name},
                          {"cat", name_of(graph.passes[pass.pass].kind)},
                          {"ts", microseconds(pass.start_ns)},
                          {"dur", microseconds(pass.end_ns - pass.start_ns)}});
    }
}

const TimelinePass* slice_of(const Timeline& timeline, std::uint32_t pass) {
    for (const TimelinePass& slice : timeline.passes) {
        if (slice.pass == pass) {
            return &slice;
        }
    }
    return nullptr;
}

} // namespace

std::string to_trace(const GraphDesc& graph, const Plan& plan, const Timeline& predicted,
                     std::span<const TimelinePass> measured) {
    Json events = Json::array();
    name_process(events, plan, predicted_process, "predicted");
    add_passes(events, graph, predicted_process, predicted.passes);
    for (std::size_t i = 0; i < predicted.waits.size(); ++i) {
        const TimelinePass* from = slice_of(predicted, predicted.waits[i].producer);
        const TimelinePass* to = slice_of(predicted, predicted.waits[i].consumer);
        if (from == nullptr || to == nullptr) {
            continue;
        }
        // An arrow begins and ends inside slices: a nanosecond before the one's end, at the other's start.
        events.push_back({{"ph", "s"},
                          {"id", i},
                          {"pid", predicted_process},
                          {"tid", from->queue},
                          {"name", "wait"},
                          {"cat", "wait"},
                          {"ts", microseconds(from->end_ns - 1)}});
        events.push_back({{"ph", "f"},
                          {"bp", "e"},
                          {"id", i},
                          {"pid", predicted_process},
                          {"tid", to->queue},
                          {"name", "wait"},
                          {"cat", "wait"},
                          {"ts", microseconds(to->start_ns)}});
    }
    for (const MemorySample& sample : predicted.memory) {
        events.push_back({{"ph", "C"},
                          {"pid", predicted_process},
                          {"name", "transient bytes"},
                          {"ts", microseconds(sample.time_ns)},
                          {"args", {{"bytes", sample.bytes}}}});
    }
    if (!measured.empty()) {
        name_process(events, plan, measured_process, "measured");
        add_passes(events, graph, measured_process, measured);
    }
    return json::dump({{"traceEvents", events}, {"displayTimeUnit", "ns"}}, -1) + "\n";
}

} // namespace tyndall::rg
