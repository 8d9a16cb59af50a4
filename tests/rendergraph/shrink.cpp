#include "tests/rendergraph/shrink.hpp"

#include <algorithm>

#include "rendergraph/json.hpp"
#include "rendergraph/verify.hpp"

namespace tyndall::rg::test {
namespace {

/// Versions without gaps, each naming the same content as before.
void renumber_versions(GraphDesc& graph) {
    for (std::uint32_t r = 0; r < graph.resources.size(); ++r) {
        std::vector<std::uint32_t> made;
        for (const AccessDesc& access : graph.accesses) {
            if (access.resource == r && is_write(access.direction)) {
                made.push_back(access.version);
            }
        }
        std::sort(made.begin(), made.end());
        for (AccessDesc& access : graph.accesses) {
            if (access.resource == r) {
                const auto up_to = std::upper_bound(made.begin(), made.end(), access.version);
                access.version = static_cast<std::uint32_t>(up_to - made.begin());
            }
        }
    }
}

/// The frame without some accesses, passes and resources; what is left is numbered anew.
AnyFrame without(const AnyFrame& frame, const std::vector<bool>& drop_pass, const std::vector<bool>& drop_access) {
    AnyFrame out = frame;
    out.graph.passes.clear();
    out.graph.accesses.clear();
    out.costs.of_pass.clear();
    for (std::uint32_t p = 0; p < frame.graph.passes.size(); ++p) {
        if (drop_pass[p]) {
            continue;
        }
        PassDesc pass = frame.graph.passes[p];
        const std::uint32_t first = pass.first_access;
        const std::uint32_t end = first + pass.access_count;
        pass.first_access = static_cast<std::uint32_t>(out.graph.accesses.size());
        for (std::uint32_t i = first; i < end; ++i) {
            if (!drop_access[i]) {
                out.graph.accesses.push_back(frame.graph.accesses[i]);
                out.graph.accesses.back().pass = static_cast<std::uint32_t>(out.graph.passes.size());
            }
        }
        pass.access_count = static_cast<std::uint32_t>(out.graph.accesses.size()) - pass.first_access;
        out.graph.passes.push_back(std::move(pass));
        if (p < frame.costs.of_pass.size()) {
            out.costs.of_pass.push_back(frame.costs.of_pass[p]);
        }
    }
    renumber_versions(out.graph);
    return out;
}

AnyFrame without_resource(const AnyFrame& frame, std::uint32_t resource) {
    AnyFrame out = frame;
    GraphDesc& graph = out.graph;
    const std::uint32_t current = graph.resources[resource].history_of;
    if (current != none) {
        graph.resources[current].has_history = false;
    }
    if (const std::uint32_t import = graph.resources[resource].import; import != none) {
        graph.imports.erase(graph.imports.begin() + import);
        for (ResourceDesc& other : graph.resources) {
            other.import -= other.import != none && other.import > import ? 1U : 0U;
        }
    }
    graph.resources.erase(graph.resources.begin() + resource);
    for (ResourceDesc& other : graph.resources) {
        other.history_of -= other.history_of != none && other.history_of > resource ? 1U : 0U;
    }
    for (AccessDesc& access : graph.accesses) {
        access.resource -= access.resource > resource ? 1U : 0U;
    }
    return out;
}

/// One form of a variant as if it had no others.
AnyFrame with_form(const AnyFrame& frame, std::uint32_t variant, std::uint32_t form) {
    std::vector<bool> drop(frame.graph.passes.size(), false);
    for (std::size_t p = 0; p < drop.size(); ++p) {
        drop[p] = frame.graph.passes[p].variant == variant && frame.graph.passes[p].form != form;
    }
    AnyFrame out = without(frame, drop, std::vector<bool>(frame.graph.accesses.size(), false));
    out.graph.variants.erase(out.graph.variants.begin() + variant);
    for (PassDesc& pass : out.graph.passes) {
        if (pass.variant == variant) {
            pass.variant = none;
            pass.form = 0;
        } else if (pass.variant != none && pass.variant > variant) {
            --pass.variant;
        }
    }
    return out;
}

class Shrinker {
public:
    Shrinker(AnyFrame frame, const Shows& shows) : frame_(std::move(frame)), shows_(shows) {}

    AnyFrame run() {
        for (bool smaller = true; smaller;) {
            smaller = drop_many(&AnyFrameParts::passes);
            smaller = drop_many(&AnyFrameParts::accesses) || smaller;
            smaller = drop_resources() || smaller;
            smaller = simplify() || smaller;
        }
        return std::move(frame_);
    }

private:
    /// Which of the frame's parts a search for chunks goes through.
    struct AnyFrameParts {
        static std::size_t passes(const AnyFrame& frame) { return frame.graph.passes.size(); }
        static std::size_t accesses(const AnyFrame& frame) { return frame.graph.accesses.size(); }
    };
    using Count = std::size_t (*)(const AnyFrame&);

    bool keep_if_it_shows(AnyFrame&& candidate) {
        if (!shows_(candidate)) {
            return false;
        }
        frame_ = std::move(candidate);
        return true;
    }

    /// Zeller and Hildebrandt 2002: ever smaller chunks, from the end.
    bool drop_many(Count count) {
        bool smaller = false;
        for (std::size_t chunk = std::max<std::size_t>(count(frame_) / 2, 1); chunk > 0; chunk /= 2) {
            for (std::size_t end = count(frame_); end > 0; end -= std::min(end, chunk)) {
                const std::size_t begin = end - std::min(end, chunk);
                std::vector<bool> passes(frame_.graph.passes.size(), false);
                std::vector<bool> accesses(frame_.graph.accesses.size(), false);
                std::vector<bool>& dropped = count == &AnyFrameParts::passes ? passes : accesses;
                std::fill(dropped.begin() + static_cast<std::ptrdiff_t>(begin),
                          dropped.begin() + static_cast<std::ptrdiff_t>(end), true);
                smaller = keep_if_it_shows(without(frame_, passes, accesses)) || smaller;
                end = std::min(end, count(frame_) + (end - begin));
            }
        }
        return smaller;
    }

