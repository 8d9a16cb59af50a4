// The data flow, from versions alone.
// In: a graph whose handles and ranges are sound. Out: edges between passes, by hazard. Invariant: an order that
// respects all edges gives every read the content of the version that it names. O(accesses x cells of each).
#include <algorithm>
#include <numeric>
#include <tuple>

#include "rendergraph/stages.hpp"

namespace tyndall::rg::stages {
namespace {

struct CellState {
    std::uint32_t writer = none;      ///< access
    std::uint32_t last_reader = none; ///< since then, the head of a list in Follower::readers_
};
struct Reader {
    std::uint32_t access;
    std::uint32_t before; ///< the reader before it, `none` at the end
};

/// Sorts by (to, from, hazard, resource): buckets by `to`, which are small, each sorted. O(edges log edges of a pass).
void sort_edges(Scratch<Edge>& edges, std::size_t pass_count) {
    Scratch<std::uint32_t> next(pass_count + 1, 0);
    for (const Edge& edge : edges) {
        ++next[edge.to + 1];
    }
    std::partial_sum(next.begin(), next.end(), next.begin());
    Scratch<Edge> sorted(edges.size());
    for (const Edge& edge : edges) {
        sorted[next[edge.to]++] = edge;
    }
    std::uint32_t begin = 0;
    for (std::size_t pass = 0; pass < pass_count; ++pass) { // next[pass] is now the end of the pass's bucket
        std::sort(sorted.begin() + begin, sorted.begin() + next[pass], [](const Edge& a, const Edge& b) {
            return std::tie(a.from, a.hazard, a.resource) < std::tie(b.from, b.hazard, b.resource);
        });
        begin = next[pass];
    }
    edges.swap(sorted);
}

std::string quoted(const std::string& name) {
    return "'" + name + "'";
}

class Follower {
public:
    Follower(const GraphDesc& graph, const Cells& cells, const Scratch<bool>* kept)
        : graph_(graph), cells_(cells), kept_(kept) {}

    Flow run() {
        sort_accesses_by_resource();
        flow_.edges.reserve(2 * accesses_.size());
        for (std::uint32_t resource = 0; resource < graph_.resources.size(); ++resource) {
            follow(resource, std::span(accesses_).subspan(first_access_[resource],
                                                          first_access_[resource + 1] - first_access_[resource]));
        }
        sort_edges(flow_.edges, graph_.passes.size());
        // One edge a pair is enough for order; the first data edge of a pair is enough for reachability.
        const auto same = [](const Edge& a, const Edge& b) {
            return a.to == b.to && a.from == b.from &&
                   (a.hazard == Hazard::read_after_write) == (b.hazard == Hazard::read_after_write);
        };
        flow_.edges.erase(std::unique(flow_.edges.begin(), flow_.edges.end(), same), flow_.edges.end());
        return std::move(flow_);
    }

private:
    [[nodiscard]] bool exists(const AccessDesc& access) const { return kept_ == nullptr || (*kept_)[access.pass]; }

    /// Fills accesses_ and first_access_: by resource, in order of declaration.
    void sort_accesses_by_resource() {
        first_access_.assign(graph_.resources.size() + 1, 0);
        for (const AccessDesc& access : graph_.accesses) {
            first_access_[access.resource + 1] += exists(access) ? 1 : 0;
        }
        std::partial_sum(first_access_.begin(), first_access_.end(), first_access_.begin());
        accesses_.resize(first_access_.back());
        Scratch<std::uint32_t> next(first_access_.begin(), first_access_.end() - 1);
        for (std::uint32_t i = 0; i < graph_.accesses.size(); ++i) {
            if (exists(graph_.accesses[i])) {
                accesses_[next[graph_.accesses[i].resource]++] = i;
            }
        }
    }

    void follow(std::uint32_t resource, std::span<std::uint32_t> accesses) {
        // In order of content: the write that makes version v, then the reads of v, then the write that makes v + 1.
        const auto key = [&](std::uint32_t i) {
            const AccessDesc& a = graph_.accesses[i];
            return 2 * std::uint64_t{a.version} + (is_write(a.direction) ? 0 : 1);
        };
        const auto before = [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); };
        if (!std::is_sorted(accesses.begin(), accesses.end(), before)) {
            std::stable_sort(accesses.begin(), accesses.end(), before);
        }
        report_two_writers(resource, accesses);

