// tyndall precision: pictures of scenes whose exact picture is known, their errors and their times.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <set>
#include <system_error>
#include <tuple>

#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "engine/file_io.hpp"
#include "samples/precision/metrics.hpp"
#include "samples/precision/scene.hpp"
#include "samples/tyndall/arguments.hpp"
#include "samples/tyndall/frame_loop.hpp"
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

struct Row {
    std::string scene;
    PrecisionConfiguration configuration;
    std::uint32_t frame = 1;
    const char* physics = "";
    ErrorMetrics error;
    double reference_error = 0.0;
    double fog_ms = 0.0;
    double frame_ms = 0.0;
};

void make_black(PrecisionScene& scene) {
    for (Surface& surface : scene.surfaces) {
        surface.albedo = glm::dvec3(0.0);
    }
}

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
Expected<std::vector<Row>> measure(const engine::Device& device, const PrecisionArguments& arguments,
                                   const PrecisionScene& scene, const PrecisionConfiguration& configuration,
                                   std::span<const reference::Pixel> pixels, std::span<const TruthImage> images) {
    FrameLoopInfo info;
    info.renderer = renderer_settings(scene);
    info.fog = scene.fog;
    info.fog->settings.integrator = configuration.integrator;
    info.fog->settings.visibility.method = configuration.visibility;
    info.fog->settings.grid.slices = configuration.slices;
    info.profile = true;
    if (const auto valid = volumetrics::validate(info.fog->settings); !valid) {
        return tl::unexpected(valid.error().message);
    }
    auto loop = FrameLoop::create(device, engine_scene(scene), std::move(info));
    if (!loop) {
        return tl::unexpected(loop.error().message);
    }
    FrameWishes wishes;
    wishes.camera = engine_scene(scene).cameras.front();
    wishes.size = {arguments.size.width, arguments.size.height};
    wishes.time_s = scene.time_s;
    std::vector<Row> rows;
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
            const std::vector<glm::dvec3> found = choose((*loop)->radiance(), pixels);
            for (const TruthImage& image : images) {
                rows.push_back({.scene = scene.name,
                                .configuration = configuration,
                                .frame = frame,
                                .physics = image.physics,
                                .error = compare_images(found, image.values),
                                .reference_error = image.relative_error});
            }
        }
    }
    for (Row& row : rows) {
        std::tie(row.fog_ms, row.frame_ms) = times_ms(timings, without_fog);
    }
    return rows;
}

const char* name_of(volumetrics::Integrator integrator) {
    constexpr std::array names{"euler", "half_slice", "exponential", "exponential_quadratic"};
    return names[static_cast<std::size_t>(integrator)];
}
const char* name_of(volumetrics::SunVisibility visibility) {
    constexpr std::array names{"one_tap", "n_taps", "prefiltered", "lit_fraction"};
    return names[static_cast<std::size_t>(visibility)];
}

std::string to_csv(std::span<const Row> rows, const std::string& device) {
    std::string text = "scene,integrator,visibility,slices,frame,physics,relative_l2,standard_error,rmse_cd_m2,"
                       "percentile99,maximum,bias,reference_error,fog_ms,frame_ms,device\n";
    std::array<char, 512> line{};
    for (const Row& row : rows) {
        const ErrorMetrics& e = row.error;
        std::snprintf(line.data(), line.size(),
                      "%s,%s,%s,%u,%u,%s,%.6e,%.2e,%.6e,%.6e,%.6e,%.6e,%.1e,%.3f,%.3f,\"%s\"\n", row.scene.c_str(),
                      name_of(row.configuration.integrator), name_of(row.configuration.visibility),
                      row.configuration.slices, row.frame, row.physics, e.relative_l2, e.standard_error, e.rmse,
                      e.percentile99, e.maximum, e.bias, row.reference_error, row.fog_ms, row.frame_ms, device.c_str());
        text += line.data();
    }
    return text;
}

