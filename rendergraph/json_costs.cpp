// Reading costs, in a frame's file or in one of their own.
#include <algorithm>

#include "rendergraph/json.hpp"
#include "rendergraph/json_frame_types.hpp"

namespace tyndall::rg {

void json::read_model(ObjectReader& from, Costs& costs) {
    const Json* value = from.find("model");
    if (value == nullptr) {
        return;
    }
    Diagnostics& mistakes = from.mistakes();
    ObjectReader model(*value, {"The cost model"}, mistakes);
    model.number("unknown_pass_ns", costs.unknown_pass_ns, 1, longest_pass_ns);
    model.number("cross_queue_ns", costs.cross_queue_ns, 0, longest_pass_ns);
    model.number("slowdown_permille", costs.slowdown_permille, 1'000, 10'000);
    model.number("threshold_ns", costs.threshold_ns, 0, longest_pass_ns);
    model.number("threshold_permille", costs.threshold_permille, 0, 1'000);
    model.finish();
}

tl::expected<NamedCosts, Diagnostics> costs_from_json(std::string_view text, const GraphDesc& graph,
                                                      const Costs& base) {
    tl::expected<json::Json, Diagnostics> document = json::parse_document(text);
    if (!document) {
        return tl::unexpected(std::move(document.error()));
    }
    NamedCosts named{.costs = base};
    Diagnostics mistakes;
    json::ObjectReader root(*document, {"The costs file"}, mistakes);
    root.text("about", named.about);
    json::read_model(root, named.costs);
    const json::Json* passes = root.find("passes");
    if (passes == nullptr || !passes->is_object()) {
        root.complain("needs an object as 'passes'");
        return tl::unexpected(std::move(mistakes));
    }
    named.costs.of_pass.resize(graph.passes.size());
    for (const auto& entry : passes->items()) {
        const auto at = std::find_if(graph.passes.begin(), graph.passes.end(),
                                     [&](const PassDesc& pass) { return pass.name == entry.key(); });
        json::ObjectReader reader(entry.value(), {"The cost of " + json::in_quotes(entry.key()), entry.key()},
                                  mistakes);
        PassCost cost;
        reader.number("duration_ns", cost.mean_ns, 0, json::longest_pass_ns);
        reader.number("deviation_ns", cost.deviation_ns, 0, json::longest_pass_ns);
        reader.finish();
        if (at == graph.passes.end()) {
            named.without_pass.push_back(entry.key());
        } else {
            named.costs.of_pass[static_cast<std::size_t>(at - graph.passes.begin())] = cost;
        }
    }
    root.finish();
    if (!mistakes.empty()) {
        return tl::unexpected(std::move(mistakes));
    }
    return named;
}

} // namespace tyndall::rg
