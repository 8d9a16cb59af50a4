// tyndall schedule: a frame in a file, its plan explained. Nothing here touches a device.
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "rendergraph/compile.hpp"
#include "rendergraph/explain.hpp"
#include "rendergraph/json.hpp"
#include "rendergraph/optimality.hpp"
#include "rendergraph/refine.hpp"
#include "rendergraph/report.hpp"
#include "rendergraph/verify.hpp"
#include "samples/tyndall/arguments.hpp"

namespace tyndall::samples {
namespace {

/// Lines for the user, all of them mistakes in what was given.
using Mistakes = std::vector<std::string>;
template <typename T>
using Expected = tl::expected<T, Mistakes>;

tl::unexpected<Mistakes> mistake(std::string line) {
    return tl::unexpected(Mistakes{std::move(line)});
}
tl::unexpected<Mistakes> mistakes_in(const std::filesystem::path& file, const rg::Diagnostics& diagnostics) {
    Mistakes lines;
    for (const rg::Diagnostic& diagnostic : diagnostics) {
        lines.push_back(file.string() + ": " + rg::to_text(diagnostic));
    }
    return tl::unexpected(std::move(lines));
}

Expected<std::string> read_text(const std::filesystem::path& path) {
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) {
        return mistake("Cannot read '" + path.string() + "': it is a folder");
    }
    std::ifstream file(path, std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    if (!file) {
        return mistake("Cannot read '" + path.string() + "'");
    }
    return text.str();
}

Expected<void> write_text(const std::filesystem::path& path, const std::string& text) {
    std::ofstream file(path, std::ios::binary);
    file << text;
    file.close();
    if (!file) {
        return mistake("Cannot write '" + path.string() + "'");
    }
    return {};
}

struct Switch {
    const char* name;
    void (*turn_off)(rg::CompileOptions&);
};
constexpr Switch compile_switches[] = {
    {"serial", [](rg::CompileOptions& options) { options.async = false; }},
    {"no-aliasing", [](rg::CompileOptions& options) { options.aliasing = false; }},
    {"full-barriers", [](rg::CompileOptions& options) { options.full_barriers = true; }},
    {"no-reordering", [](rg::CompileOptions& options) { options.reordering = false; }},
    {"no-culling", [](rg::CompileOptions& options) { options.culling = false; }},
};
/// Filling transients with garbage is a switch of the executor: a plan is the same with it.
constexpr const char* poison_switch = "poison";
/// Takes the plan that a frame has time for.
constexpr const char* no_refinement_switch = "no-refinement";

/// "compute", or "compute:2" for family 2. A queue of the graphics queue's family can do all that this one can.
std::optional<rg::QueueInfo> parse_queue(std::string_view text, rg::QueueKind kind, const rg::QueueTopology& own,
                                         const rg::QueueTopology& so_far) {
    const std::size_t colon = text.find(':');
    if (text.substr(0, colon) != rg::name_of(kind)) {
        return std::nullopt;
    }
    const auto declared = std::find_if(own.queues.begin(), own.queues.end(),
                                       [&](const rg::QueueInfo& queue) { return queue.kind == kind; });
    rg::QueueInfo queue = declared == own.queues.end() ? rg::usual_queue(kind) : *declared;
    if (colon == std::string_view::npos) {
        return queue;
    }
    const std::string_view digits = text.substr(colon + 1);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), queue.family);
    if (error != std::errc{} || end != digits.data() + digits.size()) {
        return std::nullopt;
    }
    if (!so_far.queues.empty() && so_far.queues.front().family == queue.family) {
        queue.capabilities = so_far.queues.front().capabilities;
    }
    return queue;
}

