#include "rendergraph/injection.hpp"

#include <algorithm>

namespace tyndall::rg {
namespace {

std::optional<std::uint32_t> index_of(const std::vector<std::string>& names, std::string_view name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
        return std::nullopt;
    }
    return static_cast<std::uint32_t>(found - names.begin());
}

} // namespace

InjectionPoints::InjectionPoints(std::vector<std::string> names) : names_(std::move(names)) {}

std::optional<Diagnostic> InjectionPoints::add(std::string_view point, int priority, Declare declare,
                                               std::source_location where) {
    const std::optional<std::uint32_t> index = index_of(names_, point);
    if (!index) {
        std::string known;
        for (const std::string& name : names_) {
            known += (known.empty() ? "" : ", ") + name;
        }
        return Diagnostic{.code = DiagnosticCode::unknown_injection_point,
                          .message = "The host has no injection point '" + std::string(point) + "'; it offers " + known,
                          .where = where,
                          .other_where = where};
    }
    const auto before = [](const Registration& a, const Registration& b) {
        return a.point != b.point ? a.point < b.point : a.priority < b.priority;
    };
    Registration registration{*index, priority, std::move(declare)};
    registrations_.insert(std::upper_bound(registrations_.begin(), registrations_.end(), registration, before),
                          std::move(registration));
    return std::nullopt;
}

void InjectionPoints::begin_frame(GraphBuilder& graph) const {
    graph.set_injection_points(names_);
}

void InjectionPoints::visit(std::string_view point, GraphBuilder& graph, Blackboard& blackboard, const Declare& own,
                            std::source_location where) const {
    const std::optional<std::uint32_t> index = index_of(names_, point);
    if (!index) {
        graph.report({.code = DiagnosticCode::unknown_injection_point,
                      .message = "The host visits '" + std::string(point) + "', which it did not list",
                      .where = where,
                      .other_where = where});
        return;
    }
    graph.begin_injection_point(*index);
    for (const Registration& registration : registrations_) {
        if (registration.point == *index) {
            registration.declare(graph, blackboard);
        }
    }
    if (own) {
        own(graph, blackboard);
    }
    graph.end_injection_point();
}

} // namespace tyndall::rg