std::string to_json(std::span<const Row> rows, const PrecisionArguments& arguments, const std::string& device) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Row& row : rows) {
        const ErrorMetrics& e = row.error;
        list.push_back({{"scene", row.scene},
                        {"integrator", name_of(row.configuration.integrator)},
                        {"visibility", name_of(row.configuration.visibility)},
                        {"slices", row.configuration.slices},
                        {"frame", row.frame},
                        {"physics", row.physics},
                        {"relative_l2", e.relative_l2},
                        {"standard_error", e.standard_error},
                        {"rmse_cd_m2", e.rmse},
                        {"percentile99", e.percentile99},
                        {"maximum", e.maximum},
                        {"bias", e.bias},
                        {"reference_error", row.reference_error},
                        {"fog_ms", row.fog_ms},
                        {"frame_ms", row.frame_ms}});
    }
    const nlohmann::ordered_json document = {
        {"device", device}, {"width", arguments.size.width}, {"height", arguments.size.height}, {"rows", list}};
    return document.dump(2) + "\n";
}

std::string to_table(std::span<const Row> rows, const std::string& device) {
    std::string text = "device: " + device + "\n";
    std::array<char, 256> line{};
    std::snprintf(line.data(), line.size(), "%-12s %-22s %-12s %6s %5s  %-31s %9s %9s %9s %9s %8s %8s\n", "scene",
                  "integrator", "visibility", "slices", "frame", "compared with physics", "rel. L2", "+-", "99th perc.",
                  "bias", "fog ms", "frame ms");
    text += line.data();
    for (const Row& row : rows) {
        const ErrorMetrics& e = row.error;
        std::snprintf(line.data(), line.size(),
                      "%-12s %-22s %-12s %6u %5u  %-31s %8.3f%% %8.3f%% %9.2f%% %+8.3f%% %8.2f %8.2f\n",
                      row.scene.c_str(), name_of(row.configuration.integrator), name_of(row.configuration.visibility),
                      row.configuration.slices, row.frame, row.physics, 100.0 * e.relative_l2, 100.0 * e.standard_error,
                      100.0 * e.percentile99, 100.0 * e.bias, row.fog_ms, row.frame_ms);
        text += line.data();
    }
    const auto [smallest, largest] = std::minmax_element(
        rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.error.relative_l2 < b.error.relative_l2; });
    const auto least_exact = std::max_element(
        rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.reference_error < b.reference_error; });
    std::snprintf(line.data(), line.size(), "errors from %.1e to %.1e; the exact pictures' own is at most %.1e\n",
                  smallest->error.relative_l2, largest->error.relative_l2, least_exact->reference_error);
    return text + line.data();
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
            for (const std::uint32_t slices : arguments.slices) {
                all.push_back({integrator, visibility, slices});
            }
        }
    }
    return all;
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
    std::vector<Row> rows;
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
            const std::vector<reference::Pixel> pixels = reference::random_pixels(size, most, 1);
            const std::vector<TruthImage> images = compute_truths(scene, size, pixels, 1e-5, progress);
            for (const PrecisionConfiguration& configuration : configurations(arguments)) {
                progress.show(scene.name + ", " + name_of(configuration.integrator) + ", " +
                              name_of(configuration.visibility) + ", " + std::to_string(configuration.slices) +
                              " slices");
                auto measured = measure(*device, arguments, scene, configuration, pixels, images);
                if (!measured) {
                    return fail(exit_bad_input, measured.error());
                }
                rows.insert(rows.end(), measured->begin(), measured->end());
            }
        }
    }
    const std::string device_text = device->info().name + ", " + device->info().driver;
    if (arguments.folder) {
        for (const auto& [name, text] : {std::pair{"precision.csv", to_csv(rows, device_text)},
                                         std::pair{"precision.json", to_json(rows, arguments, device_text)}}) {
            if (const auto written = write(*arguments.folder / name, text); !written) {
                return fail(exit_bad_input, written.error());
            }
        }
    }
    const std::string text = arguments.json ? to_json(rows, arguments, device_text) : to_table(rows, device_text);
    std::fputs(text.c_str(), stdout);
    return exit_ok;
}

} // namespace tyndall::samples
