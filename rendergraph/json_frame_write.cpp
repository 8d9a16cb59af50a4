// A frame as JSON: what has its default is left out, so that the file says what the frame is about.
#include <algorithm>

#include "rendergraph/json.hpp"
#include "rendergraph/json_frame_types.hpp"
#include "rendergraph/json_types.hpp"

namespace tyndall::rg {
namespace {

using json::Json;
using json::mask;
using json::named;

template <typename T>
void put_unless(Json& object, const char* key, const T& value, const T& usual) {
    if (!(value == usual)) {
        object[key] = value;
    }
}
void put_mask(Json& object, const char* key, VulkanNames names, std::uint64_t bits) {
    if (bits != 0) {
        object[key] = mask(names, bits);
    }
}
void put_family(Json& object, std::uint32_t family) {
    put_unless(object, "family", family, std::uint32_t{VK_QUEUE_FAMILY_IGNORED});
}

Json queue_json(const QueueInfo& queue) {
    const QueueInfo usual = usual_queue(queue.kind);
    const std::string_view kind = json::queue_kinds[static_cast<std::size_t>(queue.kind)];
    if (queue.family == usual.family && queue.capabilities == usual.capabilities) {
        return kind;
    }
    return {{"kind", kind}, {"family", queue.family}, {"can", mask(json::capabilities, queue.capabilities)}};
}

Json extent_json(const ImageDesc& image) {
    Json size = {image.extent.width};
    if (image.type != VK_IMAGE_TYPE_1D || image.extent.height != 1 || image.extent.depth != 1) {
        size.push_back(image.extent.height);
    }
    if (image.type == VK_IMAGE_TYPE_3D || image.extent.depth != 1) {
        size.push_back(image.extent.depth);
    }
    return size;
}

void put_image(Json& object, const ImageDesc& image) {
    object["format"] = named(format_names(), static_cast<std::uint64_t>(image.format));
    object["size"] = extent_json(image);
    if (static_cast<std::size_t>(image.type) + 1 != object["size"].size()) {
        object["type"] = json::image_types[static_cast<std::size_t>(image.type)];
    }
    put_unless(object, "mips", image.mips, 1U);
    put_unless(object, "layers", image.layers, 1U);
    put_unless(object, "samples", static_cast<std::uint32_t>(image.samples), 1U);
    put_mask(object, "flags", image_flag_names(), image.flags);
    put_mask(object, "usage", image_usage_names(), image.extra_usage);
}

Json import_json(const ImportDesc& import) {
    Json object = Json::object();
    Json initial = Json::object();
    if (import.initial_layout != VK_IMAGE_LAYOUT_UNDEFINED) {
        initial["layout"] = named(layout_names(), static_cast<std::uint64_t>(import.initial_layout));
    }
    put_mask(initial, "stages", stage_names(), import.initial_stages);
    put_mask(initial, "access", access_names(), import.initial_access);
    put_family(initial, import.initial_family);
    put_unless(initial, "waits_semaphore", import.waits_semaphore, false);
    if (!initial.empty()) {
        object["initial"] = initial;
    }
    if (import.has_final) {
        Json final_use = Json::object();
        if (import.final_layout != VK_IMAGE_LAYOUT_UNDEFINED) {
            final_use["layout"] = named(layout_names(), static_cast<std::uint64_t>(import.final_layout));
        }
        put_mask(final_use, "stages", stage_names(), import.final_stages);
        put_mask(final_use, "access", access_names(), import.final_access);
        put_family(final_use, import.final_family);
        object["final"] = final_use;
    }
    put_unless(object, "signals_semaphore", import.signals_semaphore, false);
    put_unless(object, "read_only", import.read_only, false);
    return object;
}

Json resource_json(const GraphDesc& graph, const ResourceDesc& resource) {
    Json object = {{"name", resource.name}};
    if (resource.lifetime == ResourceLifetime::history) {
        object["history_of"] = graph.resources[resource.history_of].name;
    } else if (resource.kind == ResourceKind::image) {
        put_image(object, resource.image);
    } else {
        object["bytes"] = resource.buffer.size_bytes;
        put_mask(object, "usage", buffer_usage_names(), resource.buffer.extra_usage);
    }
    put_unless(object, "concurrent", resource.concurrent, false);
    if (resource.import != none) {
        object["import"] = import_json(graph.imports[resource.import]);
    }
    return object;
}

Json clear_json(const VkClearValue& clear, VkFormat format) {
    if (is_depth_or_stencil(format)) {
        return {{"depth", clear.depthStencil.depth}, {"stencil", clear.depthStencil.stencil}};
    }
    Json list = Json::array();
    for (std::size_t i = 0; i < 4; ++i) {
        switch (json::clear_numbers_of(format)) {
        case json::ClearNumbers::unsigned_whole: list.push_back(clear.color.uint32[i]); break;
        case json::ClearNumbers::signed_whole: list.push_back(clear.color.int32[i]); break;
        case json::ClearNumbers::real: list.push_back(clear.color.float32[i]); break;
        }
    }
    return list;
}

void put_range(Json& object, const char* key, std::uint64_t base, std::uint64_t count, std::uint64_t remaining) {
    if (count != remaining) {
        object[key] = {base, count};
    } else if (base != 0) {
        object[key] = Json::array({base});
    }
}

/// Follows the versions, so that only what differs from the order of declaration is written with its version.
class AccessWriter {
public:
    explicit AccessWriter(const GraphDesc& graph) : graph_(graph), latest_(graph.resources.size(), 0) {}

