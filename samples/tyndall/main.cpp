// The tool `tyndall`: one executable, one subcommand a use.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <optional>
#include <span>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "samples/precision/choice.hpp"
#include "samples/precision/orders.hpp"
#include "samples/tyndall/arguments.hpp"
#include "samples/tyndall/precision_report.hpp"

namespace {

using namespace tyndall;
using namespace tyndall::samples;

int bad_input(const std::string& sentence) {
    std::fprintf(stderr, "tyndall: %s\n", sentence.c_str());
    return exit_bad_input;
}

void add_schedule_options(CLI::App& command, ScheduleArguments& schedule) {
    command.add_option("frame", schedule.frame, "frame description (docs/frame.md)")->required();
    command.add_option("--queues", schedule.queues,
                       "graphics[,compute[,transfer]], each with :FAMILY if need be; without it, the frame's own");
    command.add_option("--costs", schedule.costs, "durations of passes; without it, the frame's own");
    command.add_option("--plan", schedule.plan, "a plan that --out FILE.json wrote: explained instead of a new one");
    command.add_option("--switch", schedule.switches, "turn one thing off; may be given several times")
        ->check(CLI::IsMember(schedule_switches()))
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    command
        .add_option("--out", schedule.outputs,
                    "report (.txt, .html), plan (.json) or graph (.dot) to write; may be "
                    "given several times")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    command.add_option("--trace", schedule.trace, "timeline to write, for Perfetto or chrome://tracing");
    command.add_flag("--verify", schedule.verify, "prove the plan free of races, or list where it is not");
    command.add_flag("--json", schedule.json, "print the plan as JSON instead of the report");
}

/// What CLI11 cannot parse by itself.
struct PrecisionTexts {
    std::string size = "320x180";
    std::vector<std::string> integrators;
    std::vector<std::string> visibilities;
    std::vector<std::string> grids;
    std::optional<std::string> error;
    std::optional<std::string> budget;
};

std::vector<std::string> texts_of(std::span<const char* const> names) {
    return {names.begin(), names.end()};
}

/// The values whose names are given; every name is one of `names`, which lie in the values' order.
template <typename Enum>
std::vector<Enum> values_of(const std::vector<std::string>& given, std::span<const char* const> names) {
    std::vector<Enum> values;
    for (const std::string& name : given) {
        values.push_back(static_cast<Enum>(std::find(names.begin(), names.end(), name) - names.begin()));
    }
    return values;
}

void add_precision_options(CLI::App& command, PrecisionArguments& precision, PrecisionTexts& texts) {
    std::vector<std::string> scenes = precision_scene_names();
    scenes.insert(scenes.end(), {"file", "all"});
    command.add_option("--scene", precision.scene, "scene to measure")
        ->check(CLI::IsMember(scenes))
        ->capture_default_str();
    command.add_option("--file", precision.file, "a glTF scene, its fog beside it, to measure with the others");
    command.add_option("--size", texts.size, "WIDTHxHEIGHT in pixels")->capture_default_str();
    command.add_option("--frames", precision.frames, "jittered frames; the first and the last are judged")
        ->check(CLI::Range(2U, 10000U))
        ->capture_default_str();
    command.add_option("--integrator", texts.integrators, "integrators to measure, a comma between them")
        ->check(CLI::IsMember(texts_of(integrator_names)))
        ->delimiter(',');
    command.add_option("--visibility", texts.visibilities, "visibilities of the sun, a comma between them")
        ->check(CLI::IsMember(texts_of(visibility_names)))
        ->delimiter(',');
    command.add_option("--grid", texts.grids, "columns of froxels, WIDTHxHEIGHT, a comma between several")
        ->delimiter(',');
    command.add_option("--error", texts.error,
                       "of what is measured choose the cheapest within this relative L2 error (2%), and run it again");
    command.add_option("--budget", texts.budget,
                       "choose the most exact whose fog takes no longer (30ms), and run it again");
    command.add_option("--slices", precision.slices, "numbers of slices, a comma between them")
        ->check(CLI::Range(8U, 512U))
        ->delimiter(',');
    command.add_flag("--sweep", precision.sweep,
                     "measure every integrator, visibility, grid and number of slices of a long ladder; about an hour");
    command.add_flag("--quick", precision.quick, "a sweep over a short ladder; minutes");
    command.add_flag("--causes", precision.causes,
                     "list what error is left when one cause at a time is removed from the first configuration");
    CLI::Option* orders =
        command.add_flag("--orders", precision.orders,
                         "print the integrators' errors over numbers of slices and their orders of convergence only");
    command.add_flag("--airlight", precision.airlight, "make all surfaces black, so that the fog alone is judged");
    command.add_option("--out", precision.folder, "folder for tables, pictures, plots and a page (docs/precision.md)");
    command.add_option("--device", precision.device, "part of a device's name, or its index; see tyndall info");
    command.add_flag("--json", precision.json, "print JSON instead of the table");
    for (CLI::Option* option : command.get_options()) {
        if (option != orders && option != command.get_help_ptr() && !option->check_lname("json") &&
            !option->check_lname("out")) {
            orders->excludes(option);
        }
    }
}

void add_stability_options(CLI::App& command, StabilityArguments& stability) {
    std::vector<std::string> names = stability_case_names();
    names.emplace_back("all");
    command.add_option("--case", stability.name, "what to vary")->check(CLI::IsMember(names))->capture_default_str();
    command.add_flag("--quick", stability.quick, "only the extremes of each case, and fewer frames");
    command.add_option("--out", stability.folder, "folder for stability.csv, stability.json and plots");
    command.add_option("--device", stability.device, "part of a device's name, or its index; see tyndall info");
    command.add_flag("--json", stability.json, "print JSON instead of the table");
}

tl::expected<void, std::string> parse_texts(const PrecisionTexts& texts, PrecisionArguments& precision) {
    const auto take = [](auto parsed, auto& into) -> tl::expected<void, std::string> {
        if (!parsed) {
            return tl::unexpected(parsed.error());
        }
        into = *parsed;
        return {};
    };
    precision.integrators = values_of<volumetrics::Integrator>(texts.integrators, integrator_names);
    precision.visibilities = values_of<volumetrics::SunVisibility>(texts.visibilities, visibility_names);
    tl::expected<void, std::string> result = take(parse_size(texts.size), precision.size);
    if (!texts.grids.empty()) {
        precision.grids.resize(texts.grids.size());
        for (std::size_t i = 0; result && i < texts.grids.size(); ++i) {
            result = take(parse_grid(texts.grids[i]), precision.grids[i]);
        }
    }
    if (result && texts.error) {
        result = take(parse_error_bound(*texts.error), precision.error);
    }
    if (result && texts.budget) {
        result = take(parse_budget_ms(*texts.budget), precision.budget_ms);
    }
    if (result && precision.file && precision.scene != "all" && precision.scene != "file") {
        result = tl::unexpected("--file is measured by --scene all or --scene file, not by --scene " + precision.scene);
    }
    return result;
}

int run(int argc, char** argv) {
    CLI::App app("Frame graph and volumetric light on Vulkan");
    app.name("tyndall");
    app.require_subcommand(1);

    RenderArguments render;
    std::string size = "1280x720";
    std::string queues = "one";
    CLI::App* render_command = app.add_subcommand("render", "Render a glTF scene, with fog and particles, to images");
    render_command->add_option("scene", render.scene, "glTF file (.gltf or .glb)")->required();
    render_command->add_option("--fog", render.fog, "fog description; without it <scene>.fog.json, if there is one");
    render_command->add_option("--particles", render.particles,
                               "emitters; without it <scene>.particles.json, if there is one");
    render_command->add_flag("--no-fog", render.no_fog, "leave the fog out");
    render_command->add_flag("--no-particles", render.no_particles, "leave the particles out");
    render_command->add_option("--camera", render.camera, "index of the scene's camera")->capture_default_str();
    render_command->add_option("--size", size, "WIDTHxHEIGHT in pixels")->capture_default_str();
    render_command->add_option("--frames", render.frames, "frames to render; the last one is written")
        ->check(CLI::Range(1U, 1000000U))
        ->capture_default_str();
    render_command->add_option("--time", render.time_s, "time of the first frame, s")->capture_default_str();
    render_command->add_option("--interval", render.frame_interval_s, "time between frames, s")->capture_default_str();
    render_command->add_option("--exposure", render.exposure_ev100, "EV100; without it, from the image");
    render_command->add_option("--out", render.outputs, "image to write, .png or .exr; may be given several times")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    render_command->add_flag("--explain", render.explain, "print what each pass is, where it runs and why");
    render_command->add_option("--explain-file", render.explain_file, "write that table to a file");
    render_command->add_flag("--timing", render.timing, "print milliseconds of each pass, median over the frames");
    render_command->add_option("--timing-file", render.timing_file, "write that table to a file");
    render_command->add_option("--export-frame", render.export_frame,
                               "write the frame and its measured durations as JSON, for tyndall schedule");
    render_command->add_option("--trace", render.trace,
                               "write the predicted and the measured timeline, for Perfetto or chrome://tracing");
    render_command->add_option("--dump-stages", render.stages_dir, "write a picture of each intermediate to a folder");
    render_command->add_option("--device", render.device, "part of a device's name, or its index; see tyndall info");
    render_command
        ->add_option(
            "--queues", queues,
            "queues that the plan is made for: one, two (fog on async compute), or measured (two, used where it pays)")
        ->check(CLI::IsMember({"one", "two", "measured"}))
        ->capture_default_str();
    render_command->add_flag("--validate", render.validate,
                             "run under the Khronos validation layer, and compare what passes push with what their "
                             "shaders bind; a message fails the run");
    render_command->add_flag("--poison", render.poison,
                             "fill transients with NaN before they are written: a picture that changes reads what "
                             "nobody wrote");
    render_command->add_flag("--fp32", render.fp32, "32-bit scene colour and froxels");
    render_command->add_flag("--json", render.json, "print the timing table as JSON");

    ScheduleArguments schedule;
    CLI::App* schedule_command = app.add_subcommand(
        "schedule", "Compile a frame that a JSON file describes, and explain the plan; no GPU needed");
    add_schedule_options(*schedule_command, schedule);

    PrecisionArguments precision;
    PrecisionTexts precision_texts;
    CLI::App* precision_command =
        app.add_subcommand("precision", "Error against run time, on scenes whose exact picture is computed");
    add_precision_options(*precision_command, precision, precision_texts);

    StabilityArguments stability;
    CLI::App* stability_command =
        app.add_subcommand("stability", "The fog at the ends of its domain: bounds, and errors against exact pictures");
    add_stability_options(*stability_command, stability);

    InfoArguments info;
    CLI::App* info_command = app.add_subcommand("info", "List devices, their queues and what is supported");
    info_command->add_option("--device", info.device, "part of a device's name, or its index");
    info_command->add_flag("--json", info.json, "print JSON");

    if (const std::string word = argc > 1 ? argv[1] : ""; !word.empty() && word[0] != '-') {
        if (app.get_subcommands([&](const CLI::App* one) { return one->get_name() == word; }).empty()) {
            return bad_input("There is no subcommand '" + word + "'; see tyndall --help");
        }
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& help) {
        return app.exit(help);
    } catch (const CLI::ParseError& error) {
        return bad_input(error.what());
    }
    if (render_command->parsed()) {
        const tl::expected<Size, std::string> parsed = parse_size(size);
        if (!parsed) {
            return bad_input(parsed.error());
        }
        render.size = *parsed;
        render.queues = queues == "two" ? Queues::two : queues == "measured" ? Queues::measured : Queues::one;
        return run_render(render);
    }
    if (precision_command->parsed()) {
        if (const auto parsed = parse_texts(precision_texts, precision); !parsed) {
            return bad_input(parsed.error());
        }
        return run_precision(precision);
    }
    if (stability_command->parsed()) {
        return run_stability(stability);
    }
    return schedule_command->parsed() ? run_schedule(schedule) : run_info(info);
}

} // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "tyndall: %s\n", error.what());
        return exit_failed;
    }
}