Expected<rg::QueueTopology> topology_of(const ScheduleArguments& arguments, const rg::QueueTopology& own) {
    if (!arguments.queues) {
        return own;
    }
    constexpr rg::QueueKind kinds[] = {rg::QueueKind::graphics, rg::QueueKind::compute, rg::QueueKind::transfer};
    rg::QueueTopology topology{{}};
    std::stringstream list(*arguments.queues +
                           (arguments.queues->ends_with(',') ? "," : "")); // nothing is an entry too
    for (std::string text; std::getline(list, text, ',');) {
        const std::size_t at = topology.queues.size();
        const std::optional<rg::QueueInfo> queue =
            at < std::size(kinds) ? parse_queue(text, kinds[at], own, topology) : std::nullopt;
        if (!queue) {
            return mistake("--queues must be graphics, graphics,compute or graphics,compute,transfer, each with "
                           ":FAMILY if need be, not '" +
                           *arguments.queues + "'");
        }
        topology.queues.push_back(*queue);
    }
    if (topology.queues.empty()) {
        return mistake("--queues must name at least graphics");
    }
    return topology;
}

Expected<rg::Frame> load_frame(const ScheduleArguments& arguments) {
    const Expected<std::string> text = read_text(arguments.frame);
    if (!text) {
        return tl::unexpected(text.error());
    }
    tl::expected<rg::Frame, rg::Diagnostics> frame = rg::frame_from_json(*text);
    if (!frame) {
        return mistakes_in(arguments.frame, frame.error());
    }
    Expected<rg::QueueTopology> topology = topology_of(arguments, frame->topology);
    if (!topology) {
        return tl::unexpected(topology.error());
    }
    frame->topology = std::move(*topology);
    if (arguments.costs) {
        const Expected<std::string> costs_text = read_text(*arguments.costs);
        if (!costs_text) {
            return tl::unexpected(costs_text.error());
        }
        const auto costs = rg::costs_from_json(*costs_text, frame->graph, frame->costs);
        if (!costs) {
            return mistakes_in(*arguments.costs, costs.error());
        }
        frame->costs = costs->costs;
        // The durations are no longer those that the frame speaks of.
        const char* const separator = frame->about.empty() ? "" : frame->about.ends_with('.') ? " " : ". ";
        frame->about += separator + std::string("Here with other durations: ") + costs->about;
        for (const std::string& name : costs->without_pass) {
            std::fprintf(stderr, "note: the costs of '%s' are not used, the frame has no such pass\n", name.c_str());
        }
    }
    return std::move(*frame);
}

Expected<rg::Plan> plan_for(const ScheduleArguments& arguments, const rg::Frame& frame) {
    if (arguments.plan) {
        const Expected<std::string> text = read_text(*arguments.plan);
        if (!text) {
            return tl::unexpected(text.error());
        }
        tl::expected<rg::Plan, rg::Diagnostics> plan = rg::plan_from_json(*text, frame.graph);
        if (!plan) {
            return mistakes_in(*arguments.plan, plan.error());
        }
        return std::move(*plan);
    }
    rg::CompileOptions options;
    bool refined = true;
    for (const std::string& name : arguments.switches) {
        for (const Switch& one : compile_switches) {
            if (name == one.name) {
                one.turn_off(options);
            }
        }
        refined = refined && name != no_refinement_switch;
        if (name == poison_switch) {
            std::fprintf(
                stderr,
                "note: poison acts when a frame is executed, as by tyndall render --poison; the plan is the same "
                "with it\n");
        }
    }
    const rg::MemoryRequirements memory = rg::estimate_memory(frame.graph);
    if (!refined) {
        tl::expected<rg::Plan, rg::Diagnostics> plan =
            rg::compile(frame.graph, frame.topology, memory, options, frame.costs);
        if (!plan) {
            return mistakes_in(arguments.frame, plan.error());
        }
        return std::move(*plan);
    }
    tl::expected<rg::Refined, rg::Diagnostics> better =
        rg::refine(frame.graph, frame.topology, memory, options, frame.costs);
    if (!better) {
        return mistakes_in(arguments.frame, better.error());
    }
    if (better->steps > 0) {
        std::fprintf(stderr, "note: searched %llu steps: %s\n", static_cast<unsigned long long>(better->steps),
                     better->shortest ? "no schedule is shorter" : "a shorter schedule may exist");
    }
    return std::move(better->plan);
}

