#include "samples/tyndall/stability_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

namespace tyndall::samples {
namespace {

std::string number(const std::optional<double>& value) {
    if (!value) {
        return "-";
    }
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.2e", *value);
    return text.data();
}

nlohmann::ordered_json json_number(const std::optional<double>& value) {
    return value && std::isfinite(*value) ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

const char* verdict(const StabilityRow& row) {
    return row.passed() ? "holds" : "BROKEN";
}

} // namespace

std::string to_table(std::span<const StabilityRow> rows, const std::string& device) {
    std::string text = "device: " + device + "\n";
    std::array<char, 256> line{};
    const auto add = [&](const char* name, const char* parameter, const char* measure, const char* worst,
                         const char* bound, const std::string& rest) {
        std::snprintf(line.data(), line.size(), "%-16s %-36s %-34s %9s %9s  ", name, parameter, measure, worst, bound);
        text += line.data() + rest + "\n";
    };
    add("case", "parameter", "measured", "worst", "bound", "verdict");
    for (const StabilityRow& row : rows) {
        add(row.name.c_str(), row.parameter.c_str(), row.measure.c_str(), number(row.worst).c_str(),
            number(row.bound).c_str(), verdict(row) + (row.broken.empty() ? "" : ": " + row.broken));
    }
    const auto broken = std::count_if(rows.begin(), rows.end(), [](const StabilityRow& row) { return !row.passed(); });
    return text + std::to_string(rows.size()) + " cases, " + std::to_string(broken) + " out of their bounds\n";
}

std::string to_csv(std::span<const StabilityRow> rows, const std::string& device) {
    std::string text = "case,parameter,measured,worst,bound,verdict,broken,device\n";
    for (const StabilityRow& row : rows) {
        text += row.name + ",\"" + row.parameter + "\",\"" + row.measure + "\"," + number(row.worst) + "," +
                number(row.bound) + "," + verdict(row) + ",\"" + row.broken + "\",\"" + device + "\"\n";
    }
    return text;
}

std::string to_json(std::span<const StabilityRow> rows, const std::string& device) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const StabilityRow& row : rows) {
        list.push_back({{"case", row.name},
                        {"parameter", row.parameter},
                        {"measured", row.measure},
                        {"worst", json_number(row.worst)},
                        {"bound", json_number(row.bound)},
                        {"holds", row.passed()},
                        {"broken", row.broken}});
    }
    return nlohmann::ordered_json{{"device", device}, {"rows", list}}.dump(2) + "\n";
}

} // namespace tyndall::samples
