// tyndall precision: pictures of scenes whose exact picture is known, their errors and their times.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <set>
#include <system_error>
#include <tuple>

#include <glm/geometric.hpp>

#include "engine/file_io.hpp"
#include "samples/precision/choice.hpp"
#include "samples/precision/metrics.hpp"
#include "samples/precision/orders.hpp"
#include "samples/precision/scene.hpp"
#include "samples/tyndall/arguments.hpp"
#include "samples/tyndall/frame_loop.hpp"
#include "samples/tyndall/precision_report.hpp"
#include "samples/tyndall/progress.hpp"
#include "samples/tyndall/timing.hpp"

namespace tyndall::samples {
namespace {

template <typename T>
using Expected = tl::expected<T, std::string>;

/// The truths that a picture is compared with: all of physics, and what the pictures do not attempt left out of it.
struct Truth {
    const char* name;
    Physics physics;
};
constexpr std::array truths{Truth{"full", {}}, Truth{"unweakened light paths", {.light_paths = false}},
                            Truth{"and no shadows of local lights", {.light_paths = false, .local_shadows = false}}};

struct TruthImage {
    const char* physics = "";
    std::vector<glm::dvec3> values;
    double relative_error = 0.0; ///< the reference's own, relative L2
};

void make_black(PrecisionScene& scene) {
    for (Surface& surface : scene.surfaces) {
        surface.albedo = glm::dvec3(0.0);
    }
}

/// A scene and what its pictures are compared with.
struct Bench {
    const engine::Device& device;
    PrecisionScene scene;
    std::vector<reference::Pixel> pixels;
    std::vector<TruthImage> truths;
};

bool has_local_shadows(const PrecisionScene& scene) {
    return std::any_of(scene.lights.begin(), scene.lights.end(),
                       [](const reference::Light& light) { return light.casts_shadows; });
}

std::vector<TruthImage> compute_truths(const PrecisionScene& scene, reference::ImageSize size,
                                       std::span<const reference::Pixel> pixels, double relative, Progress& progress) {
    std::vector<TruthImage> images;
    for (const Truth& truth : truths) {
        if (!truth.physics.local_shadows && !has_local_shadows(scene)) {
            continue;
        }
        const std::vector<reference::Estimate> estimates = reference::render(
            reference_scene(scene, truth.physics), scene.camera, size, pixels, {relative, 0.0}, [&](std::size_t done) {
                if (done % 256 == 0) {
                    progress.show(scene.name + ", exact picture (" + truth.name + "), " +
                                  std::to_string(100 * done / pixels.size()) + " %");
                }
            });
        TruthImage image{truth.name, {}, 0.0};
        double errors = 0.0;
        double squares = 0.0;
        for (const reference::Estimate& estimate : estimates) {
            image.values.push_back(estimate.value);
            errors += glm::dot(estimate.error, estimate.error);
            squares += glm::dot(estimate.value, estimate.value);
        }
        image.relative_error = std::sqrt(errors / squares);
        images.push_back(std::move(image));
    }
    return images;
}

/// Milliseconds of the passes that a frame has with fog only, and of all its passes.
std::pair<double, double> times_ms(const Timings& timings, const std::set<std::string>& without_fog) {
    double fog_ms = 0.0;
    for (const Timings::Row& row : timings.rows()) {
        fog_ms += without_fog.contains(row.pass) ? 0.0 : row.median_ms;
    }
    return {fog_ms, timings.frame_median_ms()};
}

std::vector<glm::dvec3> choose(const engine::Pixels<float>& image, std::span<const reference::Pixel> pixels) {
    std::vector<glm::dvec3> values;
    for (const reference::Pixel& pixel : pixels) {
        const float* rgb = image.values.data() + 3 * (std::size_t{pixel.y} * image.width + pixel.x);
        values.emplace_back(rgb[0], rgb[1], rgb[2]);
    }
    return values;
}

/// The first frame and the last of `arguments.frames`, after a cut; then the times.
Expected<std::vector<PrecisionRow>> measure(const PrecisionArguments& arguments, const Bench& bench,
                                            const PrecisionConfiguration& configuration) {
    const PrecisionScene& scene = bench.scene;
    FrameLoopInfo info;
    info.renderer = renderer_settings(scene);
    info.fog = scene.fog;
    info.fog->settings.integrator = configuration.integrator;
    info.fog->settings.visibility.method = configuration.visibility;
    info.fog->settings.grid.width = configuration.grid.width;
    info.fog->settings.grid.height = configuration.grid.height;
    info.fog->settings.grid.slices = configuration.slices;
    info.fog->settings.storage = configuration.storage;
    info.renderer.cascades.resolution = configuration.cascade_texels;
    info.profile = true;
    if (const auto valid = volumetrics::validate(info.fog->settings); !valid) {
        return tl::unexpected(valid.error().message);
    }
    auto loop = FrameLoop::create(bench.device, engine_scene(scene), std::move(info));
    if (!loop) {
        return tl::unexpected(loop.error().message);
    }
    FrameWishes wishes;
    wishes.camera = engine_scene(scene).cameras.front();
    wishes.size = {arguments.size.width, arguments.size.height};
    wishes.time_s = scene.time_s;
    std::vector<PrecisionRow> rows;
    Timings timings;
    std::set<std::string> without_fog;
    constexpr std::uint32_t warm_frames = 2; // compile shaders and fill caches
    for (std::uint32_t i = 0; i < warm_frames + arguments.frames; ++i) {
        const std::uint32_t frame = i < warm_frames ? 0 : i - warm_frames + 1;
        (*loop)->set_fog_enabled(i > 0);
        wishes.cut = frame == 1;
        wishes.read_radiance = frame == 1 || frame == arguments.frames;
        if (const auto run = (*loop)->run(wishes); !run) {
            return tl::unexpected(run.error().message);
        }
        if (i == 0) {
            for (const rg::PassTiming& timing : (*loop)->timings()) {
                without_fog.insert((*loop)->graph().passes[timing.pass].name);
            }
        }
        if (frame > 0) {
            timings.add_frame((*loop)->graph(), (*loop)->timings());
        }
        if (frame > 0 && wishes.read_radiance) {
            const std::vector<glm::dvec3> found = choose((*loop)->radiance(), bench.pixels);
            for (const TruthImage& image : bench.truths) {
                rows.push_back({.scene = scene.name,
                                .configuration = configuration,
                                .frame = frame,
                                .physics = image.physics,
                                .error = compare_images(found, image.values),
                                .reference_error = image.relative_error});
            }
        }
    }
    for (PrecisionRow& row : rows) {
        std::tie(row.fog_ms, row.frame_ms) = times_ms(timings, without_fog);
    }
    return rows;
}

Expected<void> write(const std::filesystem::path& path, const std::string& text) {
    if (const auto written = engine::replace_file(path, std::as_bytes(std::span(text))); !written) {
        return tl::unexpected(written.error().message);
    }
    return {};
}

std::vector<PrecisionConfiguration> configurations(const PrecisionArguments& arguments) {
    std::vector<PrecisionConfiguration> all;
    for (const volumetrics::Integrator integrator : arguments.integrators) {
        for (const volumetrics::SunVisibility visibility : arguments.visibilities) {
            for (const Size& grid : arguments.grids) {
                for (const std::uint32_t slices : arguments.slices) {
                    all.push_back({.integrator = integrator, .visibility = visibility, .grid = grid, .slices = slices});
                }
            }
        }
    }
    return all;
}

std::string percent(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.3g %%", 100.0 * value);
    return text.data();
}
std::string milliseconds(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.3g ms", value);
    return text.data();
}

bool is_judged(const PrecisionRow& row, const PrecisionArguments& arguments) {
    return row.frame == arguments.frames && row.physics == truths.front().name;
}

std::string to_text(const PrecisionRow& row) {
    return to_text(row.configuration) + ": " + percent(row.error.relative_l2) + " in " + milliseconds(row.fog_ms);
}

/// What a bound of error or time chose, run once more, and why; or by how much nothing reaches it.
Expected<std::string> choose_and_run(const PrecisionArguments& arguments, const Bench& bench,
                                     std::span<const PrecisionRow> rows) {
    std::vector<const PrecisionRow*> judged;
    std::vector<Measured> measured;
    for (const PrecisionRow& row : rows) {
        if (row.scene == bench.scene.name && is_judged(row, arguments)) {
            judged.push_back(&row);
            measured.push_back({row.error.relative_l2, row.fog_ms});
        }
    }
    std::string text;
    const auto report = [&](const std::string& wish, std::optional<std::size_t> choice,
                            std::size_t nearest) -> Expected<void> {
        text += bench.scene.name + ", " + wish + ": ";
        if (!choice) {
            text += "unreachable by what was measured; nearest is " + to_text(*judged[nearest]) + "\n";
            return {};
        }
        const auto again = measure(arguments, bench, judged[*choice]->configuration);
        if (!again) {
            return tl::unexpected(again.error());
        }
        text += to_text(*judged[*choice]);
        for (const PrecisionRow& row : *again) {
            if (is_judged(row, arguments)) {
                text += "; run again: " + percent(row.error.relative_l2) + " in " + milliseconds(row.fog_ms);
            }
        }
        text += "\n";
        return {};
    };
    if (arguments.error) {
        const auto done = report("the cheapest within " + percent(*arguments.error),
                                 cheapest_within(measured, *arguments.error), *most_exact_within(measured, 1e300));
        if (!done) {
            return tl::unexpected(done.error());
        }
    }
    if (arguments.budget_ms) {
        const auto done = report("the most exact within " + milliseconds(*arguments.budget_ms),
                                 most_exact_within(measured, *arguments.budget_ms), *cheapest_within(measured, 1e300));
        if (!done) {
            return tl::unexpected(done.error());
        }
    }
    return text;
}

/// A cause of error, and the configuration with far less of it.
struct Cause {
    const char* name;
    void (*remove)(PrecisionConfiguration& configuration);
};
constexpr std::array causes{
    Cause{"none removed", [](PrecisionConfiguration&) {}},
    Cause{"4 times the slices", [](PrecisionConfiguration& c) { c.slices = std::min(512U, 4 * c.slices); }},
    Cause{"4 times the columns",
          [](PrecisionConfiguration& c) {
              c.grid = {std::min(1024U, 2 * c.grid.width), std::min(1024U, 2 * c.grid.height)};
          }},
    Cause{"exact lit fraction",
          [](PrecisionConfiguration& c) { c.visibility = volumetrics::SunVisibility::lit_fraction; }},
    Cause{"16 times the shadow map", [](PrecisionConfiguration& c) { c.cascade_texels *= 4; }},
    Cause{"fp32 storage", [](PrecisionConfiguration& c) { c.storage = volumetrics::StorageFormat::fp32; }},
    Cause{"quadratic integrator",
          [](PrecisionConfiguration& c) { c.integrator = volumetrics::Integrator::exponential_quadratic; }}};

/// The first configuration's error with one cause removed at a time, of pictures and of truths.
Expected<std::string> list_causes(const PrecisionArguments& arguments, const Bench& bench, Progress& progress) {
    std::string text = bench.scene.name + ", what is left without one cause of error, frame 1 and " +
                       std::to_string(arguments.frames) + ":\n";
    for (const Cause& cause : causes) {
        PrecisionConfiguration configuration = configurations(arguments).front();
        cause.remove(configuration);
        progress.show(bench.scene.name + ", " + cause.name);
        const auto rows = measure(arguments, bench, configuration);
        if (!rows) {
            return tl::unexpected(rows.error());
        }
        std::array<char, 160> line{};
        const auto add = [&](const std::string& name, const std::string& physics) {
            std::snprintf(line.data(), line.size(), "  %-32s", name.c_str());
            text += line.data();
            for (const PrecisionRow& row : *rows) {
                if (row.physics == physics) {
                    std::snprintf(line.data(), line.size(), " %9.3f%%", 100.0 * row.error.relative_l2);
                    text += line.data();
                }
            }
            std::snprintf(line.data(), line.size(), "   fog %8.2f ms\n", rows->front().fog_ms);
            text += line.data();
        };
        add(cause.name, truths.front().name);
        if (&cause == &causes.front()) {
            for (const TruthImage& truth : std::span(bench.truths).subspan(1)) {
                add(truth.physics, truth.physics);
            }
        }
    }
    return text;
}

} // namespace

std::vector<std::string> precision_scene_names() {
    std::vector<std::string> names;
    for (const PrecisionScene& scene : precision_scenes()) {
        names.push_back(scene.name);
    }
    return names;
}

int run_precision(const PrecisionArguments& arguments) {
    const auto fail = [](int code, const std::string& sentence) {
        std::fprintf(stderr, "tyndall: %s\n", sentence.c_str());
        return code;
    };
    if (arguments.orders) {
        std::fputs(to_table(measured_orders()).c_str(), stdout);
        return exit_ok;
    }
    if (arguments.folder) {
        std::error_code error;
        std::filesystem::create_directories(*arguments.folder, error);
        if (!std::filesystem::is_directory(*arguments.folder)) {
            return fail(exit_bad_input, "Cannot make the folder '" + arguments.folder->string() + "'");
        }
    }
    const auto instance = engine::VulkanInstance::create(engine::Validation::off);
    if (!instance) {
        return fail(exit_failed, instance.error().message);
    }
    const auto device = engine::Device::create(*instance, arguments.device);
    if (!device) {
        return fail(arguments.device.empty() ? exit_failed : exit_bad_input, device.error().message);
    }
    std::vector<PrecisionRow> rows;
    std::string remarks; // choices and causes
    {
        Progress progress;
        const reference::ImageSize size{arguments.size.width, arguments.size.height};
        for (PrecisionScene scene : precision_scenes()) {
            if (arguments.airlight) {
                make_black(scene);
            }
            if (arguments.scene != "all" && arguments.scene != scene.name) {
                continue;
            }
            const std::size_t all = std::size_t{size.width} * size.height;
            const std::size_t most = scene.pixels > 0 ? std::min(scene.pixels, all) : all;
            Bench bench{*device, scene, reference::random_pixels(size, most, 1), {}};
            bench.truths = compute_truths(scene, size, bench.pixels, 1e-5, progress);
            for (const PrecisionConfiguration& configuration : configurations(arguments)) {
                progress.show(scene.name + ", " + to_text(configuration));
                const auto measured = measure(arguments, bench, configuration);
                if (!measured) {
                    return fail(exit_bad_input, measured.error());
                }
                rows.insert(rows.end(), measured->begin(), measured->end());
            }
            const auto chosen = choose_and_run(arguments, bench, rows);
            if (!chosen) {
                return fail(exit_failed, chosen.error());
            }
            remarks += *chosen;
            if (arguments.causes) {
                const auto listed = list_causes(arguments, bench, progress);
                if (!listed) {
                    return fail(exit_failed, listed.error());
                }
                remarks += *listed;
            }
        }
    }
    mark_front(rows);
    const std::string device_text = device->info().name + ", " + device->info().driver;
    if (arguments.folder) {
        for (const auto& [name, text] : {std::pair{"precision.csv", to_csv(rows, device_text)},
                                         std::pair{"precision.json", to_json(rows, arguments.size, device_text)}}) {
            if (const auto written = write(*arguments.folder / name, text); !written) {
                return fail(exit_bad_input, written.error());
            }
        }
    }
    const std::string text =
        arguments.json ? to_json(rows, arguments.size, device_text) : to_table(rows, device_text) + remarks;
    std::fputs(text.c_str(), stdout);
    return exit_ok;
}

} // namespace tyndall::samples
