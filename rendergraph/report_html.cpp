#include <algorithm>

#include "rendergraph/json_types.hpp"
#include "rendergraph/optimality.hpp"
#include "rendergraph/plan_text.hpp"
#include "rendergraph/reasons.hpp"
#include "rendergraph/report.hpp"
#include "rendergraph/report_page.hpp"
#include "rendergraph/vulkan_names.hpp"

namespace tyndall::rg {
namespace {

using json::Json;

constexpr std::int64_t nobody = -1; ///< the page's "no pass", "no heap"

/// The page speaks of passes by their place in Plan::passes.
class Page {
public:
    Page(const GraphDesc& graph, const Plan& plan, const Costs& costs)
        : graph_(graph), plan_(plan), timeline_(simulate(graph, plan, costs)), order_(graph, plan),
          place_(graph.passes.size(), nobody) {
        for (std::size_t place = 0; place < plan.passes.size(); ++place) {
            place_[plan.passes[place].pass] = static_cast<std::int64_t>(place);
        }
    }

    Json data(std::string_view title, std::string_view about) const {
        Json queues = Json::array();
        for (const QueueInfo& queue : plan_.topology.queues) {
            queues.push_back(name_of(queue.kind));
        }
        Json heaps = Json::array();
        for (const Heap& heap : plan_.heaps) {
            heaps.push_back(heap.size_bytes);
        }
        Json variants = Json::array();
        for (std::uint32_t variant = 0; variant < plan_.variants.size(); ++variant) {
            variants.push_back(why_form(graph_, plan_, variant));
        }
        return {{"title", title},
                {"about", about},
                {"decision", describe(plan_.decision)},
                {"tiles", tiles()},
                {"makespan", timeline_.makespan_ns},
                {"queues", queues},
                {"heaps", heaps},
                {"variants", variants},
                {"passes", passes()},
                {"left_out", left_out()},
                {"barriers", barriers()},
                {"waits", waits()},
                {"resources", resources()}};
    }

private:
    [[nodiscard]] std::int64_t place(std::uint32_t pass) const { return pass == none ? nobody : place_[pass]; }

    Json tiles() const {
        const Optimality o = optimality(graph_, plan_, timeline_);
        const auto tile = [](const char* label, const std::string& value, const std::string& note) -> Json {
            return {{"label", label}, {"value", value}, {"note", note}};
        };
        return {
            tile("frame, predicted", milliseconds_text(o.makespan_ns),
                 "at least " + milliseconds_text(o.makespan_bound_ns)),
            tile("on one queue", milliseconds_text(o.serial_ns), "all passes one after another"),
            tile("transient memory", mebibytes_text(o.transient_bytes),
                 "at least " + mebibytes_text(o.transient_bound_bytes) + " needed"),
            tile("without sharing", mebibytes_text(o.transient_bytes_unaliased), "every transient on its own"),
            tile("barriers", std::to_string(o.barrier_count), "in " + std::to_string(o.barrier_call_count) + " calls"),
            tile("waits", std::to_string(o.wait_count), "between " + std::to_string(o.batch_count) + " submissions")};
    }

    Json passes() const {
        Json list = Json::array();
        for (std::size_t i = 0; i < plan_.passes.size(); ++i) {
            const PlannedPass& planned = plan_.passes[i];
            const PassDesc& pass = graph_.passes[planned.pass];
            const TimelinePass& time = timeline_.passes[i];
            const auto& path = timeline_.critical_path;
            Json accesses = Json::array();
            for (std::uint32_t k = pass.first_access; k < pass.first_access + pass.access_count; ++k) {
                const AccessDesc& access = graph_.accesses[k];
                accesses.push_back({{"resource", access.resource},
                                    {"verb", access.direction == Direction::read      ? "reads"
                                             : access.direction == Direction::replace ? "writes"
                                                                                      : "modifies"},
                                    {"as", access_info(access.access).name}});
            }
            list.push_back({{"name", pass.name},
                            {"kind", name_of(pass.kind)},
                            {"point", pass.point == none ? "" : graph_.points[pass.point]},
                            {"queue", planned.queue},
                            {"slot", planned.slot},
                            {"start", time.start_ns},
                            {"end", time.end_ns},
                            {"critical", std::find(path.begin(), path.end(), planned.pass) != path.end()},
                            {"why", why_kept(graph_, planned)},
                            {"why_queue", why_queue(planned)},
                            {"accesses", accesses}});
        }
        return list;
    }

    Json left_out() const {
        Json list = Json::array();
        for (const CulledPass& pass : plan_.culled_passes) {
            list.push_back({{"name", graph_.passes[pass.pass].name}, {"why", why_culled(graph_, pass)}});
        }
        for (const CulledResource& resource : plan_.culled_resources) {
            list.push_back({{"name", graph_.resources[resource.resource].name}, {"why", why_omitted(resource)}});
        }
        return list;
    }