Expected<void> check_outputs(const ScheduleArguments& arguments) {
    for (const std::filesystem::path& path : arguments.outputs) {
        const std::filesystem::path kind = path.extension();
        if (kind != ".txt" && kind != ".json" && kind != ".dot" && kind != ".html") {
            return mistake("--out '" + path.string() + "' must end in .txt, .json, .dot or .html");
        }
        std::error_code error;
        if (path.has_parent_path() && !std::filesystem::is_directory(path.parent_path(), error)) {
            return mistake("Cannot write '" + path.string() + "': there is no such folder");
        }
    }
    return {};
}

std::vector<rg::PassDuration> durations_of(const rg::Timeline& timeline) {
    constexpr double ns_per_ms = 1e6;
    std::vector<rg::PassDuration> durations;
    for (const rg::TimelinePass& pass : timeline.passes) {
        durations.push_back({pass.pass, static_cast<double>(pass.end_ns - pass.start_ns) / ns_per_ms});
    }
    return durations;
}

Expected<void> write_outputs(const ScheduleArguments& arguments, const rg::Frame& frame, const rg::Plan& plan,
                             const rg::Timeline& timeline, const std::string& report) {
    for (const std::filesystem::path& path : arguments.outputs) {
        const std::string kind = path.extension().string();
        const std::string text = kind == ".txt"    ? report
                                 : kind == ".json" ? rg::plan_to_json(frame.graph, plan)
                                 : kind == ".dot"  ? rg::to_dot(frame.graph, plan)
                                                   : rg::to_html(arguments.frame.stem().string(), frame.about,
                                                                 frame.graph, plan, frame.costs);
        if (Expected<void> written = write_text(path, text); !written) {
            return written;
        }
    }
    return arguments.trace ? write_text(*arguments.trace, rg::to_trace(frame.graph, plan, timeline)) : Expected<void>{};
}

/// The exit code: a plan that is not free of races fails.
int print_violations(const rg::Frame& frame, const rg::Plan& plan) {
    const std::vector<rg::Violation> violations = rg::verify(frame.graph, plan);
    for (const rg::Violation& violation : violations) {
        std::fprintf(stderr, "tyndall: %s: %s\n", std::string(rg::name_of(violation.code)).c_str(),
                     violation.message.c_str());
    }
    if (violations.empty()) {
        std::printf("verified: %zu passes on %zu queues, free of races\n", plan.passes.size(),
                    plan.topology.queues.size());
    }
    return violations.empty() ? exit_ok : exit_failed;
}

Expected<int> schedule(const ScheduleArguments& arguments) {
    if (Expected<void> checked = check_outputs(arguments); !checked) {
        return tl::unexpected(checked.error());
    }
    Expected<rg::Frame> frame = load_frame(arguments);
    if (!frame) {
        return tl::unexpected(frame.error());
    }
    const Expected<rg::Plan> plan = plan_for(arguments, *frame);
    if (!plan) {
        return tl::unexpected(plan.error());
    }
    const rg::Timeline timeline = rg::simulate(frame->graph, *plan, frame->costs);
    const std::string report = rg::explain_table(frame->graph, *plan, durations_of(timeline)) +
                               rg::to_text(rg::optimality(frame->graph, *plan, timeline));
    if (Expected<void> written = write_outputs(arguments, *frame, *plan, timeline, report); !written) {
        return tl::unexpected(written.error());
    }
    std::fputs((arguments.json ? rg::plan_to_json(frame->graph, *plan) : report).c_str(), stdout);
    return arguments.verify ? print_violations(*frame, *plan) : exit_ok;
}

} // namespace

std::vector<std::string> schedule_switches() {
    std::vector<std::string> names;
    for (const Switch& one : compile_switches) {
        names.emplace_back(one.name);
    }
    names.emplace_back(poison_switch);
    names.emplace_back(no_refinement_switch);
    return names;
}

int run_schedule(const ScheduleArguments& arguments) {
    const Expected<int> code = schedule(arguments);
    if (!code) {
        for (const std::string& line : code.error()) {
            std::fprintf(stderr, "tyndall: %s\n", line.c_str());
        }
        return exit_bad_input;
    }
    return *code;
}

} // namespace tyndall::samples
