#include "samples/tyndall/timing.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include <nlohmann/json.hpp>

namespace tyndall::samples {

double median(std::vector<double> values) {
    if (values.empty()) {
        return 0.0;
    }
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

void Timings::add_frame(const rg::GraphDesc& graph, std::span<const rg::PassTiming> passes) {
    double sum = 0.0;
    for (const rg::PassTiming& timing : passes) {
        const std::string& name = graph.passes[timing.pass].name;
        auto row = std::find_if(rows_.begin(), rows_.end(), [&](const Row& r) { return r.pass == name; });
        if (row == rows_.end()) {
            rows_.push_back({.pass = name});
            row = rows_.end() - 1;
        }
        row->index = timing.pass;
        row->samples_ms.push_back(timing.duration_ms);
        sum += timing.duration_ms;
    }
    if (!passes.empty()) {
        frames_ms_.push_back(sum);
    }
}

std::vector<Timings::Row> Timings::rows() const {
    std::vector<Row> rows = rows_;
    for (Row& row : rows) {
        row.median_ms = median(row.samples_ms);
    }
    return rows;
}

double Timings::frame_median_ms() const {
    return median(frames_ms_);
}

std::string Timings::table(const std::string& device) const {
    std::string text = "device: " + device + "\nmedian of " + std::to_string(frames_ms_.size()) + " frames, ms\n";
    std::array<char, 160> line{};
    const auto add = [&](const std::string& name, double value) {
        std::snprintf(line.data(), line.size(), "  %-32s %9.3f\n", name.c_str(), value);
        text += line.data();
    };
    for (const Row& row : rows()) {
        add(row.pass, row.median_ms);
    }
    add("all passes of a frame", frame_median_ms());
    return text;
}

std::string Timings::json(const std::string& device) const {
    nlohmann::ordered_json passes = nlohmann::ordered_json::object();
    for (const Row& row : rows()) {
        passes[row.pass] = row.median_ms;
    }
    const nlohmann::ordered_json document = {
        {"device", device}, {"frames", frames_ms_.size()}, {"frame_ms", frame_median_ms()}, {"passes_ms", passes}};
    return document.dump(2);
}

} // namespace tyndall::samples
