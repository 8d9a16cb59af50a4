#include "samples/tyndall/precision_report.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <map>
#include <tuple>

#include <nlohmann/json.hpp>

#include "samples/precision/choice.hpp"
#include "samples/precision/orders.hpp"

namespace tyndall::samples {
namespace {

const char* name_of(volumetrics::Integrator integrator) {
    return integrator_names[static_cast<std::size_t>(integrator)];
}
const char* name_of(volumetrics::SunVisibility visibility) {
    return visibility_names[static_cast<std::size_t>(visibility)];
}

std::string grid_text(Size grid) {
    return std::to_string(grid.width) + "x" + std::to_string(grid.height);
}

} // namespace

void mark_front(std::vector<PrecisionRow>& rows) {
    using Rivalry = std::tuple<std::string, std::uint32_t, std::string>; // scene, frame, truth
    std::map<Rivalry, std::vector<std::size_t>> rivals;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        rivals[{rows[i].scene, rows[i].frame, rows[i].physics}].push_back(i);
    }
    for (const auto& [rivalry, indices] : rivals) {
        std::vector<Measured> measured;
        for (const std::size_t i : indices) {
            measured.push_back({rows[i].error.relative_l2, rows[i].fog_ms});
        }
        const std::vector<bool> front = pareto_front(measured);
        for (std::size_t k = 0; k < indices.size(); ++k) {
            rows[indices[k]].on_front = front[k];
        }
    }
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

std::string to_text(const PrecisionConfiguration& configuration) {
    return std::string(name_of(configuration.integrator)) + ", " + name_of(configuration.visibility) + ", " +
           grid_text(configuration.grid) + "x" + std::to_string(configuration.slices);
}

std::string to_text(const PrecisionRow& row) {
    return to_text(row.configuration) + ": " + percent(row.error.relative_l2) + " in " + milliseconds(row.fog_ms);
}

std::string to_csv(std::span<const PrecisionRow> rows, const std::string& device) {
    std::string text =
        "scene,integrator,visibility,grid,slices,frame,physics,relative_l2,standard_error,rmse_cd_m2,"
        "percentile99,maximum,bias,reference_error,fog_ms,relative_time,clocked_ms,frame_ms,on_front,own,"
        "device\n";
    std::array<char, 512> line{};
    for (const PrecisionRow& row : rows) {
        const ErrorMetrics& e = row.error;
        std::snprintf(line.data(), line.size(),
                      "%s,%s,%s,%s,%u,%u,%s,%.6e,%.2e,%.6e,%.6e,%.6e,%.6e,%.1e,%.3f,%.4f,%.3f,%.3f,%d,%d,\"%s\"\n",
                      row.scene.c_str(), name_of(row.configuration.integrator), name_of(row.configuration.visibility),
                      grid_text(row.configuration.grid).c_str(), row.configuration.slices, row.frame,
                      row.physics.c_str(), e.relative_l2, e.standard_error, e.rmse, e.percentile99, e.maximum, e.bias,
                      row.reference_error, row.fog_ms, row.relative_time, row.clocked_ms, row.frame_ms,
                      row.on_front ? 1 : 0, row.is_own ? 1 : 0, device.c_str());
        text += line.data();
    }
    return text;
}

std::string to_csv(std::span<const CauseRow> rows) {
    std::string text = "scene,cause,physics,first_relative_l2,first_bias,last_relative_l2,last_bias,fog_ms,frame_ms\n";
    std::array<char, 256> line{};
    for (const CauseRow& row : rows) {
        std::snprintf(line.data(), line.size(), "%s,%s,%s,%.6e,%.6e,%.6e,%.6e,%.3f,%.3f\n", row.scene.c_str(),
                      row.cause.c_str(), row.physics.c_str(), row.first.relative_l2, row.first.bias,
                      row.last.relative_l2, row.last.bias, row.fog_ms, row.frame_ms);
        text += line.data();
    }
    return text;
}

std::string to_json(std::span<const PrecisionRow> rows, std::span<const CauseRow> causes, Size size,
                    const std::string& device) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const PrecisionRow& row : rows) {
        const ErrorMetrics& e = row.error;
        list.push_back({{"scene", row.scene},
                        {"integrator", name_of(row.configuration.integrator)},
                        {"visibility", name_of(row.configuration.visibility)},
                        {"grid", grid_text(row.configuration.grid)},
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
                        {"relative_time", row.relative_time},
                        {"clocked_ms", row.clocked_ms},
                        {"frame_ms", row.frame_ms},
                        {"on_front", row.on_front},
                        {"own", row.is_own}});
    }
    nlohmann::ordered_json cause_list = nlohmann::ordered_json::array();
    for (const CauseRow& row : causes) {
        cause_list.push_back({{"scene", row.scene},
                              {"cause", row.cause},
                              {"physics", row.physics},
                              {"first_relative_l2", row.first.relative_l2},
                              {"first_bias", row.first.bias},
                              {"last_relative_l2", row.last.relative_l2},
                              {"last_bias", row.last.bias},
                              {"fog_ms", row.fog_ms},
                              {"frame_ms", row.frame_ms}});
    }
    const nlohmann::ordered_json document = {
        {"device", device}, {"width", size.width}, {"height", size.height}, {"rows", list}, {"causes", cause_list}};
    return document.dump(2) + "\n";
}

