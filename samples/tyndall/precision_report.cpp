#include "samples/tyndall/precision_report.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "samples/precision/choice.hpp"

namespace tyndall::samples {
namespace {

const char* name_of(volumetrics::Integrator integrator) {
    constexpr std::array names{"euler", "half_slice", "exponential", "exponential_quadratic"};
    return names[static_cast<std::size_t>(integrator)];
}
const char* name_of(volumetrics::SunVisibility visibility) {
    constexpr std::array names{"one_tap", "n_taps", "prefiltered", "lit_fraction"};
    return names[static_cast<std::size_t>(visibility)];
}

std::string grid_text(Size grid) {
    return std::to_string(grid.width) + "x" + std::to_string(grid.height);
}

} // namespace

void mark_front(std::vector<PrecisionRow>& rows) {
    for (PrecisionRow& row : rows) {
        std::vector<Measured> rivals{{row.error.relative_l2, row.fog_ms}};
        for (const PrecisionRow& other : rows) {
            if (other.scene == row.scene && other.frame == row.frame && other.physics == row.physics) {
                rivals.push_back({other.error.relative_l2, other.fog_ms});
            }
        }
        row.on_front = pareto_front(rivals).front();
    }
}

std::string to_text(const PrecisionConfiguration& configuration) {
    return std::string(name_of(configuration.integrator)) + ", " + name_of(configuration.visibility) + ", " +
           grid_text(configuration.grid) + "x" + std::to_string(configuration.slices);
}

std::string to_csv(std::span<const PrecisionRow> rows, const std::string& device) {
    std::string text = "scene,integrator,visibility,grid,slices,frame,physics,relative_l2,standard_error,rmse_cd_m2,"
                       "percentile99,maximum,bias,reference_error,fog_ms,frame_ms,on_front,device\n";
    std::array<char, 512> line{};
    for (const PrecisionRow& row : rows) {
        const ErrorMetrics& e = row.error;
        std::snprintf(line.data(), line.size(),
                      "%s,%s,%s,%s,%u,%u,%s,%.6e,%.2e,%.6e,%.6e,%.6e,%.6e,%.1e,%.3f,%.3f,%d,\"%s\"\n",
                      row.scene.c_str(), name_of(row.configuration.integrator), name_of(row.configuration.visibility),
                      grid_text(row.configuration.grid).c_str(), row.configuration.slices, row.frame,
                      row.physics.c_str(), e.relative_l2, e.standard_error, e.rmse, e.percentile99, e.maximum, e.bias,
                      row.reference_error, row.fog_ms, row.frame_ms, row.on_front ? 1 : 0, device.c_str());
        text += line.data();
    }
    return text;
}

std::string to_json(std::span<const PrecisionRow> rows, Size size, const std::string& device) {
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
                        {"frame_ms", row.frame_ms},
                        {"on_front", row.on_front}});
    }
    const nlohmann::ordered_json document = {
        {"device", device}, {"width", size.width}, {"height", size.height}, {"rows", list}};
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
    const auto [smallest, largest] =
        std::minmax_element(rows.begin(), rows.end(), [](const PrecisionRow& a, const PrecisionRow& b) {
            return a.error.relative_l2 < b.error.relative_l2;
        });
    const auto least_exact =
        std::max_element(rows.begin(), rows.end(), [](const PrecisionRow& a, const PrecisionRow& b) {
            return a.reference_error < b.reference_error;
        });
    std::snprintf(line.data(), line.size(), "errors from %.1e to %.1e; the exact pictures' own is at most %.1e\n",
                  smallest->error.relative_l2, largest->error.relative_l2, least_exact->reference_error);
    return text + line.data();
}

} // namespace tyndall::samples
