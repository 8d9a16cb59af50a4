// tyndall stability: the fog at the ends of its domain.
#include <algorithm>
#include <cstdio>
#include <system_error>

#include "engine/file_io.hpp"
#include "samples/tyndall/arguments.hpp"
#include "samples/tyndall/machine.hpp"
#include "samples/tyndall/precision_files.hpp"
#include "samples/tyndall/progress.hpp"
#include "samples/tyndall/stability_pictures.hpp"
#include "samples/tyndall/stability_report.hpp"
#include "samples/tyndall/stability_series.hpp"

namespace tyndall::samples {
namespace {

constexpr const char* refusals = "refusal";

tl::expected<StabilityRow, std::string> measure(const engine::Device& device, const StabilityCase& test) {
    const auto picture = take_picture(device, test);
    if (!picture) {
        return tl::unexpected(test.name + ", " + test.parameter + ": " + picture.error());
    }
    const double tolerance = storage_tolerance(test);
    return StabilityRow{.name = test.name,
                        .parameter = test.parameter,
                        .measure = "relative error of the worst pixel",
                        .worst =
                            worst_relative_error(picture->radiance, exact_picture(test), test.floor, test.least_mean),
                        .bound = test.bound,
                        .broken = to_text(check_bounds(picture->stages, picture->radiance, tolerance), tolerance)};
}

/// Settings outside the domain must be refused with the name of the parameter.
StabilityRow refuse(const Refusal& refusal) {
    auto valid = volumetrics::validate(refusal.fog.medium);
    if (valid) {
        valid = volumetrics::validate(refusal.fog.settings);
    }
    StabilityRow row{.name = refusals, .parameter = refusal.parameter};
    if (valid) {
        row.broken = "not refused";
    } else if (valid.error().message.find(refusal.parameter) == std::string::npos) {
        row.broken = "refused without its name: " + valid.error().message;
    } else {
        row.measure = "refused by name";
    }
    return row;
}

tl::expected<std::vector<StabilityRow>, std::string> run_cases(const StabilityArguments& arguments,
                                                               const engine::Device& device) {
    Progress progress;
    std::vector<StabilityRow> rows;
    const auto wanted = [&](const std::string& name) { return arguments.name == "all" || arguments.name == name; };
    for (const StabilityCase& test : stability_cases()) {
        if (wanted(test.name) && (test.quick || !arguments.quick)) {
            progress.show(test.name + ", " + test.parameter);
            auto row = measure(device, test);
            if (!row) {
                return tl::unexpected(row.error());
            }
            rows.push_back(std::move(*row));
        }
    }
    for (const StabilitySeries& series : stability_series()) {
        if (wanted(series.name)) {
            progress.show(series.name);
            const auto more = series.run(device, arguments.quick);
            if (!more) {
                return tl::unexpected(std::string(series.name) + ": " + more.error());
            }
            rows.insert(rows.end(), more->begin(), more->end());
        }
    }
    if (wanted(refusals)) {
        for (const Refusal& refusal : stability_refusals()) {
            rows.push_back(refuse(refusal));
        }
    }
    return rows;
}

} // namespace

std::vector<std::string> stability_case_names() {
    std::vector<std::string> names;
    for (const StabilityCase& test : stability_cases()) {
        if (names.empty() || names.back() != test.name) {
            names.push_back(test.name);
        }
    }
    for (const StabilitySeries& series : stability_series()) {
        names.emplace_back(series.name);
    }
    names.emplace_back(refusals);
    return names;
}

int run_stability(const StabilityArguments& arguments) {
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
    const auto rows = run_cases(arguments, *device);
    if (!rows) {
        return fail(exit_failed, rows.error());
    }
    const std::string device_text = machine_text(device->info());
    if (arguments.folder) {
        for (const auto& [name, text] : {std::pair{"stability.csv", to_csv(*rows, device_text)},
                                         std::pair{"stability.json", to_json(*rows, device_text)}}) {
            const auto written = engine::replace_file(*arguments.folder / name, std::as_bytes(std::span(text)));
            if (!written) {
                return fail(exit_bad_input, written.error().message);
            }
        }
    }
    std::fputs((arguments.json ? to_json(*rows, device_text) : to_table(*rows, device_text)).c_str(), stdout);
    std::fflush(stdout);
    if (arguments.folder) {
        if (const auto drawn = draw_plots(*arguments.folder); !drawn) {
            return fail(exit_failed, drawn.error());
        }
    }
    const bool holds = std::all_of(rows->begin(), rows->end(), [](const StabilityRow& row) { return row.passed(); });
    return holds ? exit_ok : exit_failed;
}

} // namespace tyndall::samples
