// tyndall render: a scene, fog and particles to images and tables.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <system_error>

#include "engine/file_io.hpp"
#include "engine/gltf.hpp"
#include "engine/particles_json.hpp"
#include "rendergraph/explain.hpp"
#include "rendergraph/json.hpp"
#include "rendergraph/report.hpp"
#include "samples/precision/fog_file.hpp"
#include "samples/tyndall/arguments.hpp"
#include "samples/tyndall/frame_loop.hpp"
#include "samples/tyndall/progress.hpp"
#include "samples/tyndall/timing.hpp"

namespace tyndall::samples {
namespace {

/// What ends the run: whose fault, and a sentence.
struct Failure {
    int exit_code = exit_failed;
    std::string sentence;
};
template <typename T>
using Expected = tl::expected<T, Failure>;

tl::unexpected<Failure> bad_input(std::string sentence) {
    return tl::unexpected(Failure{exit_bad_input, std::move(sentence)});
}
tl::unexpected<Failure> failed(const engine::Error& error) {
    return tl::unexpected(Failure{exit_failed, error.message});
}

Expected<void> check_arguments(const RenderArguments& arguments) {
    if (!std::isfinite(arguments.time_s)) {
        return bad_input("--time must be a finite number of seconds");
    }
    if (!std::isfinite(arguments.frame_interval_s) || arguments.frame_interval_s < 0.0) {
        return bad_input("--interval must be a finite number of seconds, 0 or more");
    }
    if (arguments.exposure_ev100 && !(std::abs(*arguments.exposure_ev100) <= 40.0)) {
        return bad_input("--exposure must be between -40 and 40 EV");
    }
    std::vector<std::filesystem::path> files = arguments.outputs;
    for (const std::filesystem::path& path : arguments.outputs) {
        if (path.extension() != ".png" && path.extension() != ".exr") {
            return bad_input("--out '" + path.string() + "' must end in .png or .exr");
        }
    }
    if (arguments.explain_file) {
        files.push_back(*arguments.explain_file);
    }
    if (arguments.timing_file) {
        files.push_back(*arguments.timing_file);
    }
    if (arguments.export_frame) {
        files.push_back(*arguments.export_frame);
    }
    if (arguments.trace) {
        files.push_back(*arguments.trace);
    }
    // Better now than after minutes of work.
    for (const std::filesystem::path& path : files) {
        std::error_code error;
        const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
        if (!std::filesystem::is_directory(folder, error)) {
            return bad_input("Cannot write '" + path.string() + "': there is no folder '" + folder.string() + "'");
        }
        if (std::filesystem::is_directory(path, error)) {
            return bad_input("Cannot write '" + path.string() + "': it is a folder");
        }
    }
    return {};
}

/// `given`, else `<scene>.<kind>.json` beside the scene if there is one.
std::optional<std::filesystem::path> sidecar(const std::optional<std::filesystem::path>& given,
                                             const std::filesystem::path& scene, const char* kind) {
    if (given) {
        return given;
    }
    const std::filesystem::path beside = scene.parent_path() / (scene.stem().string() + "." + kind + ".json");
    std::error_code error;
    return std::filesystem::exists(beside, error) ? std::optional(beside) : std::nullopt;
}

Expected<std::string> read_text(const std::filesystem::path& path) {
    const tl::expected<std::vector<std::byte>, engine::Error> bytes = engine::read_file(path);
    if (!bytes) {
        return bad_input(bytes.error().message);
    }
    return std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size());
}

Expected<std::optional<volumetrics::Fog>> load_fog(const RenderArguments& arguments) {
    const auto path = sidecar(arguments.fog, arguments.scene, "fog");
    if (arguments.no_fog || !path) {
        return std::nullopt;
    }
    tl::expected<volumetrics::Fog, std::string> fog = load_fog_file(*path);
    if (!fog) {
        return bad_input(fog.error());
    }
    return std::move(*fog);
}

Expected<std::vector<engine::ParticleEmitter>> load_particles(const RenderArguments& arguments) {
    const auto path = sidecar(arguments.particles, arguments.scene, "particles");
    if (arguments.no_particles || !path) {
        return std::vector<engine::ParticleEmitter>{};
    }
    const Expected<std::string> text = read_text(*path);
    if (!text) {
        return tl::unexpected(text.error());
    }
    tl::expected<std::vector<engine::ParticleEmitter>, engine::Error> emitters = engine::parse_particles_json(*text);
    if (!emitters) {
        return bad_input(path->string() + ": " + emitters.error().message);
    }
    return *emitters;
}

Expected<void> write_text(const std::filesystem::path& path, const std::string& text) {
    const auto written = engine::replace_file(path, std::as_bytes(std::span(text)));
    if (!written) {
        return bad_input(written.error().message);
    }
    return {};
}

std::string explain(const FrameLoop& loop, const Timings& timings) {
    std::vector<rg::PassDuration> durations;
    for (const Timings::Row& row : timings.rows()) {
        durations.push_back({row.index, row.median_ms});
    }
    std::string text = rg::explain_table(loop.graph(), loop.plan(), durations) + loop.omissions();
    for (const std::string& note : loop.renderer().notes()) {
        text += "note: " + note + "\n";
    }
    return text;
}

Expected<void> write_outputs(const RenderArguments& arguments, const FrameLoop& loop) {
    for (const std::filesystem::path& path : arguments.outputs) {
        const auto written = path.extension() == ".exr" ? engine::write_exr(path, loop.radiance())
                                                        : engine::write_png(path, loop.picture());
        if (!written) {
            return bad_input(written.error().message);
        }
    }
    return {};
}

/// The stages of one frame, and the same frame with and without fog.
Expected<void> dump_stages(const engine::Device& device, FrameLoop& loop, FrameWishes wishes,
                           const std::filesystem::path& folder) {
    StageImages stages(device);
    wishes.read_picture = true;
    wishes.stages = &stages;
    if (const auto run = loop.run(wishes); !run) {
        return failed(run.error());
    }
    const auto files = stages.write(folder);
    if (!files) {
        return bad_input(files.error().message);
    }
    const engine::Pixels<std::uint8_t> with_fog = loop.picture();
    wishes.stages = nullptr;
    loop.set_fog_enabled(false);
    const auto run = loop.run(wishes);
    loop.set_fog_enabled(true);
    if (!run) {
        return failed(run.error());
    }
    for (const auto& [name, picture] :
         {std::pair{"with_fog.png", &with_fog}, std::pair{"without_fog.png", &loop.picture()}}) {
        if (const auto written = engine::write_png(folder / name, *picture); !written) {
            return bad_input(written.error().message);
        }
    }
    return {};
}

/// The newest frame as it was declared, each pass with its median duration.
rg::Frame exported_frame(const RenderArguments& arguments, const FrameLoop& loop, const Timings& timings,
                         const std::string& device) {
    constexpr double ns_per_ms = 1e6;
    rg::Frame frame;
    frame.about = "Frame of " + arguments.scene.filename().string() + " at " + std::to_string(arguments.size.width) +
                  "x" + std::to_string(arguments.size.height) + ", durations measured on " + device + ", median of " +
                  std::to_string(timings.frame_count()) + " frames";
    frame.graph = loop.graph();
    frame.topology = loop.plan().topology;
    frame.costs.of_pass.resize(frame.graph.passes.size());
    for (const Timings::Row& row : timings.rows()) {
        if (row.index < frame.costs.of_pass.size()) {
            frame.costs.of_pass[row.index].mean_ns = std::llround(row.median_ms * ns_per_ms);
        }
    }
    return frame;
}

/// What the model predicts from the measured durations, and what the newest frame took.
std::string predicted_and_measured(const rg::Frame& frame, const FrameLoop& loop) {
    constexpr double ns_per_ms = 1e6;
    std::vector<rg::TimelinePass> measured;
    for (const rg::PassTiming& timing : loop.timings()) {
        const auto planned = std::find_if(loop.plan().passes.begin(), loop.plan().passes.end(),
                                          [&](const rg::PlannedPass& pass) { return pass.pass == timing.pass; });
        if (planned != loop.plan().passes.end()) {
            measured.push_back({timing.pass, planned->queue, std::llround(timing.start_ms * ns_per_ms),
                                std::llround((timing.start_ms + timing.duration_ms) * ns_per_ms)});
        }
    }
    return rg::to_trace(frame.graph, loop.plan(), rg::simulate(frame.graph, loop.plan(), frame.costs), measured);
}

Expected<void> write_frame(const RenderArguments& arguments, const rg::Frame& frame, const FrameLoop& loop) {
    if (arguments.export_frame) {
        if (Expected<void> written = write_text(*arguments.export_frame, rg::frame_to_json(frame)); !written) {
            return written;
        }
    }
    return arguments.trace ? write_text(*arguments.trace, predicted_and_measured(frame, loop)) : Expected<void>{};
}

Expected<void> render_frames(const RenderArguments& arguments, const engine::Device& device, FrameLoop& loop,
                             FrameWishes wishes, Progress& progress) {
    Timings timings;
    for (std::uint32_t frame = 0; frame < arguments.frames; ++frame) {
        const bool last = frame + 1 == arguments.frames;
        wishes.time_s = arguments.time_s + arguments.frame_interval_s * frame;
        wishes.read_picture = last;
        wishes.read_radiance = last && std::any_of(arguments.outputs.begin(), arguments.outputs.end(),
                                                   [](const auto& path) { return path.extension() == ".exr"; });
        progress.show("frame " + std::to_string(frame + 1) + " of " + std::to_string(arguments.frames));
        if (const auto run = loop.run(wishes); !run) {
            return failed(run.error());
        }
        // The first frames compile shaders and fill caches.
        if (frame >= 2 || last) {
            timings.add_frame(loop.graph(), loop.timings());
        }
    }
    if (Expected<void> written = write_outputs(arguments, loop); !written) {
        return written;
    }
    const std::string device_text = device.info().name + ", " + device.info().driver;
    const std::string timing_text = arguments.json ? timings.json(device_text) + "\n" : timings.table(device_text);
    const std::string explain_text = explain(loop, timings);
    if (Expected<void> written = write_frame(arguments, exported_frame(arguments, loop, timings, device_text), loop);
        !written) {
        return written;
    }
    if (arguments.stages_dir) {
        progress.show("stages");
        if (Expected<void> dumped = dump_stages(device, loop, wishes, *arguments.stages_dir); !dumped) {
            return dumped;
        }
    }
    if (arguments.explain_file) {
        if (Expected<void> written = write_text(*arguments.explain_file, explain_text); !written) {
            return written;
        }
    }
    if (arguments.timing_file) {
        if (Expected<void> written = write_text(*arguments.timing_file, timing_text); !written) {
            return written;
        }
    }
    if (arguments.explain) {
        std::fputs(explain_text.c_str(), stdout);
    }
    if (arguments.timing || arguments.json) {
        std::fputs(timing_text.c_str(), stdout);
    }
    return {};
}

Expected<void> render(const RenderArguments& arguments) {
    if (Expected<void> checked = check_arguments(arguments); !checked) {
        return checked;
    }
    Expected<std::optional<volumetrics::Fog>> fog = load_fog(arguments);
    if (!fog) {
        return tl::unexpected(fog.error());
    }
    Expected<std::vector<engine::ParticleEmitter>> emitters = load_particles(arguments);
    if (!emitters) {
        return tl::unexpected(emitters.error());
    }
    std::optional<Progress> progress(std::in_place);
    tl::expected<engine::Scene, engine::Error> scene =
        engine::load_gltf(arguments.scene, [&](std::string_view stage, double fraction) {
            progress->show(std::string(stage) + " " + std::to_string(static_cast<int>(fraction * 100.0)) + " %");
        });
    if (!scene) {
        return bad_input(scene.error().message);
    }
    if (arguments.camera >= scene->cameras.size()) {
        return bad_input("There is no camera " + std::to_string(arguments.camera) + "; '" + arguments.scene.string() +
                         "' has " + std::to_string(scene->cameras.size()) + ", counted from 0");
    }
    const engine::Camera camera = scene->cameras[arguments.camera];
    const std::vector<std::string> notes = scene->notes;

    const auto instance = engine::VulkanInstance::create(
        arguments.validate ? engine::Validation::core_and_synchronization : engine::Validation::off);
    if (!instance) {
        return failed(instance.error());
    }
    const auto device = engine::Device::create(*instance, arguments.device);
    if (!device) {
        const int code = arguments.device.empty() ? exit_failed : exit_bad_input;
        return tl::unexpected(Failure{code, device.error().message});
    }
    const std::uint32_t largest = device->properties().limits.maxImageDimension2D;
    if (arguments.size.width > largest || arguments.size.height > largest) {
        return bad_input("--size is larger than the " + std::to_string(largest) + " pixels that '" +
                         device->info().name + "' can draw");
    }
    FrameLoopInfo info;
    info.fog = *fog;
    info.emitters = std::move(*emitters);
    info.two_queues = arguments.queues != Queues::one;
    info.ask_for_async = arguments.queues == Queues::two;
    info.profile = arguments.queues == Queues::measured || arguments.timing || arguments.timing_file ||
                   arguments.explain || arguments.explain_file || arguments.json || arguments.export_frame ||
                   arguments.trace;
    info.poison = arguments.poison;
    info.check_bindings = arguments.validate;
    info.renderer.exposure.ev100 = arguments.exposure_ev100;
    const bool exr = std::any_of(arguments.outputs.begin(), arguments.outputs.end(),
                                 [](const auto& path) { return path.extension() == ".exr"; });
    if (exr || arguments.fp32) {
        info.renderer.color_format = VK_FORMAT_R32G32B32A32_SFLOAT;
    }
    if (arguments.fp32 && info.fog) {
        info.fog->settings.storage = volumetrics::StorageFormat::fp32;
    }
    progress->show("uploading");
    auto loop = FrameLoop::create(*device, std::move(*scene), std::move(info));
    if (!loop) {
        return failed(loop.error());
    }
    FrameWishes wishes;
    wishes.camera = camera;
    wishes.size = {arguments.size.width, arguments.size.height};
    Expected<void> rendered = render_frames(arguments, *device, **loop, wishes, *progress);
    progress.reset();
    loop->reset();
    if (!rendered) {
        return rendered;
    }
    for (const std::string& note : notes) {
        std::fprintf(stderr, "note: %s\n", note.c_str());
    }
    if (const std::vector<std::string> errors = instance->log().errors(); !errors.empty()) {
        return tl::unexpected(
            Failure{exit_failed, std::to_string(errors.size()) + " validation errors, the first: " + errors.front()});
    }
    return {};
}

} // namespace

int run_render(const RenderArguments& arguments) {
    const Expected<void> rendered = render(arguments);
    if (!rendered) {
        std::fprintf(stderr, "tyndall: %s\n", rendered.error().sentence.c_str());
        return rendered.error().exit_code;
    }
    return exit_ok;
}

} // namespace tyndall::samples