    Json write(const AccessDesc& access) {
        const ResourceDesc& resource = graph_.resources[access.resource];
        std::uint32_t& latest = latest_[access.resource];
        const std::uint32_t expected = is_write(access.direction) ? latest + 1 : latest;
        const bool looks_versioned = json::split_version(resource.name).version != none;
        const bool plain = access.version == expected && !looks_versioned;
        latest = is_write(access.direction) ? std::max(latest, access.version) : latest;
        Json object = {{std::string(json::verbs[static_cast<std::size_t>(access.direction)]),
                        resource.name + (plain ? "" : "@" + std::to_string(access.version))},
                       {"as", access_info(access.access).name}};
        if (resource.kind == ResourceKind::image) {
            const ImageRange& range = access.image_range;
            put_range(object, "mips", range.base_mip, range.mip_count, all_remaining);
            put_range(object, "layers", range.base_layer, range.layer_count, all_remaining);
            put_mask(object, "aspects", aspect_names(), range.aspects);
        } else {
            put_range(object, "bytes", access.buffer_range.offset, access.buffer_range.size, whole_buffer);
        }
        if (access.clears) {
            object["clear"] = clear_json(access.clear, resource.image.format);
        }
        return object;
    }

private:
    const GraphDesc& graph_;
    std::vector<std::uint32_t> latest_; ///< version, by resource
};

void put_cost(Json& object, const Costs& costs, std::uint32_t pass) {
    if (pass < costs.of_pass.size()) {
        put_unless(object, "duration_ns", costs.of_pass[pass].mean_ns, std::int64_t{0});
        put_unless(object, "deviation_ns", costs.of_pass[pass].deviation_ns, std::int64_t{0});
    }
}

Json pass_json(const Frame& frame, std::uint32_t index, AccessWriter& accesses) {
    const GraphDesc& graph = frame.graph;
    const PassDesc& pass = graph.passes[index];
    Json object = {{"name", pass.name}, {"kind", name_of(pass.kind)}};
    if (pass.wish != QueueWish::automatic) {
        object["queue"] = json::queue_wishes[static_cast<std::size_t>(pass.wish)];
    }
    for (std::size_t kind = 0; kind < json::queue_kinds.size(); ++kind) {
        if ((pass.forbidden_queues & queue_bit(static_cast<QueueKind>(kind))) != 0) {
            object["not_on"].push_back(json::queue_kinds[kind]);
        }
    }
    if (pass.variant != none) {
        object["variant"] = graph.variants[pass.variant].name;
        object["form"] = graph.variants[pass.variant].forms[pass.form];
    }
    if (pass.point != none) {
        object["point"] = graph.points[pass.point];
    }
    if (pass.has_side_effect) {
        object["side_effect"] = pass.side_effect;
    }
    put_cost(object, frame.costs, index);
    object["accesses"] = Json::array();
    for (std::uint32_t i = pass.first_access; i < pass.first_access + pass.access_count; ++i) {
        object["accesses"].push_back(accesses.write(graph.accesses[i]));
    }
    return object;
}

Json model_json(const Costs& costs) {
    const Costs usual;
    Json object = Json::object();
    put_unless(object, "unknown_pass_ns", costs.unknown_pass_ns, usual.unknown_pass_ns);
    put_unless(object, "cross_queue_ns", costs.cross_queue_ns, usual.cross_queue_ns);
    put_unless(object, "slowdown_permille", costs.slowdown_permille, usual.slowdown_permille);
    put_unless(object, "threshold_ns", costs.threshold_ns, usual.threshold_ns);
    put_unless(object, "threshold_permille", costs.threshold_permille, usual.threshold_permille);
    return object;
}

/// One resource, pass or access a line: as a person would write it.
std::string frame_text(const Json& document) {
    std::string text = "{\n";
    std::size_t keys_left = document.size();
    for (const auto& entry : document.items()) {
        text += "  " + json::dump(entry.key(), -1) + ": ";
        const bool table = entry.value().is_array() && !entry.value().empty() && entry.value()[0].is_object();
        if (!table) {
            text += json::dump(entry.value(), -1);
        } else {
            text += "[\n";
            for (std::size_t i = 0; i < entry.value().size(); ++i) {
                Json row = entry.value()[i];
                Json accesses = Json::array();
                if (row.contains("accesses")) {
                    accesses.swap(row["accesses"]);
                    row.erase("accesses");
                }
                std::string line = json::dump(row, -1);
                if (!accesses.empty()) {
                    line.pop_back();
                    line += ", \"accesses\": [";
                    for (std::size_t k = 0; k < accesses.size(); ++k) {
                        line += (k == 0 ? "\n      " : ",\n      ") + json::dump(accesses[k], -1);
                    }
                    line += "]}";
                }
                text += "    " + line + (i + 1 < entry.value().size() ? ",\n" : "\n");
            }
            text += "  ]";
        }
        text += --keys_left > 0 ? ",\n" : "\n";
    }
    return text + "}\n";
}

} // namespace

std::string frame_to_json(const Frame& frame) {
    const GraphDesc& graph = frame.graph;
    Json document = Json::object();
    put_unless(document, "about", frame.about, std::string());
    document["queues"] = Json::array();
    for (const QueueInfo& queue : frame.topology.queues) {
        document["queues"].push_back(queue_json(queue));
    }
    if (const Json model = model_json(frame.costs); !model.empty()) {
        document["model"] = model;
    }
    put_unless(document, "points", graph.points, {});
    for (const VariantDesc& variant : graph.variants) {
        document["variants"].push_back({{"name", variant.name}, {"forms", variant.forms}});
    }
    document["resources"] = Json::array();
    for (const ResourceDesc& resource : graph.resources) {
        document["resources"].push_back(resource_json(graph, resource));
    }
    document["passes"] = Json::array();
    AccessWriter accesses(graph);
    for (std::uint32_t i = 0; i < graph.passes.size(); ++i) {
        document["passes"].push_back(pass_json(frame, i, accesses));
    }
    return frame_text(document);
}

std::string costs_to_json(const std::string& about, const GraphDesc& graph, const Costs& costs) {
    Json document = {{"about", about}};
    if (const Json model = model_json(costs); !model.empty()) {
        document["model"] = model;
    }
    document["passes"] = Json::object();
    for (std::uint32_t i = 0; i < graph.passes.size(); ++i) {
        Json cost = Json::object();
        put_cost(cost, costs, i);
        if (!cost.empty()) {
            document["passes"][graph.passes[i].name] = cost;
        }
    }
    return json::dump(document, 2) + "\n";
}

} // namespace tyndall::rg
