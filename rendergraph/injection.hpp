// Injection points: an ordered, named list that a host offers, at which features declare their passes. A point decides
// which versions of the frame's resources a feature sees; when its passes run is decided by the scheduler alone.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rendergraph/blackboard.hpp"
#include "rendergraph/graph.hpp"

namespace tyndall::rg {

class InjectionPoints {
public:
    using Declare = std::function<void(GraphBuilder&, Blackboard&)>;

    /// Names in the order in which the host visits them, each once.
    explicit InjectionPoints(std::vector<std::string> names);

    /// `declare` runs each time that the host reaches `point`. Lower priorities first, equal ones as registered.
    /// Returns the diagnostic when the host has no such point.
    [[nodiscard]] std::optional<Diagnostic> add(std::string_view point, int priority, Declare declare,
                                                std::source_location where = std::source_location::current());

    /// Tells `graph` the names, so that its passes can record where they were declared.
    void begin_frame(GraphBuilder& graph) const;

    /// Runs what is registered at `point`, then `own`, the host's own passes there (priority 0 among the rest is
    /// obtained by registering them instead).
    void visit(std::string_view point, GraphBuilder& graph, Blackboard& blackboard, const Declare& own = {},
               std::source_location where = std::source_location::current()) const;

    [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

private:
    struct Registration {
        std::uint32_t point;
        int priority;
        Declare declare;
    };
    std::vector<std::string> names_;
    std::vector<Registration> registrations_; ///< sorted by point, then priority, stable
};

} // namespace tyndall::rg
