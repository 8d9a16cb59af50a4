// The data flow, from versions alone.
// In: a graph whose handles and ranges are sound. Out: edges between passes, by hazard. Invariant: an order that
// respects all edges gives every read the content of the version that it names. O(accesses x cells of each).
#include <algorithm>
#include <tuple>

#include "rendergraph/stages.hpp"

namespace tyndall::rg::stages {
namespace {

struct CellState {
    std::uint32_t writer = none;             ///< access
    std::vector<std::uint32_t> readers = {}; ///< accesses since then
};

std::string quoted(const std::string& name) {
    return "'" + name + "'";
}

class Follower {
public:
    Follower(const GraphDesc& graph, const Cells& cells, const std::vector<bool>* kept)
        : graph_(graph), cells_(cells), kept_(kept) {}

    Flow run() {
        std::vector<std::vector<std::uint32_t>> by_resource(graph_.resources.size());
        for (std::uint32_t i = 0; i < graph_.accesses.size(); ++i) {
            if (kept_ == nullptr || (*kept_)[graph_.accesses[i].pass]) {
                by_resource[graph_.accesses[i].resource].push_back(i);
            }
        }
        for (std::uint32_t resource = 0; resource < by_resource.size(); ++resource) {
            follow(resource, by_resource[resource]);
        }
        std::sort(flow_.edges.begin(), flow_.edges.end(), [](const Edge& a, const Edge& b) {
            return std::tie(a.to, a.from, a.hazard, a.resource) < std::tie(b.to, b.from, b.hazard, b.resource);
        });
        // One edge a pair is enough for order; the first data edge of a pair is enough for reachability.
        const auto same = [](const Edge& a, const Edge& b) {
            return a.to == b.to && a.from == b.from &&
                   (a.hazard == Hazard::read_after_write) == (b.hazard == Hazard::read_after_write);
        };
        flow_.edges.erase(std::unique(flow_.edges.begin(), flow_.edges.end(), same), flow_.edges.end());
        return std::move(flow_);
    }

private:
    void follow(std::uint32_t resource, std::vector<std::uint32_t>& accesses) {
        // In order of content: the write that makes version v, then the reads of v, then the write that makes v + 1.
        const auto key = [&](std::uint32_t i) {
            const AccessDesc& a = graph_.accesses[i];
            return 2 * std::uint64_t{a.version} + (is_write(a.direction) ? 0 : 1);
        };
        std::stable_sort(accesses.begin(), accesses.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
        report_two_writers(resource, accesses);

        states_.assign(cells_.of_resource[resource].count(), CellState{});
        for (const std::uint32_t i : accesses) {
            visit(resource, i);
        }
        const ResourceDesc& desc = graph_.resources[resource];
        const bool survives = desc.has_history || (desc.import != none && graph_.imports[desc.import].has_final);
        if (survives) {
            for (const CellState& state : states_) {
                if (state.writer != none) {
                    flow_.last_writers.push_back(graph_.accesses[state.writer].pass);
                    flow_.last_writer_resource.push_back(resource);
                }
            }
        }
    }

    void visit(std::uint32_t resource, std::uint32_t index) {
        const AccessDesc& access = graph_.accesses[index];
        const bool starts_with_content = graph_.resources[resource].lifetime != ResourceLifetime::transient;
        bool unwritten = false;
        for_each_cell(cells_.of_resource[resource], cells_.of_access[index], [&](std::uint32_t cell) {
            CellState& state = states_[cell];
            if (is_read(access.direction)) {
                unwritten = unwritten || (state.writer == none && !starts_with_content);
                if (state.writer != none) {
                    add(state.writer, index, Hazard::read_after_write);
                }
            }
            if (is_write(access.direction)) {
                for (const std::uint32_t reader : state.readers) {
                    add(reader, index, Hazard::write_after_read);
                }
                if (state.writer != none && !is_read(access.direction)) {
                    add(state.writer, index, Hazard::write_after_write);
                }
                state.writer = index;
                state.readers.clear();
            } else {
                state.readers.push_back(index);
            }
        });
        if (unwritten) {
            const ResourceDesc& desc = graph_.resources[resource];
            const std::string& pass = graph_.passes[access.pass].name;
            flow_.errors.push_back({.code = DiagnosticCode::read_of_unwritten,
                                    .pass = pass,
                                    .resource = desc.name,
                                    .message = "Pass " + quoted(pass) +
                                               (access.direction == Direction::modify ? " modifies " : " reads ") +
                                               quoted(desc.name) +
                                               (cells_.of_resource[resource].whole ? "" : ", parts of") +
                                               (cells_.of_resource[resource].whole ? ", which" : " which") +
                                               " no pass wrote before; let a pass write it, or import it",
                                    .where = access.where,
                                    .other_where = desc.where});
        }
    }

    void add(std::uint32_t from_access, std::uint32_t to_access, Hazard hazard) {
        const std::uint32_t from = graph_.accesses[from_access].pass;
        const std::uint32_t to = graph_.accesses[to_access].pass;
        if (from != to) {
            flow_.edges.push_back({from, to, graph_.accesses[from_access].resource, hazard});
        }
    }

    void report_two_writers(std::uint32_t resource, std::span<const std::uint32_t> accesses) {
        std::uint32_t previous = none;
        for (const std::uint32_t i : accesses) {
            const AccessDesc& access = graph_.accesses[i];
            if (!is_write(access.direction)) {
                continue;
            }
            if (previous != none && graph_.accesses[previous].version == access.version) {
                const AccessDesc& other = graph_.accesses[previous];
                const std::string& name = graph_.resources[resource].name;
                flow_.errors.push_back({.code = DiagnosticCode::two_writers,
                                        .pass = graph_.passes[access.pass].name,
                                        .resource = name,
                                        .message = "Passes " + quoted(graph_.passes[other.pass].name) + " and " +
                                                   quoted(graph_.passes[access.pass].name) + " both write version " +
                                                   std::to_string(access.version) + " of " + quoted(name) +
                                                   "; pass on the handle that the first write returned",
                                        .where = access.where,
                                        .other_where = other.where});
            }
            previous = i;
        }
    }

    const GraphDesc& graph_;
    const Cells& cells_;
    const std::vector<bool>* kept_;
    Flow flow_;
    std::vector<CellState> states_;
};

} // namespace

Flow follow_versions(const GraphDesc& graph, const Cells& cells, const std::vector<bool>* kept) {
    return Follower(graph, cells, kept).run();
}

} // namespace tyndall::rg::stages