        states_.assign(cells_.of_resource[resource].count(), CellState{});
        readers_.clear();
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
        const ResourceDesc& desc = graph_.resources[resource];
        const bool imported_undefined = desc.import != none && desc.kind == ResourceKind::image &&
                                        graph_.imports[desc.import].initial_layout == VK_IMAGE_LAYOUT_UNDEFINED;
        const bool starts_with_content = desc.lifetime != ResourceLifetime::transient && !imported_undefined;
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
                for (std::uint32_t i = state.last_reader; i != none; i = readers_[i].before) {
                    add(readers_[i].access, index, Hazard::write_after_read);
                }
                if (state.writer != none && !is_read(access.direction)) {
                    add(state.writer, index, Hazard::write_after_write);
                }
                state.writer = index;
                state.last_reader = none;
            } else {
                readers_.push_back({index, state.last_reader});
                state.last_reader = static_cast<std::uint32_t>(readers_.size() - 1);
            }
        });
        if (unwritten) {
            const std::string& pass = graph_.passes[access.pass].name;
            flow_.errors.push_back(
                {.code = DiagnosticCode::read_of_unwritten,
                 .pass = pass,
                 .resource = desc.name,
                 .message = "Pass " + quoted(pass) +
                            (access.direction == Direction::modify ? " modifies " : " reads ") + quoted(desc.name) +
                            (cells_.of_resource[resource].whole ? "" : ", parts of") +
                            (cells_.of_resource[resource].whole ? ", which" : " which") + " no pass wrote before; " +
                            (imported_undefined ? "let a pass write it, or import it with the layout it comes in"
                                                : "let a pass write it, or import it"),
                 .where = access.where,
                 .other_where = desc.where});
        }
    }

    void add(std::uint32_t from_access, std::uint32_t to_access, Hazard hazard) {
        const std::uint32_t from = graph_.accesses[from_access].pass;
        const std::uint32_t to = graph_.accesses[to_access].pass;
        if (graph_.passes[to].kind == PassKind::host && graph_.passes[from].kind != PassKind::host) {
            report_too_early(from_access, to_access);
        }
        if (from != to) {
            Edge& edge = flow_.edges.emplace_back(); // filled where it lies
            edge.from = from;
            edge.to = to;
            edge.resource = graph_.accesses[from_access].resource;
            edge.hazard = hazard;
        }
    }

    /// Once for an access of the host pass.
    void report_too_early(std::uint32_t from_access, std::uint32_t to_access) {
        const AccessDesc& access = graph_.accesses[to_access];
        const std::string& pass = graph_.passes[access.pass].name;
        const std::string& name = graph_.resources[access.resource].name;
        const Diagnostics& known = flow_.errors;
        if (!known.empty() && known.back().code == DiagnosticCode::host_too_early && known.back().pass == pass &&
            known.back().resource == name) {
            return;
        }
        const AccessDesc& before = graph_.accesses[from_access];
        flow_.errors.push_back({.code = DiagnosticCode::host_too_early,
                                .pass = pass,
                                .resource = name,
                                .message = "Pass " + quoted(pass) +
                                           " runs on the host while the frame is recorded, but " +
                                           quoted(graph_.passes[before.pass].name) + " must have " +
                                           (is_write(before.direction) ? "written " : "read ") + quoted(name) +
                                           " before it; let the frame leave it to the host and use it when the frame "
                                           "is done",
                                .where = access.where,
                                .other_where = before.where});
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
    const Scratch<bool>* kept_;
    Flow flow_;
    Scratch<std::uint32_t> accesses_;     ///< indices by resource
    Scratch<std::uint32_t> first_access_; ///< by resource, resources + 1 entries into accesses_
    Scratch<CellState> states_;           ///< of the resource at hand, by cell
    Scratch<Reader> readers_;             ///< of the resource at hand
};

} // namespace

Flow follow_versions(const GraphDesc& graph, const Cells& cells, const Scratch<bool>* kept) {
    return Follower(graph, cells, kept).run();
}

} // namespace tyndall::rg::stages
