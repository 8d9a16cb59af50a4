// tyndall precision: pictures of scenes whose exact picture is known, their errors and their times.
#include <algorithm>
#include <array>
#include <cstdio>
#include <system_error>

#include "engine/file_io.hpp"
#include "samples/precision/file_scene.hpp"
#include "samples/precision/scene.hpp"
#include "samples/tyndall/arguments.hpp"
#include "samples/tyndall/machine.hpp"
#include "samples/tyndall/precision_bench.hpp"
#include "samples/tyndall/precision_causes.hpp"
#include "samples/tyndall/precision_choice.hpp"
#include "samples/tyndall/precision_files.hpp"
#include "samples/tyndall/precision_ladder.hpp"
#include "samples/tyndall/precision_orders.hpp"
#include "samples/tyndall/precision_report.hpp"
#include "samples/tyndall/precision_surfaces.hpp"
#include "samples/tyndall/precision_truths.hpp"
#include "samples/tyndall/progress.hpp"

namespace tyndall::samples {
namespace {

template <typename T>
using Expected = tl::expected<T, std::string>;

void make_black(PrecisionScene& scene) {
    for (Surface& surface : scene.surfaces) {
        surface.albedo = glm::dvec3(0.0);
    }
    if (scene.drawn) {
        for (engine::Material& material : scene.drawn->materials) {
            material.base_color_factor = glm::vec4(0.0F, 0.0F, 0.0F, 1.0F);
            material.emissive = glm::vec3(0.0F);
        }
    }
}

Expected<std::vector<PrecisionScene>> chosen_scenes(const PrecisionArguments& arguments) {
    std::vector<PrecisionScene> scenes;
    for (const PrecisionScene& scene : precision_scenes()) {
        if (arguments.scene == "all" || arguments.scene == scene.name) {
            scenes.push_back(scene);
        }
    }
    if (arguments.scene == "file" && !arguments.file) {
        return tl::unexpected(std::string("--scene file needs --file SCENE.gltf"));
    }
    if (arguments.file && (arguments.scene == "all" || arguments.scene == "file")) {
        Expected<PrecisionScene> loaded = load_precision_scene(*arguments.file);
        if (!loaded) {
            return tl::unexpected(loaded.error());
        }
        scenes.push_back(std::move(*loaded));
    }
    return scenes;
}

Expected<void> write(const std::filesystem::path& path, const std::string& text) {
    if (const auto written = engine::replace_file(path, std::as_bytes(std::span(text))); !written) {
        return tl::unexpected(written.error().message);
    }
    return {};
}

/// Of all scenes.
struct Study {
    std::vector<PrecisionRow> rows;
    std::vector<CauseRow> causes;
    std::string remarks; ///< a line each
};

/// The scene with its exact pictures and, for more than one configuration, its yardstick.
Expected<Bench> make_bench(const PrecisionArguments& arguments, const engine::Device& device, PrecisionScene scene,
                           bool compares, Study& study, Progress& progress) {
    if (arguments.airlight) {
        make_black(scene);
    }
    const reference::ImageSize size{arguments.size.width, arguments.size.height};
    const std::size_t all = std::size_t{size.width} * size.height;
    const std::size_t most = scene.pixels > 0 ? std::min(scene.pixels, all) : all;
    Bench bench{.device = device,
                .scene = std::move(scene),
                .size = arguments.size,
                .frames = arguments.frames,
                .pixels = reference::random_pixels(size, most, 1),
                .truths = {},
                .yardstick = {},
                .yardstick_ms = {}};
    std::vector<std::optional<reference::SurfacePoint>> surfaces;
    if (bench.scene.drawn) {
        progress.show(bench.scene.name + ", what its pixels show");
        auto drawn = drawn_surfaces(device, bench.scene, arguments.size, bench.pixels);
        if (!drawn) {
            return tl::unexpected(drawn.error());
        }
        surfaces = std::move(*drawn);
    }
    auto truths = exact_pictures(bench.scene, size, bench.pixels, surfaces, arguments.airlight, arguments.folder,
                                 [&](const std::string& picture, double done) {
                                     progress.show(bench.scene.name + ", exact picture (" + picture + "), " +
                                                   std::to_string(static_cast<int>(100.0 * done)) + " %");
                                 });
    if (!truths) {
        return tl::unexpected(truths.error());
    }
    bench.truths = std::move(*truths);
    if (std::any_of(bench.truths.begin(), bench.truths.end(), [](const TruthImage& one) { return one.from_file; })) {
        study.remarks += bench.scene.name + ": exact pictures of an earlier run are used\n";
    }
    if (compares) {
        auto yardstick = PictureRun::create(device, bench.scene, bench.size, own_configuration(bench.scene));
        if (!yardstick) {
            return tl::unexpected(yardstick.error());
        }
        bench.yardstick = std::move(*yardstick);
    }
    return bench;
}

/// Why a study ended, and the exit code.
struct Failure {
    int code = exit_failed;
    std::string sentence;
};

/// Measures, chooses and lists causes in one scene.
tl::expected<void, Failure> study_scene(const PrecisionArguments& arguments, const engine::Device& device,
                                        const PrecisionScene& scene, Study& study, Progress& progress) {
    const std::vector<PrecisionConfiguration> all = configurations(arguments, scene);
    Expected<Bench> bench = make_bench(arguments, device, scene, all.size() > 1, study, progress);
    const auto failed = [](std::string sentence) {
        return tl::unexpected(Failure{.code = exit_failed, .sentence = std::move(sentence)});
    };
    if (!bench) {
        return failed(bench.error());
    }
    std::vector<PrecisionRow> rows;
    for (std::size_t i = 0; i < all.size(); ++i) {
        progress.show(scene.name + ", " + std::to_string(i + 1) + " of " + std::to_string(all.size()) + ", " +
                      to_text(all[i]));
        const Expected<Measurement> measured = measure(*bench, all[i]);
        if (!measured) {
            return failed(measured.error());
        }
        rows.insert(rows.end(), measured->rows.begin(), measured->rows.end());
        if (i == 0 && arguments.folder) {
            if (const auto written = write_pictures(*arguments.folder, *bench, measured->last); !written) {
                return tl::unexpected(Failure{.code = exit_bad_input, .sentence = written.error()});
            }
        }
    }
    settle_times(*bench, rows);
    mark_front(rows);
    study.remarks += own_against_front(*bench, rows);
    const Expected<std::string> chosen = choose_and_run(arguments, *bench, rows);
    if (!chosen) {
        return failed(chosen.error());
    }
    study.remarks += *chosen;
    study.rows.insert(study.rows.end(), rows.begin(), rows.end());
    if (arguments.causes) {
        const auto causes = list_causes(*bench, all.front(),
                                        [&](const std::string& cause) { progress.show(scene.name + ", " + cause); });
        if (!causes) {
            return failed(causes.error());
        }
        study.causes.insert(study.causes.end(), causes->begin(), causes->end());
    }
    return {};
}

Expected<void> write_files(const PrecisionArguments& arguments, const Study& study, const std::string& device) {
    const std::array<std::pair<const char*, std::string>, 3> files{
        {{"precision.csv", to_csv(study.rows, device)},
         {"precision.json", to_json(study.rows, study.causes, arguments.size, device)},
         {"causes.csv", to_csv(study.causes)}}};
    for (const auto& [name, text] : files) {
        if (auto written = write(*arguments.folder / name, text); !written) {
            return written;
        }
    }
    return {};
}

/// Of a sweep only what is on the front of the last frame; the files hold the rest.
std::vector<PrecisionRow> rows_to_print(const PrecisionArguments& arguments, const Study& study) {
    std::vector<PrecisionRow> rows = study.rows;
    if (is_sweep(arguments)) {
        std::erase_if(rows, [&](const PrecisionRow& row) {
            return !row.on_front || row.frame != arguments.frames || row.physics != full_physics;
        });
    }
    return rows;
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
    if (arguments.orders) {
        return run_orders(arguments);
    }
    const auto instance = engine::VulkanInstance::create(engine::Validation::off);
    if (!instance) {
        return fail(exit_failed, instance.error().message);
    }
    const auto device = engine::Device::create(*instance, arguments.device);
    if (!device) {
        return fail(arguments.device.empty() ? exit_failed : exit_bad_input, device.error().message);
    }
    const Expected<std::vector<PrecisionScene>> scenes = chosen_scenes(arguments);
    if (!scenes) {
        return fail(exit_bad_input, scenes.error());
    }
    Study study;
    {
        Progress progress;
        for (const PrecisionScene& scene : *scenes) {
            if (const auto done = study_scene(arguments, *device, scene, study, progress); !done) {
                return fail(done.error().code, done.error().sentence);
            }
        }
    }
    study.remarks += own_against_front_of_all(arguments.frames, study.rows);
    const std::string device_text = machine_text(device->info());
    if (arguments.folder) {
        if (const auto written = write_files(arguments, study, device_text); !written) {
            return fail(exit_bad_input, written.error());
        }
    }
    std::string text = to_json(study.rows, study.causes, arguments.size, device_text);
    if (!arguments.json) {
        text = to_table(rows_to_print(arguments, study), device_text) + reference_margins(study.rows);
        text += (study.causes.empty() ? "" : to_table(study.causes)) + study.remarks;
    }
    std::fputs(text.c_str(), stdout);
    std::fflush(stdout);
    if (arguments.folder) {
        if (const auto drawn = draw_plots(*arguments.folder); !drawn) {
            return fail(exit_failed, drawn.error());
        }
    }
    return exit_ok;
}

} // namespace tyndall::samples