std::string to_table(std::span<const PrecisionRow> rows, const std::string& device) {
    std::string text = "device: " + device + "\n";
    std::array<char, 256> line{};
    std::snprintf(line.data(), line.size(), "%-12s %-22s %-12s %-8s %6s %5s  %-31s %9s %9s %9s %9s %8s %8s\n", "scene",
                  "integrator", "visibility", "grid", "slices", "frame", "compared with physics", "rel. L2", "+-",
                  "99th perc.", "bias", "fog ms", "frame ms");
    text += line.data();
    for (const PrecisionRow& row : rows) {
        const ErrorMetrics& e = row.error;
        std::snprintf(line.data(), line.size(),
                      "%-12s %-22s %-12s %-8s %6u %5u  %-31s %8.3f%% %8.3f%% %9.2f%% %+8.3f%% %8.2f %8.2f%s\n",
                      row.scene.c_str(), name_of(row.configuration.integrator), name_of(row.configuration.visibility),
                      grid_text(row.configuration.grid).c_str(), row.configuration.slices, row.frame,
                      row.physics.c_str(), 100.0 * e.relative_l2, 100.0 * e.standard_error, 100.0 * e.percentile99,
                      100.0 * e.bias, row.fog_ms, row.frame_ms, row.on_front ? "  front" : "");
        text += line.data();
    }
    return text;
}

std::string to_table(std::span<const CauseRow> rows) {
    std::string text = "what is left without one cause of error, first frame and last\n";
    std::array<char, 256> line{};
    for (const CauseRow& row : rows) {
        std::snprintf(line.data(), line.size(),
                      "%-12s  %-32s %9.3f%% %9.3f%%   bias %+8.3f%% %+8.3f%%   fog %8.2f ms of a frame's %8.2f ms\n",
                      row.scene.c_str(), row.cause.c_str(), 100.0 * row.first.relative_l2, 100.0 * row.last.relative_l2,
                      100.0 * row.first.bias, 100.0 * row.last.bias, row.fog_ms, row.frame_ms);
        text += line.data();
    }
    return text;
}

std::string reference_margins(std::span<const PrecisionRow> rows) {
    constexpr double wanted = 100.0;
    std::map<std::string, const PrecisionRow*> least; // of a scene, the row whose error is nearest its truth's own
    const auto margin = [](const PrecisionRow& row) { return row.error.relative_l2 / row.reference_error; };
    for (const PrecisionRow& row : rows) {
        const PrecisionRow*& known = least[row.scene];
        known = !known || margin(row) < margin(*known) ? &row : known;
    }
    std::string text;
    std::array<char, 256> line{};
    for (const auto& [scene, row] : least) {
        std::snprintf(line.data(), line.size(), "%s: errors from %.1e, %.3g times the exact picture's own (%.1e)%s\n",
                      scene.c_str(), row->error.relative_l2, margin(*row), row->reference_error,
                      margin(*row) < wanted ? ": LESS than the 100 times that judging it asks for" : "");
        text += line.data();
    }
    return text;
}

} // namespace tyndall::samples