    Json barrier(std::uint32_t index, std::int64_t before, const std::string& where) const {
        const Dependency& d = plan_.dependencies[index];
        return {{"before", before},
                {"where", where},
                {"hazard", name_of(d.hazard)},
                {"resource", d.resource},
                {"producer", place(d.producer)},
                {"consumer", place(d.consumer)},
                {"why", describe(graph_, d)}};
    }
    Json barriers() const {
        Json list = Json::array();
        for (std::size_t i = 0; i < plan_.passes.size(); ++i) {
            const PlannedPass& planned = plan_.passes[i];
            const std::string where = "before '" + graph_.passes[planned.pass].name + "'";
            for (std::uint32_t d = planned.first_barrier; d < planned.first_barrier + planned.barrier_count; ++d) {
                list.push_back(barrier(d, static_cast<std::int64_t>(i), where));
            }
        }
        for (const Batch& batch : plan_.batches) {
            const PlannedPass& last = plan_.passes[batch.first_pass + batch.pass_count - 1];
            for (const std::uint32_t d : batch.releases) {
                list.push_back(barrier(d, nobody, "after '" + graph_.passes[last.pass].name + "'"));
            }
        }
        for (std::uint32_t d = 0; d < plan_.exit_barrier_count; ++d) {
            list.push_back(barrier(plan_.first_exit_barrier + d, nobody, "at the end of the frame"));
        }
        return list;
    }

    Json waits() const {
        Json list = Json::array();
        for (const TimelineWait& wait : timeline_.waits) {
            const std::uint32_t batch = plan_.passes[static_cast<std::size_t>(place(wait.consumer))].batch;
            const std::uint32_t producer = plan_.passes[static_cast<std::size_t>(place(wait.producer))].batch;
            std::string why;
            for (const BatchWait& one : plan_.batches[batch].waits) {
                why = one.batch == producer ? why_wait(graph_, plan_, order_, batch, one) : why;
            }
            list.push_back({{"consumer", place(wait.consumer)},
                            {"producer", place(wait.producer)},
                            {"from", wait.from_ns},
                            {"to", wait.to_ns},
                            {"why", why}});
        }
        return list;
    }

    static std::string what(const ResourceDesc& resource) {
        if (resource.kind == ResourceKind::buffer) {
            return "buffer";
        }
        const ImageDesc& image = resource.image;
        const auto name = name_in(format_names(), static_cast<std::uint64_t>(image.format));
        const auto times = [](std::uint32_t count, const char* unit) {
            return count > 1 ? ", " + std::to_string(count) + " " + unit : std::string();
        };
        return std::to_string(image.extent.width) + " x " + std::to_string(image.extent.height) +
               (image.type == VK_IMAGE_TYPE_3D ? " x " + std::to_string(image.extent.depth) : std::string()) + " " +
               std::string(name.value_or("image")) + times(image.mips, "mips") + times(image.layers, "layers") +
               times(static_cast<std::uint32_t>(image.samples), "samples");
    }
    static const char* color(const ResourceDesc& resource) {
        return resource.kind == ResourceKind::buffer        ? "buffer"
               : is_depth_or_stencil(resource.image.format) ? "depth"
               : resource.image.type == VK_IMAGE_TYPE_3D    ? "volume"
                                                            : "color";
    }

    Json resources() const {
        const MemoryRequirements estimate = estimate_memory(graph_);
        Json list = Json::array();
        for (std::uint32_t r = 0; r < graph_.resources.size(); ++r) {
            const ResourceDesc& resource = graph_.resources[r];
            const Placement& placement = plan_.placements[r];
            const bool in_heap = placement.kind == PlacementKind::heap;
            std::int64_t first = 0;
            std::int64_t last = 0;
            for (const std::uint32_t user : order_.users(r)) {
                const TimelinePass& time = timeline_.passes[user];
                first = last == 0 ? time.start_ns : std::min(first, time.start_ns);
                last = std::max(last, time.end_ns);
            }
            list.push_back({{"name", resource.name},
                            {"what", what(resource)},
                            {"color", color(resource)},
                            {"bytes", in_heap ? placement.size_bytes : estimate.of_resource[r].size_bytes},
                            {"heap", in_heap ? static_cast<std::int64_t>(placement.heap) : nobody},
                            {"offset", placement.offset_bytes},
                            {"first", first},
                            {"last", last},
                            {"users", order_.users(r)},
                            {"sharers", order_.sharers(plan_, r)},
                            {"why", why_memory(graph_, plan_, order_, r)}});
        }
        return list;
    }

    const GraphDesc& graph_;
    const Plan& plan_;
    Timeline timeline_;
    PlanOrder order_;
    std::vector<std::int64_t> place_; ///< by pass
};

} // namespace

std::string to_html(std::string_view title, std::string_view about, const GraphDesc& graph, const Plan& plan,
                    const Costs& costs) {
    constexpr std::string_view slot = "@DATA@";
    std::string data;
    for (const char c : json::dump(Page(graph, plan, costs).data(title, about), -1)) {
        data += c == '<' ? std::string("\\u003c") : std::string(1, c); // no name can end the script
    }
    std::string page(report_page);
    return page.replace(page.find(slot), slot.size(), data);
}

} // namespace tyndall::rg