    bool drop_resources() {
        bool smaller = false;
        for (std::uint32_t r = static_cast<std::uint32_t>(frame_.graph.resources.size()); r-- > 0;) {
            const bool used = std::any_of(frame_.graph.accesses.begin(), frame_.graph.accesses.end(),
                                          [&](const AccessDesc& a) { return a.resource == r; });
            if (!used && !frame_.graph.resources[r].has_history) {
                smaller = keep_if_it_shows(without_resource(frame_, r)) || smaller;
            }
        }
        return smaller;
    }

    /// A change that is kept if the frame still shows it, and if it is one.
    template <typename F>
    bool change(F&& f) {
        AnyFrame candidate = frame_;
        f(candidate);
        return as_json(candidate, "") != as_json(frame_, "") && keep_if_it_shows(std::move(candidate));
    }

    bool simplify() {
        bool smaller = false;
        const auto attempt = [&](auto&& f) { smaller = change(f) || smaller; };
        for (std::uint32_t v = static_cast<std::uint32_t>(frame_.graph.variants.size()); v-- > 0;) {
            for (std::uint32_t form = 0; form < 2 && v < frame_.graph.variants.size(); ++form) {
                attempt([&](AnyFrame& f) { f = with_form(f, v, form); });
            }
        }
        while (frame_.topology.queues.size() > 1 && change([](AnyFrame& f) { f.topology.queues.pop_back(); })) {
            smaller = true;
        }
        for (std::size_t q = 1; q < frame_.topology.queues.size(); ++q) {
            attempt([&](AnyFrame& f) { f.topology.queues[q].family = 0; });
        }
        attempt([](AnyFrame& f) { f.costs = Costs{}; });
        for (std::size_t p = 0; p < frame_.graph.passes.size(); ++p) {
            attempt([&](AnyFrame& f) { f.graph.passes[p].wish = QueueWish::automatic; });
            attempt([&](AnyFrame& f) { f.graph.passes[p].has_side_effect = false; });
            attempt([&](AnyFrame& f) { f.graph.passes[p].kind = PassKind::compute; });
        }
        for (std::size_t i = 0; i < frame_.graph.accesses.size(); ++i) {
            attempt([&](AnyFrame& f) { f.graph.accesses[i].image_range = {}; });
            attempt([&](AnyFrame& f) { f.graph.accesses[i].buffer_range = {}; });
            attempt([&](AnyFrame& f) { f.graph.accesses[i].clears = false; });
            attempt([&](AnyFrame& f) { f.graph.accesses[i].access = Access::storage_compute; });
        }
        for (std::size_t r = 0; r < frame_.graph.resources.size(); ++r) {
            simplify_resource(r, attempt);
        }
        return smaller;
    }

    template <typename Attempt>
    void simplify_resource(std::size_t r, Attempt& attempt) {
        attempt([&](AnyFrame& f) { f.graph.resources[r].concurrent = false; });
        if (frame_.graph.resources[r].history_of == none && !frame_.graph.resources[r].has_history) {
            attempt([&](AnyFrame& f) { f.graph.resources[r].image.mips = 1; });
            attempt([&](AnyFrame& f) { f.graph.resources[r].image.layers = 1; });
            attempt([&](AnyFrame& f) { f.graph.resources[r].buffer.size_bytes = 256; });
            attempt([&](AnyFrame& f) {
                f.graph.resources[r].image.type = VK_IMAGE_TYPE_2D;
                f.graph.resources[r].image.extent = {16, 16, 1};
            });
        }
        if (frame_.graph.resources[r].import == none) {
            return;
        }
        const auto import = [r](AnyFrame& f) -> ImportDesc& { return f.graph.imports[f.graph.resources[r].import]; };
        attempt([&](AnyFrame& f) { import(f).waits_semaphore = false; });
        attempt([&](AnyFrame& f) { import(f).signals_semaphore = false; });
        attempt([&](AnyFrame& f) { import(f).initial_family = VK_QUEUE_FAMILY_IGNORED; });
        attempt([&](AnyFrame& f) { import(f).final_family = VK_QUEUE_FAMILY_IGNORED; });
        attempt([&](AnyFrame& f) {
            import(f).initial_stages = 0;
            import(f).initial_access = 0;
        });
        attempt([&](AnyFrame& f) {
            import(f).final_stages = 0;
            import(f).final_access = 0;
        });
    }

    AnyFrame frame_;
    const Shows& shows_;
};

} // namespace

AnyFrame shrunk(AnyFrame frame, const Shows& shows) {
    return Shrinker(std::move(frame), shows).run();
}

std::string small_failure(const AnyFrame& frame, const CompileOptions& options) {
    const auto reason = [&](const AnyFrame& f) {
        const auto plan = plan_of(f, options);
        if (!plan.has_value()) {
            return "compile refuses it: " + std::to_string(static_cast<int>(plan.error().front().code));
        }
        const std::vector<Violation> found = verify(f.graph, *plan);
        return found.empty() ? std::string() : "the checker refuses it: " + std::string(name_of(found.front().code));
    };
    const std::string wanted = reason(frame);
    return as_json(shrunk(frame, [&](const AnyFrame& f) { return reason(f) == wanted; }), wanted);
}

std::string as_json(const AnyFrame& frame, const std::string& about) {
    return frame_to_json({about, frame.graph, frame.topology, frame.costs});
}

} // namespace tyndall::rg::test
